#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <variant>

#include "geometry/ray.h"

/// What a spherical camera sees of one solid: where rays meet it, and the angles it lies within.
namespace tccm::view {

constexpr double kHalfTurn = 3.14159265358979323846;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

inline double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

/// Half the extents of a box in the shape's own frame that contains it.
struct HalfExtents {
  Vector3 operator()(const Box& box) const { return box.half_extents; }
  Vector3 operator()(const Cylinder& c) const { return {c.radius, c.radius, c.half_length}; }
  Vector3 operator()(const Capsule& c) const {
    return {c.radius, c.radius, c.radius + c.half_length};
  }
  Vector3 operator()(const Sphere& s) const { return Vector3::Constant(s.radius); }
};

/// Where rays from one point outside a solid first meet it.
/// @return the way there along the direction of length 1; infinite where the ray misses [m].
template <typename Solid>
class Entry {
 public:
  Entry(const Solid& solid, const Vector3& origin)
      : solid_(solid), ray_{origin, Vector3::UnitX()} {}

  double operator()(const Vector3& direction) {
    ray_.direction = direction;
    const LineSpan span = lineSpan(solid_, ray_);
    return span.empty() || span.leave < 0.0 ? kInfinity : std::max(0.0, span.enter);
  }

 private:
  const Solid& solid_;
  Ray ray_;
};

/// Only faces whose outer side the origin is on can be entered through.
template <>
class Entry<Box> {
 public:
  Entry(const Box& box, const Vector3& origin)
      : half_(box.half_extents * (1.0 + kRounding)), origin_(origin) {
    for (int i = 0; i < 3; ++i) {
      inward_[i] = -std::copysign(1.0, origin[i]);
      beyond_[i] = std::abs(origin[i]) - box.half_extents[i];
    }
  }

  double operator()(const Vector3& direction) const {
    double enter = 0.0;
    for (int i = 0; i < 3; ++i) {
      if (beyond_[i] <= 0.0) continue;
      const double towards = inward_[i] * direction[i];
      if (!(towards > 0.0)) return kInfinity;
      enter = std::max(enter, beyond_[i] / towards);
    }
    for (int i = 0; i < 3; ++i) {
      if (std::abs(origin_[i] + enter * direction[i]) > half_[i]) return kInfinity;
    }
    return enter;
  }

 private:
  static constexpr double kRounding = 1e-12;
  Vector3 half_;
  Vector3 origin_;
  Vector3 inward_;  ///< signs of directions that lead in
  Vector3 beyond_;  ///< how far the origin is outside of the faces on its side [m]
};

/// Angles that a solid cannot reach beyond: azimuth relative to that of its centre.
struct AngularBounds {
  double elevation_low = -0.5 * kHalfTurn, elevation_high = 0.5 * kHalfTurn;
  /// Nothing where the corners are not all ahead of the plane through the viewpoint that stands
  /// upright across the way to the centre.
  struct Azimuth {
    double low, high;
  };
  std::optional<Azimuth> azimuth = std::nullopt;
};

/// From the corners of the box around the shape.
inline AngularBounds cornerBounds(const Shape& shape, const Pose& T_fixed_shape,
                                  const Vector3& to_shape) {
  const double range = to_shape.head<2>().norm();
  const Eigen::Vector2d ahead = to_shape.head<2>() / (range > 0.0 ? range : 1.0);
  const Eigen::Matrix3d edges =
      T_fixed_shape.linear() * std::visit(HalfExtents{}, shape).asDiagonal();
  double nearest = kInfinity, farthest = 0.0, lowest = kInfinity, highest = -kInfinity;
  double right = kInfinity, left = -kInfinity;  // tangents of the azimuth
  for (unsigned i = 0; i < 8; ++i) {
    const Vector3 corner =
        to_shape + edges * Vector3((i & 1U) ? 1 : -1, (i & 2U) ? 1 : -1, (i & 4U) ? 1 : -1);
    const Eigen::Vector2d level = corner.head<2>();
    const double along = ahead.dot(level);
    const double tangent = cross(ahead, level) / along;
    right = std::min(right, tangent);
    left = std::max(left, tangent);
    nearest = std::min(nearest, along);
    farthest = std::max(farthest, level.norm());
    lowest = std::min(lowest, corner.z());
    highest = std::max(highest, corner.z());
  }
  AngularBounds angles;
  const bool is_ahead = nearest >= 1e-3;
  if (is_ahead) angles.azimuth = {std::atan(right), std::atan(left)};
  if (is_ahead || lowest > 0.0) {
    angles.elevation_low = std::atan(lowest / (lowest < 0.0 ? nearest : farthest));
  }
  if (is_ahead || highest < 0.0) {
    angles.elevation_high = std::atan(highest / (highest < 0.0 ? farthest : nearest));
  }
  return angles;
}

}  // namespace tccm::view
