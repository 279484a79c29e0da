#pragma once

#include <optional>

#include "tccm_monitor/time.h"

namespace tccm::simulation {

/// The nodding of the laser: mean plus amplitude times a sine of the time.
struct TiltMotion {
  double mean_rad = 0.78539816339744831;       ///< 45 degrees down
  double amplitude_rad = 0.52359877559829887;  ///< 30 degrees
  double period_s = 1.575;

  /// @param elapsed since the start of the motion.
  [[nodiscard]] double position(Duration elapsed) const;  ///< [rad], positive looks down
  [[nodiscard]] double velocity(Duration elapsed) const;  ///< [rad/s]
};

/// Drives a hand along a path of given length, out and back again and again, and obeys a stop:
/// after a latency it brakes on its path, holds, and sets off again gently once released. Knows
/// only the distance along the path.
class PathController {
 public:
  struct Config {
    double speed_mps = 0.25;         ///< of the hand
    double acceleration_mps2 = 2.0;  ///< at the ends of the path, and when braking
    double resume_mps2 = 0.15;       ///< acceleration after a stop
    double latency_s = 0.02;         ///< from the stop's arrival to the brake
    double release_delay_s = 0.3;    ///< from the release to moving again
    double dwell_s = 0.3;            ///< at each end of the path

    /// @throws ConfigError
    void validate() const;
  };

  /// @throws ConfigError
  PathController(const Config& config, double path_length_m);

  /// Moves on to a later instant. @param stop asserted since the last step. Steps of 1 ms keep the
  /// distance right to a tenth of a millimetre.
  void step(Time now, bool stop);

  [[nodiscard]] double distance() const { return distance_; }  ///< [m] along the path
  [[nodiscard]] double speed() const { return speed_; }        ///< [m/s], negative on the way back
  [[nodiscard]] bool outbound() const { return direction_ > 0.0; }
  [[nodiscard]] bool braking() const { return braking_; }  ///< or holding

 private:
  void obey(Time now, bool stop);
  void turnAtEnd(Time now);
  [[nodiscard]] double speedWanted(Time now, double elapsed) const;

  Config config_;
  double length_;
  double distance_ = 0.0;
  double speed_ = 0.0;
  double direction_ = 1.0;
  bool braking_ = false;
  bool resuming_ = false;
  std::optional<Time> last_;
  std::optional<Time> stop_since_;
  std::optional<Time> free_since_;
  std::optional<Time> dwell_until_;
};

}  // namespace tccm::simulation
