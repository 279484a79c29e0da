#include "geometry/distance.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/simplex.h"

namespace tccm {
namespace {

constexpr double kTolerance = 0.5e-6;  // between the bounds of an iterated distance [m]
constexpr int kMostIterations = 100;

/// A point's components, each with the sign of the other vector's.
Vector3 corner(const Vector3& half, const Vector3& towards) {
  return {std::copysign(half.x(), towards.x()), std::copysign(half.y(), towards.y()),
          std::copysign(half.z(), towards.z())};
}

/// The point furthest in a direction, both in the shape's frame.
struct Furthest {
  Vector3 direction;
  Vector3 operator()(const Box& box) const { return corner(box.half_extents, direction); }
  Vector3 operator()(const Cylinder& c) const {
    const double across = std::sqrt(direction.x() * direction.x() + direction.y() * direction.y());
    const double scale = across > 0.0 ? c.radius / across : 0.0;
    return {direction.x() * scale, direction.y() * scale,
            std::copysign(c.half_length, direction.z())};
  }
  Vector3 operator()(const Capsule& c) const {
    const Vector3 outwards = direction.stableNormalized() * c.radius;
    return {outwards.x(), outwards.y(), outwards.z() + std::copysign(c.half_length, direction.z())};
  }
  Vector3 operator()(const Sphere& s) const { return direction.stableNormalized() * s.radius; }
};

/// The solid's point furthest in a direction: both along the fixed frame's axes, from its centre.
template <typename Solid>
struct Support {
  Eigen::Matrix3d axes;
  const Solid& solid;

  Vector3 operator()(const Vector3& towards) const {
    return axes * Furthest{axes.transpose() * towards}(solid);
  }
};

/// Distance from the box around 0 to a convex shape at centre. Every v != 0 gives a plane between
/// the two, and so a lower bound; every v of the set of their differences an upper one.
/// @param v where to look first: about from the box's nearest point to the shape's.
template <typename Solid>
Separation iterated(const Vector3& centre, const Support<Solid>& support, const Vector3& half,
                    Vector3 v, double enough_m) {
  const auto furthest = [&](const Vector3& towards) {
    return Vector3(centre + support(towards) + corner(half, towards));
  };
  Separation lower;
  double upper = std::numeric_limits<double>::infinity();
  Simplex simplex;
  for (int i = 0; i < kMostIterations && !simplex.isFull(); ++i) {
    const double norm = v.norm();
    if (!(norm < upper)) break;
    const Vector3 w = furthest(-v);
    const double bound = v.dot(w) / norm;
    if (bound > lower.distance_m) lower = {bound, v / norm};
    if (i > 0) upper = norm;
    if (upper - lower.distance_m < kTolerance || lower.distance_m >= enough_m) break;
    simplex.add(w);
    v = simplex.reduce();
  }
  return lower;
}

/// Of a ball from a box. @param gap from the box's nearest point to the ball's centre.
Separation fromGap(const Vector3& gap, double radius) {
  const double norm = gap.norm();
  if (!(norm > radius)) return {};
  return {norm - radius, gap / norm};
}

struct Separate {
  const Pose& T_fixed_shape;
  Vector3 centre;  ///< the shape's, from the upright box's
  Vector3 half;    ///< the upright box's
  double enough_m;

  Separation operator()(const Sphere& s) const { return fromGap(outside(centre, half), s.radius); }

  Separation operator()(const Capsule& c) const {
    return fromGap(fromAxis(c.half_length).gap, c.radius);
  }

  Separation operator()(const Box& b) const {
    const Vector3 gap = outside(centre, half);
    if (gap.isZero(0.0)) return {};
    return iterated(centre, Support<Box>{T_fixed_shape.linear(), b}, half, gap, enough_m);
  }

  /// A cylinder lies in the capsule with its axis, and touches that capsule's side everywhere.
  Separation operator()(const Cylinder& c) const {
    const FromAxis nearest = fromAxis(c.half_length);
    if (nearest.is_inner || !(nearest.gap.norm() > 0.0)) return fromGap(nearest.gap, c.radius);
    return iterated(centre, Support<Cylinder>{T_fixed_shape.linear(), c}, half, nearest.gap,
                    enough_m);
  }

 private:
  struct FromAxis {
    Vector3 gap;    ///< from the box's nearest point to the axis'
    bool is_inner;  ///< whether the latter is none of the axis' ends
  };

  [[nodiscard]] FromAxis fromAxis(double half_length) const {
    const Vector3 half_axis = T_fixed_shape.linear().col(2) * half_length;
    const Vector3 start = centre - half_axis;
    const double t = nearestOnSegment(start, 2.0 * half_axis, half);
    return {outside(start + 2.0 * t * half_axis, half), t > 0.0 && t < 1.0};
  }
};

struct Core {
  Shape operator()(const Box& box) const {
    return Box{box.half_extents.array() - box.half_extents.minCoeff()};
  }
  Shape operator()(const Cylinder& c) const { return Capsule{0.0, c.half_length}; }
  Shape operator()(const Capsule& c) const { return Capsule{0.0, c.half_length}; }
  Shape operator()(const Sphere& /*sphere*/) const { return Sphere{0.0}; }
};

}  // namespace

double distance(const Shape& shape, const Pose& T_fixed_shape, const UprightBox& box) {
  return separation(shape, T_fixed_shape, box, std::numeric_limits<double>::infinity()).distance_m;
}

Separation separation(const Shape& shape, const Pose& T_fixed_shape, const UprightBox& box,
                      double enough_m) {
  const Vector3 centre = T_fixed_shape.translation() - box.center();
  return std::visit(Separate{T_fixed_shape, centre, 0.5 * box.sizes(), enough_m}, shape);
}

Vector3 furthest(const Shape& shape, const Pose& T_fixed_shape, const Vector3& direction) {
  return T_fixed_shape *
         std::visit(Furthest{T_fixed_shape.linear().transpose() * direction}, shape);
}

double distanceBound(const UprightBox& bounds_of_shape, const UprightBox& box) {
  return bounds_of_shape.exteriorDistance(box);
}

Shape core(const Shape& shape) { return std::visit(Core{}, shape); }

}  // namespace tccm
