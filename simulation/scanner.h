#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <random>
#include <vector>

#include "geometry/ray.h"
#include "tccm_monitor/laser_scan.h"
#include "tccm_monitor/pose.h"
#include "tccm_monitor/shape.h"

namespace tccm::simulation {

/// Everything a beam can hit at one instant, and the sensor. A target is a shape of the body.
struct Snapshot {
  Time stamp;
  Pose T_fixed_sensor;
  Body targets;
  std::vector<std::size_t> labels;  ///< what each target is called in BeamTruth
};

/// What a beam really met.
struct BeamTruth {
  std::optional<std::size_t> label;  ///< of the surface on the beam's axis; nothing within range
  bool mixed = false;                ///< the range lies between two surfaces
  std::size_t mixed_near = 0;        ///< label of the nearer of them; only where mixed
  std::size_t mixed_far = 0;         ///< label of the farther one
};

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
  struct Mixing {
    bool on = false;
    double share = 0.5;  ///< of the far surface in the measured range
  };

  [[nodiscard]] double noisy(double range);
  void advanceMixing();

  Config config_;
  std::vector<SpotRays> spots_;  ///< of each beam
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
  std::uniform_real_distribution<double> uniform_;
  Mixing mixing_;
};

}  // namespace tccm::simulation
