#pragma once

#include <optional>
#include <vector>

#include "tccm_monitor/pose.h"

namespace tccm {

/// A level surface that the robot stands on.
struct Floor {
  double highest_m = 0.0;  ///< of the plane over the points that belong to it
  double noise_m = 0.0;    ///< standard deviation of their distances from it
  std::size_t points = 0;
};

/// The level plane at the lowest part of the robot, by RANSAC (pcl::SACSegmentation); nothing where
/// too few points lie there. @param points in a frame with z up [m]. @param robot_bottom_m height
/// of the lowest part of the robot.
[[nodiscard]] std::optional<Floor> findFloor(const std::vector<Vector3>& points,
                                             double robot_bottom_m);

}  // namespace tccm
