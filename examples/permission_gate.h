#pragma once

#include <ros/time.h>

#include <optional>
#include <string>

#include "tccm_monitor/MotionPermission.h"

namespace tccm::example {

/// One instant on two clocks: the one of stamps, which may be simulated and may stand still, and
/// one that always goes on.
struct Instant {
  ros::Time stamp;
  ros::SteadyTime steady;

  [[nodiscard]] static Instant now() { return {ros::Time::now(), ros::SteadyTime::now()}; }
};

/// Says from the permissions heard so far whether the arms may move. Silence means no, on either
/// clock.
class PermissionGate {
 public:
  /// @param future_max_s how far a stamp may be ahead of this machine's clock [s].
  explicit PermissionGate(double future_max_s = 0.05) : future_max_s_(future_max_s) {}

  /// Every permission has to come here, in the order they came.
  void hear(const tccm_monitor::MotionPermission& permission, const Instant& now);

  /// Why the arms may not move now, one line for people; empty where they may.
  [[nodiscard]] std::string objection(const Instant& now) const;

  /// Of the commanded speed, above 0 and up to 1. @pre objection() is empty.
  [[nodiscard]] double speedScale() const { return last_->speed_scale; }

 private:
  double future_max_s_;
  std::optional<tccm_monitor::MotionPermission> last_;
  std::string defect_;    ///< of the last one beside the one before
  ros::SteadyTime news_;  ///< when a stamp came that had not come before
};

}  // namespace tccm::example
