#pragma once

#include <optional>

#include "tccm_monitor/shape.h"

namespace tccm {

/// Half-line from origin along direction.
struct Ray {
  Vector3 origin;
  Vector3 direction;  ///< of length 1

  [[nodiscard]] Vector3 at(double range) const { return origin + range * direction; }
};

/// Where a ray is inside a convex solid: enter <= leave, both at least 0 [m].
struct RaySpan {
  double enter;
  double leave;
};

/// The ray in another frame. @param T_target_source takes the ray's coordinates to the target's.
[[nodiscard]] Ray transformed(const Ray& ray, const Pose& T_target_source);

/// Nothing where the ray misses. An origin inside the shape enters at 0.
/// @param ray in the shape's frame.
[[nodiscard]] std::optional<RaySpan> intersect(const Shape& shape, const Ray& ray);

}  // namespace tccm
