#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "config/parameter_table.h"
#include "tccm_monitor/time.h"

namespace tccm {

/// The points that a camera or lidar measured in one frame or turn.
struct Cloud {
  Time stamp;
  std::size_t width = 0;
  std::size_t height = 0;  ///< above 1: organised, neighbours in memory are neighbours in sight
  /// In the sensor's frame [m], row by row, width times height of them.
  std::vector<Eigen::Vector3f> points;
  /// When each was measured, from the stamp [s]; empty: all at the stamp.
  std::vector<float> offsets_s;
  // Of the points that were measured; 0 where all are at the stamp.
  double first_offset_s = 0.0;
  double last_offset_s = 0.0;

  [[nodiscard]] bool organised() const { return height > 1; }
  [[nodiscard]] Time first() const { return stamp + fromSeconds(first_offset_s); }
  [[nodiscard]] Time last() const { return stamp + fromSeconds(last_offset_s); }
};

/// Whether a range was measured there. Drivers write NaN where none was, some write zeros.
[[nodiscard]] inline bool isMeasured(const Eigen::Vector3f& point) {
  return point.allFinite() && (point.x() != 0.0F || point.y() != 0.0F || point.z() != 0.0F);
}

/// What is too much for one cloud.
struct CloudLimits {
  std::size_t points_max = 400000;
  double duration_max_s = 0.2;

  void describe(ParameterTable& table) {
    table.add("cloud_points_max", &points_max, "points", {1.0, 1e7},
              "a cloud with more is dropped");
    table.add("cloud_duration_max_s", &duration_max_s, "s", {0.0, 1.0},
              "a cloud whose points' times span more, or lie further from its stamp, is dropped");
  }
};

}  // namespace tccm
