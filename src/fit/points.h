#pragma once

#include <Eigen/Core>
#include <vector>

#include "mesh/mesh.h"

/// What is found out about a set of points, by itself. All points are finite.
namespace tccm {

using Matrix3X = Eigen::Matrix3Xd;
using Vector2 = Eigen::Vector2d;

/// The convex hull of points; its vertices are some of them, as given.
struct ConvexHull {
  Mesh surface;            ///< no triangles where the points are flat, collinear or one
  double volume_m3 = 0.0;  ///< 0 where there are no triangles
};

/// The hull by Qhull, exact up to about 1e-14 of the points' extent. Points within 1e-9 of their
/// extent from a plane count as flat; a flat hull's vertices are all the different points.
/// No points give an empty hull.
[[nodiscard]] ConvexHull convexHull(const std::vector<Vector3>& points);

/// Unit vectors spread evenly over the half sphere z >= 0, the same at every call.
[[nodiscard]] std::vector<Vector3> hemisphereDirections(int count);

/// The points' principal axes, the longest first; any right-handed axes where they are not unique.
[[nodiscard]] Eigen::Matrix3d principalAxes(const std::vector<Vector3>& points);

/// A rotation whose third column is the unit vector z.
[[nodiscard]] Eigen::Matrix3d axesAbout(const Vector3& z);

/// Adds direction unless one of directions points the same or the opposite way.
/// @param least_angle [rad]
void addIfDifferent(std::vector<Vector3>& directions, const Vector3& direction, double least_angle);

/// Thins points out to those that are the farthest along one of the directions or against it, two a
/// direction at most, so that their hull is nearly that of all. No more points are all left.
[[nodiscard]] std::vector<Vector3> extremePoints(const std::vector<Vector3>& points,
                                                 const std::vector<Vector3>& directions);

/// The corners of the points' convex hull, anticlockwise; one or two where the points are one or
/// on a line.
[[nodiscard]] std::vector<Vector2> planarHull(const std::vector<Vector2>& points);

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

/// The smallest disc or ball around the points, at least one; there is one for dimensions 2 and 3.
/// Each point is looked at a few times.
template <int Dimension>
[[nodiscard]] Ball<Dimension> smallestBall(
    const std::vector<Eigen::Matrix<double, Dimension, 1>>& points);

}  // namespace tccm
