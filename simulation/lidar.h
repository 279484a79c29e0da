#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "simulation/quick_random.h"
#include "simulation/simulated_cloud.h"

namespace tccm::simulation {

class MovingScene;

/// A lidar that turns, after Ouster's OS1-64 (data sheet: 33.2 degrees in height, 0.8 to 40 m, a
/// range repeatable to 3 cm, one standard deviation, at a signal-to-noise ratio of 100). All rows
/// of a column are measured at one time, column by column through the turn. Repeatable from its
/// seed.
class Lidar {
 public:
  struct Config {
    std::size_t rows = 64;  ///< from the highest to the lowest
    std::size_t columns = 1024;
    double period_s = 0.1;
    double elevation_max_deg = 16.6;  ///< of the first row, and below the level of the last
    double range_min_m = 0.8;
    double range_max_m = 40.0;
    double noise_m = 0.03;  ///< standard deviation of a range, at any

    /// @throws ConfigError
    void validate() const;
    /// From the first column to the last.
    [[nodiscard]] Duration turnDuration() const;
  };

  /// @throws ConfigError
  Lidar(const Config& config, std::uint64_t seed);

  /// A turn, organised: the first column looks behind (-x), the turn goes clockwise as seen from
  /// above (+z). Each point is in the sensor's frame of its own time; NaN where none was measured.
  /// @param snapshots at rising instants that cover the turn, used as Scanner does.
  [[nodiscard]] SimulatedCloud measure(Time stamp, const std::vector<Snapshot>& snapshots);

 private:
  /// @param offset_s of the column's time. @return whether a range was measured.
  bool measureColumn(std::size_t column, float offset_s, MovingScene& scene,
                     SimulatedCloud& result);

  Config config_;
  QuickRandom random_;
  QuickNormal normal_;
  std::vector<Vector3> rows_;  ///< their directions where the azimuth is 0
};

}  // namespace tccm::simulation
