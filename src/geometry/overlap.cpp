#include "geometry/overlap.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "geometry/distance.h"

namespace tccm {
namespace {

using Point2 = Eigen::Vector2d;

/// Twice the area of the triangle o, a, b; positive when it turns left.
double turn(const Point2& o, const Point2& a, const Point2& b) {
  return (a.x() - o.x()) * (b.y() - o.y()) - (a.y() - o.y()) * (b.x() - o.x());
}

double squaredDistanceToSegment(const Point2& a, const Point2& b) {
  const Point2 along = b - a;
  const double length2 = along.squaredNorm();
  const double t = length2 > 0.0 ? std::clamp(-a.dot(along) / length2, 0.0, 1.0) : 0.0;
  return (a + t * along).squaredNorm();
}

/// Room for the corners of a box cut by two parallel planes: 8 corners, and each of 12 edges cut
/// twice.
struct PointSet {
  std::array<Point2, 32> points;
  std::size_t count = 0;

  void add(const Vector3& p) { points[count++] = p.head<2>(); }
};

/// Squared distance from the origin to the convex hull of the points; 0 inside. Reorders them.
double squaredDistanceToHull(PointSet& set) {
  const auto begin = set.points.begin();
  std::sort(begin, begin + static_cast<std::ptrdiff_t>(set.count),
            [](const Point2& a, const Point2& b) {
              return a.x() < b.x() || (a.x() == b.x() && a.y() < b.y());
            });
  std::array<Point2, 66> hull;
  std::size_t size = 0;
  const auto extend = [&](const Point2& p, std::size_t floor) {
    while (size >= floor + 2 && turn(hull[size - 2], hull[size - 1], p) <= 0.0) --size;
    hull[size++] = p;
  };
  for (std::size_t i = 0; i < set.count; ++i) extend(set.points[i], 0);
  const std::size_t lower = size - 1;
  for (std::size_t i = set.count - 1; i-- > 0;) extend(set.points[i], lower);
  if (size == 1) return hull[0].squaredNorm();
  bool inside = size > 3;  // the first point closes the hull: a triangle has four entries
  double least = hull[0].squaredNorm();
  for (std::size_t i = 0; i + 1 < size; ++i) {
    if (turn(hull[i], hull[i + 1], Point2::Zero()) < 0.0) inside = false;
    least = std::min(least, squaredDistanceToSegment(hull[i], hull[i + 1]));
  }
  return inside ? 0.0 : least;
}

/// The box's corners in the cylinder's frame, bit i of the index choosing the side along axis i.
std::array<Vector3, 8> corners(const UprightBox& box, const Pose& T_shape_fixed) {
  const Vector3 centre = T_shape_fixed * box.center();
  const Eigen::Matrix3d edges = T_shape_fixed.linear() * (0.5 * box.sizes()).asDiagonal();
  std::array<Vector3, 8> result;
  for (unsigned i = 0; i < 8; ++i) {
    result[i] = centre + edges * Vector3((i & 1U) ? 1 : -1, (i & 2U) ? 1 : -1, (i & 4U) ? 1 : -1);
  }
  return result;
}

struct Overlaps {
  const Pose& T_fixed_shape;
  const UprightBox& box;

  bool operator()(const Sphere& s) const {
    return box.squaredExteriorDistance(T_fixed_shape.translation()) <= s.radius * s.radius;
  }

  bool operator()(const Capsule& c) const {
    const Vector3 half_axis = T_fixed_shape.linear().col(2) * c.half_length;
    const Vector3 start = T_fixed_shape.translation() - half_axis - box.center();
    const Vector3 half = 0.5 * box.sizes();
    const double t = nearestOnSegment(start, 2.0 * half_axis, half);
    return outside(start + 2.0 * t * half_axis, half).squaredNorm() <= c.radius * c.radius;
  }

  bool operator()(const Box& b) const {
    const Eigen::Matrix3d axes = T_fixed_shape.linear();
    const Eigen::Matrix3d absolute = axes.cwiseAbs();
    const Vector3 between = T_fixed_shape.translation() - box.center();
    const Vector3 upright = 0.5 * box.sizes();
    const Vector3& own = b.half_extents;
    if ((between.cwiseAbs() - upright - absolute * own).maxCoeff() > 0.0) return false;
    const Vector3 between_own = axes.transpose() * between;
    if ((between_own.cwiseAbs() - own - absolute.transpose() * upright).maxCoeff() > 0.0) {
      return false;
    }
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        if (separates(i, j, axes, absolute, between, upright, own)) return false;
      }
    }
    return true;
  }

  bool operator()(const Cylinder& c) const {
    const auto corner = corners(box, T_fixed_shape.inverse());
    PointSet inside;
    for (unsigned i = 0; i < 8; ++i) {
      if (std::abs(corner[i].z()) <= c.half_length) inside.add(corner[i]);
      for (const unsigned axis : {1U, 2U, 4U}) {
        if (i & axis) continue;
        const Vector3& a = corner[i];
        const Vector3& b = corner[i | axis];
        for (const double plane : {-c.half_length, c.half_length}) {
          if ((a.z() < plane) == (b.z() < plane)) continue;
          inside.add(a + (plane - a.z()) / (b.z() - a.z()) * (b - a));
        }
      }
    }
    return inside.count > 0 && squaredDistanceToHull(inside) <= c.radius * c.radius;
  }

 private:
  /// Whether the axis (upright axis i) x (own axis j) separates the two boxes.
  static bool separates(int i, int j, const Eigen::Matrix3d& axes, const Eigen::Matrix3d& absolute,
                        const Vector3& between, const Vector3& upright, const Vector3& own) {
    constexpr double kParallel = 1e-9;  // nearly parallel edges give no axis of their own
    const int i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
    if (absolute(i1, j) + absolute(i2, j) < kParallel) return false;
    const double reach = upright[i1] * absolute(i2, j) + upright[i2] * absolute(i1, j) +
                         own[j1] * absolute(i, j2) + own[j2] * absolute(i, j1);
    return std::abs(between[i2] * axes(i1, j) - between[i1] * axes(i2, j)) > reach;
  }
};

}  // namespace

bool overlaps(const Shape& shape, const Pose& T_fixed_shape, const UprightBox& box) {
  return std::visit(Overlaps{T_fixed_shape, box}, shape);
}

}  // namespace tccm
