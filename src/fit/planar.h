#pragma once

#include <Eigen/Core>
#include <vector>

namespace tccm {

using Vector2 = Eigen::Vector2d;

/// In the plane; along_x is the unit vector of its first axis.
struct Rectangle {
  Vector2 centre;
  Vector2 along_x;
  Vector2 half_extents;
};

/// The corners of the points' convex hull, anticlockwise; one or two where the points are one or
/// on a line. Finite points only.
[[nodiscard]] std::vector<Vector2> planarHull(std::vector<Vector2> points);

/// The rectangle of least area around an anticlockwise convex polygon, by rotating calipers: one of
/// its sides lies on one of the polygon's. Sides shorter than thinnest count as that long.
[[nodiscard]] Rectangle smallestRectangle(const std::vector<Vector2>& hull, double thinnest);

}  // namespace tccm
