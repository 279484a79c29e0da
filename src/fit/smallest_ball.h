#pragma once

#include <Eigen/Core>
#include <vector>

namespace tccm {

/// A disc in the plane, a ball in space.
template <int Dimension>
struct Ball {
  Eigen::Matrix<double, Dimension, 1> centre;
  double radius;
};

/// The smallest disc or ball around the points, exact up to rounding. At least one point, all
/// finite. Each point is looked at a few times.
template <int Dimension>
[[nodiscard]] Ball<Dimension> smallestBall(
    const std::vector<Eigen::Matrix<double, Dimension, 1>>& points);

extern template Ball<2> smallestBall<2>(const std::vector<Eigen::Vector2d>& points);
extern template Ball<3> smallestBall<3>(const std::vector<Eigen::Vector3d>& points);

}  // namespace tccm
