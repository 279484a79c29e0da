#pragma once

#include <optional>
#include <string>
#include <vector>

#include "config/parameter_table.h"
#include "tccm_monitor/time.h"
#include "tccm_monitor/verdict.h"

namespace tccm {

/// Turns what each check finds into what the robot may do: the worst counts, a stop is released
/// only after the robot has been clear for long enough, and what touched at the present pose, or a
/// fault, holds until it is reset.
class Permission {
 public:
  struct Config {
    double release_s = 0.0;
    int release_checks = 5;
    bool hold_until_reset = true;
    double speed_scale_rise_per_s = 0.5;

    void describe(ParameterTable& table);
  };

  /// What one check found.
  struct Findings {
    std::vector<Cause> causes;
    Cause touching;  ///< kCollision or kKeepOut at the present pose, also where it is moved out of
    bool known = false;  ///< the input is whole and fresh
    Duration window{0};  ///< of the map
  };

  struct Decision {
    Cause worst;                  ///< kClear where there is none
    std::vector<Reason> reasons;  ///< all, the gravest first
    double speed_scale = 0.0;
    Reason latched = Reason::kClear;
  };

  /// @throws ConfigError
  explicit Permission(const Config& config);
  /// Holds what is held. @throws ConfigError, and nothing changes.
  void reconfigure(const Config& config);

  /// @param now not before that of earlier calls. @param findings causes are put in order, the
  /// gravest first. The reference is valid until the next call.
  const Decision& decide(Time now, Findings& findings);

  /// Lifts what holds until it is reset; of a robot in contact only a fault, and the contact
  /// holds instead. @return why not, in one line; empty where it is lifted.
  [[nodiscard]] std::string reset();
  /// As at the start; but what holds until it is reset is lifted by a person, not by a clock.
  void startAnew();

 private:
  [[nodiscard]] bool needsRelease(const Cause& cause) const;
  void latch(const Cause& cause);
  [[nodiscard]] Cause held(Time now, const Findings& findings, bool moving_out);
  void moveScale(Time now, double wanted);

  Config config_;
  bool was_known_ = false;         ///< since the start: what is missing before is no stop
  bool was_ever_known_ = false;    ///< also before it started anew
  std::optional<Time> last_stop_;  ///< the last check that was not clear, INIT apart
  Reason last_stop_reason_ = Reason::kClear;  ///< what stopped it last
  int clear_checks_ = 0;                      ///< since then
  Cause latched_;
  Cause touching_;                   ///< as of the last check
  Reason lasting_ = Reason::kClear;  ///< what speaks against a reset, as of the last check
  std::optional<Time> last_;
  Decision decision_;
};

}  // namespace tccm
