#pragma once

#include "config/parameter_table.h"

namespace tccm {

/// How much a measured range is off, one standard deviation. That of a depth camera grows with the
/// square of the range; of a time-of-flight lidar it does not. The default is a Kinect's: Nguyen,
/// Izadi, Lovell 2012, "Modeling Kinect Sensor Noise for Improved 3D Reconstruction and Tracking".
struct RangeNoise {
  double constant_m = 0.0012;
  double per_m2 = 0.0019;

  void describe(ParameterTable& table) {
    table.add("range_noise_m", &constant_m, "m", {0.0, 1.0},
              "standard deviation of a range, and at r metres `range_noise_per_m2` times r squared "
              "on top");
    table.add("range_noise_per_m2", &per_m2, "1/m", {0.0, 1.0},
              "0.0019 for a Kinect or RealSense, 0 for a lidar");
  }
  [[nodiscard]] float at(float range) const { return Floats(*this).at(range); }

  /// For what is asked of every point of a cloud.
  struct Floats {
    float constant_m;
    float per_m2;

    explicit Floats(const RangeNoise& noise)
        : constant_m(static_cast<float>(noise.constant_m)),
          per_m2(static_cast<float>(noise.per_m2)) {}
    [[nodiscard]] float at(float range) const { return constant_m + per_m2 * range * range; }
  };
};

}  // namespace tccm
