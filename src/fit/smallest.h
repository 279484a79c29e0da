#pragma once

#include <Eigen/Core>
#include <vector>

/// What is smallest around points, exact up to rounding. All points are finite, at least one.
namespace tccm {

using Vector2 = Eigen::Vector2d;

/// The corners of the points' convex hull, anticlockwise; one or two where the points are one or
/// on a line.
[[nodiscard]] std::vector<Vector2> planarHull(std::vector<Vector2> points);

/// In the plane; along_x is the unit vector of its first axis.
struct Rectangle {
  Vector2 centre;
  Vector2 along_x;
  Vector2 half_extents;
};

/// The rectangle of least area around an anticlockwise convex polygon, by rotating calipers: one of
/// its sides lies on one of the polygon's. Sides shorter than thinnest count as that long.
[[nodiscard]] Rectangle smallestRectangle(const std::vector<Vector2>& hull, double thinnest);

/// A disc in the plane, a ball in space.
template <int Dimension>
struct Ball {
  Eigen::Matrix<double, Dimension, 1> centre;
  double radius;
};

/// The smallest disc or ball around the points; there is one for dimensions 2 and 3. Each point is
/// looked at a few times.
template <int Dimension>
[[nodiscard]] Ball<Dimension> smallestBall(
    const std::vector<Eigen::Matrix<double, Dimension, 1>>& points);

}  // namespace tccm
