#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/ray.h"

namespace tccm {

/// The rays of one row of a picture in a shape's frame, by column: level ones times the cosine of
/// the row's elevation, and upwards by its sine.
struct RowOfRays {
  const double* level[3];
  double cosine;
  Vector3 upwards;

  [[nodiscard]] Vector3 direction(int column) const {
    return cosine * Vector3(level[0][column], level[1][column], level[2][column]) + upwards;
  }
};

/// The way along a ray from a point outside a solid to where it meets it first; infinite where it
/// misses [m].
template <typename Solid>
class WayToSolid {
 public:
  WayToSolid(const Solid& solid, const Vector3& origin) : solid_(solid), origin_(origin) {}

  double operator()(const Vector3& direction) const {
    const LineSpan span = lineSpan(solid_, {origin_, direction});
    if (span.empty() || span.leave < 0.0) return std::numeric_limits<double>::infinity();
    return std::max(0.0, span.enter);
  }

 private:
  const Solid& solid_;
  Vector3 origin_;
};

/// As lineSpan() has it, but not where the ray leaves: one that enters ahead does so.
template <>
class WayToSolid<Capsule> {
 public:
  WayToSolid(const Capsule& capsule, const Vector3& origin)
      : capsule_(capsule),
        origin_(origin),
        outside_(origin.head<2>().squaredNorm() - capsule.radius * capsule.radius),
        balls_{Ball(origin, -capsule.half_length, capsule.radius),
               Ball(origin, capsule.half_length, capsule.radius)} {}

  double operator()(const Vector3& direction) const {
    const Eigen::Vector2d across = direction.head<2>();
    const double a = across.squaredNorm();
    if (a < 1e-24) return alongAnyRay(direction);
    const double b = origin_.head<2>().dot(across);
    const double discriminant = b * b - a * outside_;
    if (discriminant < 0.0) return kInfinity;
    double enter = (-b - std::sqrt(discriminant)) / a;
    const double height = origin_.z() + enter * direction.z();
    if (std::abs(height) > capsule_.half_length) {
      const Ball& ball = balls_[height > 0.0 ? 1 : 0];
      const double towards = ball.from_centre.dot(direction);
      const double ball_discriminant = towards * towards - ball.outside;
      if (ball_discriminant < 0.0) return kInfinity;
      enter = -towards - std::sqrt(ball_discriminant);
    }
    return enter >= 0.0 ? enter : alongAnyRay(direction);
  }

 private:
  static constexpr double kInfinity = std::numeric_limits<double>::infinity();

  struct Ball {
    Ball(const Vector3& origin, double z, double radius)
        : from_centre(origin - Vector3(0.0, 0.0, z)),
          outside(from_centre.squaredNorm() - radius * radius) {}
    Vector3 from_centre;
    double outside;
  };

  [[nodiscard]] double alongAnyRay(const Vector3& direction) const {
    const LineSpan span = lineSpan(capsule_, {origin_, direction});
    return span.empty() || span.leave < 0.0 ? kInfinity : std::max(0.0, span.enter);
  }

  const Capsule& capsule_;
  Vector3 origin_;
  double outside_;
  Ball balls_[2];
};

/// Where the rays of a row first meet a solid.
template <typename Solid>
class RowEntry {
 public:
  RowEntry(const Solid& solid, const Vector3& origin) : way_(solid, origin) {}

  /// @param shown by column: what is nearer than the least way to the solid is not asked for.
  /// @param found by column the way there [m]; infinite where the ray misses, and mostly where it
  /// is not asked for.
  void find(const RowOfRays& rays, int begin, int end, const float* shown, float least,
            float* found) const {
    for (int c = begin; c < end; ++c) {
      found[c] = shown[c] < least ? std::numeric_limits<float>::infinity()
                                  : static_cast<float>(way_(rays.direction(c)));
    }
  }

 private:
  WayToSolid<Solid> way_;
};

/// Only faces whose outer side the origin is on can be entered through. In loops over columns
/// without branches, which compilers take several rays at a time through: boxes fill most of a
/// picture.
template <>
class RowEntry<Box> {
 public:
  RowEntry(const Box& box, const Vector3& origin)
      : half_(box.half_extents * (1.0 + kRounding)), origin_(origin) {
    for (int i = 0; i < 3; ++i) {
      inward_[i] = -std::copysign(1.0, origin[i]);
      beyond_[i] = std::abs(origin[i]) - box.half_extents[i];
    }
  }

  void find(const RowOfRays& rays, int begin, int end, const float* /*shown*/, float /*least*/,
            float* found) {
    for (int from = begin; from < end; from += kBatch) {
      const int count = std::min(kBatch, end - from);
      std::fill(way_, way_ + count, 0.0);
      for (int axis = 0; axis < 3; ++axis) {
        if (beyond_[axis] > 0.0) goToFace(rays, axis, from, count);
      }
      leaveOutBeside(rays, from, count);
      for (int k = 0; k < count; ++k) found[from + k] = static_cast<float>(way_[k]);
    }
  }

 private:
  static constexpr double kRounding = 1e-12;
  static constexpr double kInfinity = std::numeric_limits<double>::infinity();
  static constexpr int kBatch = 64;

  void goToFace(const RowOfRays& rays, int axis, int from, int count) {
    const double inward = inward_[axis], beyond = beyond_[axis];
    const double cosine = rays.cosine, upwards = rays.upwards[axis];
    const double* level = rays.level[axis] + from;
    for (int k = 0; k < count; ++k) {
      const double towards = inward * (cosine * level[k] + upwards);
      const double way = beyond / towards;
      const double furthest = way_[k] < way ? way : way_[k];
      way_[k] = towards > 0.0 ? furthest : kInfinity;
    }
  }

  void leaveOutBeside(const RowOfRays& rays, int from, int count) {
    const double cosine = rays.cosine;
    const double *x = rays.level[0] + from, *y = rays.level[1] + from, *z = rays.level[2] + from;
    const double up_x = rays.upwards.x(), up_y = rays.upwards.y(), up_z = rays.upwards.z();
    const double from_x = origin_.x(), from_y = origin_.y(), from_z = origin_.z();
    const double half_x = half_.x(), half_y = half_.y(), half_z = half_.z();
    for (int k = 0; k < count; ++k) {
      const double way = way_[k];
      double found = std::abs(from_x + way * (cosine * x[k] + up_x)) > half_x ? kInfinity : way;
      found = std::abs(from_y + way * (cosine * y[k] + up_y)) > half_y ? kInfinity : found;
      found = std::abs(from_z + way * (cosine * z[k] + up_z)) > half_z ? kInfinity : found;
      way_[k] = found;
    }
  }

  Vector3 half_;
  Vector3 origin_;
  Vector3 inward_;           ///< signs of directions that lead in
  Vector3 beyond_;           ///< how far the origin is outside of the faces on its side [m]
  double way_[kBatch] = {};  ///< of the rays at hand to the furthest of these faces
};

}  // namespace tccm
