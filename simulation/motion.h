#pragma once

#include <deque>
#include <optional>
#include <utility>
#include <vector>

#include "tccm_monitor/time.h"

namespace tccm::simulation {

/// The nodding of the laser: mean plus amplitude times a sine of the time.
struct TiltMotion {
  double mean_rad = 0.78539816339744831;       ///< 45 degrees down
  double amplitude_rad = 0.52359877559829887;  ///< 30 degrees
  double period_s = 1.575;
  double phase_rad = 0.0;  ///< of the sine at the start

  /// @param elapsed since the start of the motion.
  [[nodiscard]] double position(Duration elapsed) const;  ///< [rad], positive looks down
  [[nodiscard]] double velocity(Duration elapsed) const;  ///< [rad/s]
};

/// Drives a hand along a path of given length, out and back again and again, or in stages, and
/// obeys a stop: after a latency it brakes on its path, holds, and sets off again gently once
/// released. A speed scale takes effect after the same latency. Knows only the distance along the
/// path.
class PathController {
 public:
  /// A part of the way out, at the end of which the hand waits.
  struct Stage {
    double end_m = 0.0;  ///< along the path
    double speed_mps = 0.25;
    double dwell_s = 0.0;
  };
  struct Config {
    double speed_mps = 0.25;         ///< of the hand
    double acceleration_mps2 = 2.0;  ///< at the ends of the path, and when braking
    double resume_mps2 = 0.15;       ///< acceleration after a stop
    double latency_s = 0.02;         ///< from the stop's arrival to the brake
    double release_delay_s = 0.3;    ///< from the release to moving again
    double dwell_s = 0.3;            ///< at each end of the path
    /// The way out, in place of speed and dwell, at rising ends; the hand stays at the last one's.
    /// Empty: out and back for ever.
    std::vector<Stage> stages;

    /// @throws ConfigError
    void validate() const;
  };

  /// @throws ConfigError
  PathController(const Config& config, double path_length_m);

  /// Moves on to a later instant. @param stop asserted since the last step. Steps of 1 ms keep the
  /// distance right to a tenth of a millimetre.
  void step(Time now, bool stop);
  /// What the commanded speed is multiplied by from the next step and the latency on, 0 to 1. The
  /// hand gets slower and faster with acceleration_mps2.
  void setSpeedScale(double scale) { scale_heard_ = scale; }

  [[nodiscard]] double distance() const { return distance_; }  ///< [m] along the path
  [[nodiscard]] double speed() const { return speed_; }        ///< [m/s], negative on the way back
  [[nodiscard]] bool outbound() const { return direction_ > 0.0; }
  [[nodiscard]] bool braking() const { return braking_; }  ///< or holding
  /// How many stages are over, their dwells included.
  [[nodiscard]] std::size_t stagesDone() const { return stage_; }

 private:
  void obey(Time now, bool stop);
  void obeyScale(Time now);
  void turnAtEnd(Time now);
  void finishStage(Time now);
  [[nodiscard]] bool inStages() const { return !config_.stages.empty(); }
  [[nodiscard]] double end() const;       ///< [m] that the way out leads to now
  [[nodiscard]] double speedMax() const;  ///< [m/s] as commanded and scaled
  [[nodiscard]] double speedWanted(Time now, double elapsed) const;

  Config config_;
  double length_;
  double distance_ = 0.0;
  double speed_ = 0.0;
  double direction_ = 1.0;
  bool braking_ = false;
  bool resuming_ = false;
  std::size_t stage_ = 0;
  double scale_ = 1.0;
  double scale_heard_ = 1.0;
  std::deque<std::pair<Time, double>> scales_;  ///< heard, and not yet in effect
  std::optional<Time> last_;
  std::optional<Time> stop_since_;
  std::optional<Time> free_since_;
  std::optional<Time> dwell_until_;
};

}  // namespace tccm::simulation
