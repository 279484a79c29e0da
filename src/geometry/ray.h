#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "tccm_monitor/shape.h"

namespace tccm {

/// Half-line from origin along direction.
struct Ray {
  Vector3 origin;
  Vector3 direction;  ///< of length 1

  [[nodiscard]] Vector3 at(double range) const { return origin + range * direction; }
};

/// The ray in another frame. @param T_target_source takes the ray's coordinates to the target's.
[[nodiscard]] inline Ray transformed(const Ray& ray, const Pose& T_target_source) {
  return {T_target_source * ray.origin, T_target_source.linear() * ray.direction};
}

/// The part of a whole line inside a solid [m along the ray's direction, from its origin]; empty
/// where enter > leave. In a header, because a picture takes thousands of them.
struct LineSpan {
  double enter = -std::numeric_limits<double>::infinity();
  double leave = std::numeric_limits<double>::infinity();

  void meet(const LineSpan& other) {
    enter = std::max(enter, other.enter);
    leave = std::min(leave, other.leave);
  }
  [[nodiscard]] bool empty() const { return !(enter <= leave); }
  [[nodiscard]] static LineSpan none() { return {1.0, 0.0}; }
};

/// Between the planes x = -half and x = half, for one coordinate.
[[nodiscard]] inline LineSpan slabSpan(double origin, double direction, double half) {
  if (direction == 0.0) return std::abs(origin) <= half ? LineSpan{} : LineSpan::none();
  const double inverse = 1.0 / direction;
  const double a = (-half - origin) * inverse;
  const double b = (half - origin) * inverse;
  return {std::min(a, b), std::max(a, b)};
}

/// Roots of a t^2 + 2 b t + c <= 0 for a > 0.
[[nodiscard]] inline LineSpan quadraticSpan(double a, double b, double c) {
  const double discriminant = b * b - a * c;
  if (!(discriminant >= 0.0)) return LineSpan::none();
  const double root = std::sqrt(discriminant);
  return {(-b - root) / a, (-b + root) / a};
}

[[nodiscard]] inline LineSpan ballSpan(const Vector3& centre, double radius, const Ray& ray) {
  const Vector3 from_centre = ray.origin - centre;
  return quadraticSpan(1.0, from_centre.dot(ray.direction),
                       from_centre.squaredNorm() - radius * radius);
}

/// The unbounded cylinder around z.
[[nodiscard]] inline LineSpan tubeSpan(double radius, const Ray& ray) {
  const Eigen::Vector2d o = ray.origin.head<2>();
  const Eigen::Vector2d d = ray.direction.head<2>();
  const double outside = o.squaredNorm() - radius * radius;
  if (d.squaredNorm() < 1e-24) return outside <= 0.0 ? LineSpan{} : LineSpan::none();
  return quadraticSpan(d.squaredNorm(), o.dot(d), outside);
}

[[nodiscard]] inline LineSpan lineSpan(const Box& box, const Ray& ray) {
  LineSpan span;
  for (int i = 0; i < 3; ++i) {
    span.meet(slabSpan(ray.origin[i], ray.direction[i], box.half_extents[i]));
  }
  return span;
}

[[nodiscard]] inline LineSpan lineSpan(const Cylinder& c, const Ray& ray) {
  LineSpan span = tubeSpan(c.radius, ray);
  if (!span.empty()) span.meet(slabSpan(ray.origin.z(), ray.direction.z(), c.half_length));
  return span;
}

[[nodiscard]] inline LineSpan lineSpan(const Sphere& s, const Ray& ray) {
  return ballSpan(Vector3::Zero(), s.radius, ray);
}

/// Within its tube, a capsule ends where its balls do: a line that crosses the tube's wall beside
/// the straight part enters or leaves there, any other through the ball on that side.
[[nodiscard]] inline LineSpan lineSpan(const Capsule& c, const Ray& ray) {
  const LineSpan tube = tubeSpan(c.radius, ray);
  if (tube.empty()) return tube;
  const auto ballAt = [&](double side) {
    return ballSpan(Vector3(0.0, 0.0, side * c.half_length), c.radius, ray);
  };
  const auto heightAt = [&](double t) { return ray.origin.z() + t * ray.direction.z(); };
  if (std::isinf(tube.enter)) {  // along the axis: in through one ball, out through the other
    const double from = ray.direction.z() > 0.0 ? -1.0 : 1.0;
    return {ballAt(from).enter, ballAt(-from).leave};
  }
  LineSpan span = tube;
  const double enter_z = heightAt(tube.enter), leave_z = heightAt(tube.leave);
  if (std::abs(enter_z) > c.half_length) {
    const LineSpan ball = ballAt(std::copysign(1.0, enter_z));
    if (ball.empty()) return ball;
    span.enter = ball.enter;
  }
  if (std::abs(leave_z) > c.half_length) {
    const LineSpan ball = ballAt(std::copysign(1.0, leave_z));
    if (ball.empty()) return ball;
    span.leave = ball.leave;
  }
  return span;
}

/// Where a ray, in the shape's frame, is inside a shape: enter <= leave, both at least 0 [m].
/// Nothing where it misses. An origin inside the shape enters at 0.
[[nodiscard]] inline std::optional<LineSpan> intersect(const Shape& shape, const Ray& ray) {
  const LineSpan span =
      std::visit([&ray](const auto& solid) { return lineSpan(solid, ray); }, shape);
  if (span.empty() || span.leave < 0.0) return std::nullopt;
  return LineSpan{std::max(0.0, span.enter), span.leave};
}

}  // namespace tccm
