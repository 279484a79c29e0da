#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

#include "tccm_monitor/time.h"

namespace tccm {

/// One instant on two clocks: the one of stamps, which may be simulated and may stand still, and
/// one that always goes on.
struct Instant {
  Time stamp;
  std::chrono::nanoseconds steady{0};
};

/// What a monitor has said last.
struct HeardPermission {
  Time stamp;
  Time valid_until;
  std::uint32_t sequence = 0;
  bool permitted = false;    ///< and at a level at which a robot may move
  double speed_scale = 0.0;  ///< of the commanded speed
  std::string why;           ///< it is not permitted, or slower: one line for people
};

/// Says from the permissions heard so far whether the arms may move (docs/controllers.md, the
/// rule). Silence means no, on either clock.
class PermissionGate {
 public:
  /// @param future_max how far a stamp may be ahead of this machine's clock.
  explicit PermissionGate(Duration future_max = std::chrono::milliseconds(50))
      : future_max_(future_max) {}

  /// Every permission has to come here, in the order they came.
  void hear(const HeardPermission& permission, const Instant& now);

  /// Why the arms may not move now, one line for people; empty where they may.
  [[nodiscard]] std::string objection(const Instant& now) const;

  /// Above 0 and up to 1. @pre objection() is empty.
  [[nodiscard]] double speedScale() const { return last_->speed_scale; }

 private:
  Duration future_max_;
  std::optional<HeardPermission> last_;
  const char* defect_ = nullptr;      ///< of the last one beside the one before
  std::chrono::nanoseconds news_{0};  ///< when a stamp came that had not come before
};

}  // namespace tccm
