#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "simulation/depth_image.h"
#include "simulation/mixing.h"
#include "simulation/quick_random.h"
#include "simulation/simulated_cloud.h"

namespace tccm::simulation {

/// A depth camera. It sees as widely as Intel's RealSense D435 does at 4:3, 75 by 62 degrees within
/// the tolerances of its data sheet, from 0.3 m on; a D435 begins at 0.2 m. Its depths are as noisy
/// as a Kinect's: Nguyen, Izadi, Lovell 2012, "Modeling Kinect Sensor Noise for Improved 3D
/// Reconstruction and Tracking". The whole frame is of one instant. Repeatable from its seed.
class DepthCamera {
 public:
  struct Config {
    Pinhole pinhole;
    double period_s = 1.0 / 30.0;
    double depth_min_m = 0.3;
    double depth_max_m = 4.0;
    // The standard deviation of a depth z is noise_m + noise_per_m2 * (z - noise_from_m)^2, and
    // more where the surface is seen at a slant of a: noise_slant * (a / (90 degrees - a))^2 /
    // sqrt(z).
    double noise_m = 0.0012;
    double noise_per_m2 = 0.0019;
    double noise_from_m = 0.4;
    double noise_slant = 0.0001;
    // No source says where it ends; at 80 degrees the noise above is 6 mm more.
    double grazing_deg = 80.0;  ///< a surface at a slant of more gives no depth
    // What real edges do, by the recordings that docs/experiments.md names: at most 0.4 % of their
    // pixels lie in between, 3 to 21 % of a Kinect's are not measured.
    double mixed_share = 0.05;       ///< of the pixels that straddle two surfaces
    double mixed_persistence = 0.7;  ///< chance that the next such pixel does as this one did
    double hole_share = 0.1;         ///< of the pixels that straddle two surfaces, without a depth
    double edge_gap_m = 0.03;        ///< surfaces nearer than this to each other do neither
    // Nguyen et al.: an outline is off by 0.8 pixels, one standard deviation. By more than half a
    // pixel to the one side it is in 27 %. By more than one and a half it would be in 3 %.
    double outline_share = 0.27;  ///< chance to show what the pixel across an outline does

    /// @throws ConfigError
    void validate() const;
  };

  /// @throws ConfigError
  DepthCamera(const Config& config, std::uint64_t seed);

  /// A frame, organised, of the snapshot's instant, in the camera's optical frame (z ahead, x
  /// right, y down): NaN where no depth is measured. A pixel straddles two surfaces where that of
  /// its right or lower neighbour is another target's. Its truth is the surface that it shows.
  /// @param snapshot with the pose of the optical frame.
  [[nodiscard]] SimulatedCloud measure(const Snapshot& snapshot);

 private:
  void draw(const Snapshot& snapshot);
  void measure(std::size_t row, std::size_t column, const std::vector<std::size_t>& labels,
               SimulatedCloud& result);
  [[nodiscard]] std::size_t shownIn(std::size_t row, std::size_t column);
  [[nodiscard]] std::optional<std::size_t> acrossEdge(std::size_t row, std::size_t column) const;
  [[nodiscard]] float mix(std::size_t neighbour, float depth,
                          const std::vector<std::size_t>& labels, PointTruth& truth);
  [[nodiscard]] float deviationAt(float depth, float facing, float length_squared) const;

  Config config_;
  DepthImage image_;
  QuickRandom random_;
  QuickNormal normal_;
  Mixing mixing_;
  std::vector<float> across_;  ///< of each column: x at a depth of 1
  std::vector<float> down_;    ///< of each row: y at a depth of 1
  float least_facing_squared_;
  float depth_min_, depth_max_;
};

}  // namespace tccm::simulation
