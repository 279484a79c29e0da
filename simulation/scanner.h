#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <random>
#include <vector>

#include "simulation/mixing.h"
#include "simulation/snapshot.h"
#include "tccm_monitor/laser_scan.h"

namespace tccm::simulation {

struct SimulatedScan {
  LaserScan scan;
  std::vector<BeamTruth> truth;  ///< one for each beam
};

/// The middle and the rim of a beam's spot: directions in the sensor's frame.
struct SpotRays {
  Vector3 axis;
  std::array<Vector3, 4> rim;
};

/// A planar laser range finder after Hokuyo's UBG-04LX-F01. Repeatable from its seed.
class Scanner {
 public:
  struct Config {
    std::size_t beams = 667;
    double angle_increment_deg = 0.36;  ///< the beams are centred on x: 240 degrees
    double period_s = 0.028;            ///< of a turn; the beams take angle / 360 degrees of it
    double range_min_m = 0.06;
    double range_max_m = 4.095;
    double noise_m = 0.01;           ///< standard deviation of a range
    double spot_deg = 0.36;          ///< full width of a beam's spot, in the scan plane and across
    double mixed_share = 0.5;        ///< of the beams whose spot straddles two surfaces
    double mixed_persistence = 0.7;  ///< chance that the next straddling beam does as this one did
    double mixed_gap_m = 0.03;       ///< surfaces nearer than this to each other do not mix

    /// @throws ConfigError
    void validate() const;
    [[nodiscard]] Duration timeIncrement() const;
    /// From the first beam to the last.
    [[nodiscard]] Duration scanDuration() const;
  };

  /// @throws ConfigError
  Scanner(const Config& config, std::uint64_t seed);

  /// @param snapshots at rising instants that cover the scan. The sensor's pose is interpolated
  /// between them; a beam meets the targets of the nearest one. A target that contains the sensor
  /// (its own housing) is not seen.
  [[nodiscard]] SimulatedScan measure(Time stamp, const std::vector<Snapshot>& snapshots);

 private:
  [[nodiscard]] double noisy(double range);

  Config config_;
  std::vector<SpotRays> spots_;  ///< of each beam
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
  std::uniform_real_distribution<double> uniform_;
  Mixing mixing_;
};

}  // namespace tccm::simulation
