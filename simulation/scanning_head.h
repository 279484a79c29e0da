#pragma once

#include <string>
#include <vector>

#include "simulation/motion.h"
#include "tccm_monitor/time.h"

namespace tccm::simulation {

/// What can go wrong with the laser's motion while its scans go on.
enum class TiltFault {
  kNone,
  kFrozen,      ///< the tilt stands still where it is
  kNarrowed,    ///< the tilt nods over a small part of its range
  kTurnedAway,  ///< the head is turned aside
};

/// "none", "frozen", "narrowed" or "turned_away". @throws ConfigError
[[nodiscard]] TiltFault tiltFault(const std::string& name);

/// The joints that move the laser: it nods on a head that looks ahead, unless there is a fault. A
/// fault comes and goes smoothly, within some tenths of a second; a tilt that was frozen goes on
/// from where it stood.
class ScanningHead {
 public:
  /// A fault from one instant on, for some time.
  struct Schedule {
    TiltFault fault = TiltFault::kNone;
    double at_s = 10.0;  ///< after the start
    double for_s = 5.0;
  };
  struct Config {
    TiltMotion tilt;
    double narrowed_share = 0.2;   ///< of the amplitude, that is left
    double turned_away_rad = 1.4;  ///< to the left
    std::vector<Schedule> faults;  ///< of several at one instant the last counts

    /// @throws ConfigError
    void validate() const;
  };

  /// @throws ConfigError
  ScanningHead(const Config& config, Time start);

  /// Steps of 1 ms keep positions right to a hundredth of a milliradian. @param now not before that
  /// of earlier calls.
  void step(Time now);
  /// From the next step on, also once those of the schedule are over.
  void setFault(TiltFault fault) { set_ = fault; }

  [[nodiscard]] double tilt() const;          ///< [rad], positive looks down
  [[nodiscard]] double tiltVelocity() const;  ///< [rad/s]
  [[nodiscard]] double yaw() const;           ///< of the head, positive looks left [rad]
  [[nodiscard]] double yawVelocity() const { return turn_.rate * config_.turned_away_rad; }
  [[nodiscard]] TiltFault fault() const;

 private:
  /// Goes from one value to another at a limited rate.
  struct Slide {
    double value;
    double rate = 0.0;  ///< of the last step [1/s]

    void step(double wanted, double rate_max, double elapsed_s);
  };
  [[nodiscard]] double amplitudeShare() const;

  Config config_;
  Time start_;
  Time now_;
  Duration phase_{0};  ///< of the nodding: the time since the start, less the time it stood still
  Slide pace_{1.0};    ///< of the phase; 1: as time goes
  Slide width_{1.0};   ///< from narrowed, 0, to whole, 1
  Slide turn_{0.0};    ///< from ahead, 0, to turned away, 1
  TiltFault set_ = TiltFault::kNone;
};

}  // namespace tccm::simulation
