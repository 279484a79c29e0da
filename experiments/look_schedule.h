#pragma once

#include <vector>

#include "simulation/motion.h"
#include "simulation/scanner.h"

namespace tccm::simulation {

/// When a nodding laser looks at a place straight ahead: scan by scan, so that where scans lie
/// further apart than a look is wide, some strokes miss the place.
class LookSchedule {
 public:
  struct Config {
    TiltMotion tilt;
    Scanner::Config scanner;
    double angle_rad = 0.0261799;  ///< a beam this near to the place looks at it: 1.5 degrees
    double duration_s = 200.0;     ///< that looks are counted over

    /// @throws ConfigError
    void validate() const;
  };

  /// @param tilt_rad at which the laser points at the place. @throws ConfigError where it never
  /// looks there.
  LookSchedule(const Config& config, double tilt_rad);

  /// From the start of the nodding [s], rising. Scans next to each other that look make one look.
  [[nodiscard]] const std::vector<double>& looks() const { return looks_s_; }
  [[nodiscard]] double longestGap() const;  ///< [s]

 private:
  std::vector<double> looks_s_;
};

/// How something stops.
struct Braking {
  double delay_s = 0.05;  ///< from a look to the brake
  double deceleration_mps2 = 2.0;
};

/// The greatest constant speed at which something that appears a distance ahead, and is looked at
/// after a gap at most, is braked for in time [m/s].
[[nodiscard]] double safeSpeed(double distance_m, double gap_s, const Braking& braking);

}  // namespace tccm::simulation
