#pragma once

#include <algorithm>

#include "tccm_monitor/shape.h"

namespace tccm {

/// Distance between a placed shape and an upright box [m]; 0 where they have a point in common.
/// Sphere, capsule and a cylinder that is nearest with its side: exact up to rounding. Box and
/// cylinder else: at most 1e-6 m too small and, but for rounding, never too large (Gilbert, Johnson
/// and Keerthi 1988, ended by its own lower bound). Sizes may be 0, as core() makes them. A pose
/// that is NaN gives 0. Allocates nothing.
[[nodiscard]] double distance(const Shape& shape, const Pose& T_fixed_shape, const UprightBox& box);

/// A distance, and what shows that it is no less.
struct Separation {
  double distance_m = 0.0;  ///< as distance() gives it
  /// Across it a gap of that width lies between the two: from the box towards the shape, of length
  /// 1; 0 where they have a point in common.
  Vector3 direction = Vector3::Zero();
};
/// @param enough_m from here on the distance may be given too small, if not below this: what is not
/// nearer than the nearest so far need not be known.
[[nodiscard]] Separation separation(const Shape& shape, const Pose& T_fixed_shape,
                                    const UprightBox& box, double enough_m);

/// The shape's point furthest in a direction, in the fixed frame.
[[nodiscard]] Vector3 furthest(const Shape& shape, const Pose& T_fixed_shape,
                               const Vector3& direction);

/// Never above the distance between the shape and the box, but for rounding, and much cheaper.
/// @param bounds_of_shape what bounds() gives, in the box's frame.
[[nodiscard]] double distanceBound(const UprightBox& bounds_of_shape, const UprightBox& box);

/// What is left of a shape in its middle, in the same frame: of a sphere the centre, of a capsule
/// and a cylinder the axis, as a sphere and a capsule of radius 0; of a box the rectangle (or
/// segment or point) that is left when every side moves in by the smallest half extent. Every point
/// of it lies in the shape. Tells deep contacts from shallow ones.
[[nodiscard]] Shape core(const Shape& shape);

/// From the nearest point of the box around 0 to p; 0 inside, NaN where p is.
inline Vector3 outside(const Vector3& p, const Vector3& half) {
  Vector3 result;
  for (int i = 0; i < 3; ++i) result[i] = p[i] - std::max(-half[i], std::min(p[i], half[i]));
  return result;
}

/// Where the segment origin + t * direction is nearest to the box around 0; t in [0, 1]. Strictly
/// between 0 and 1 only where the distance has no slope.
/// The squared distance is convex in t and its slope piecewise linear, with breaks where a
/// coordinate crosses a face: the slope's root lies between the last break where it is below 0 and
/// the first where it is not.
inline double nearestOnSegment(const Vector3& origin, const Vector3& direction,
                               const Vector3& half) {
  const auto slope = [&](double t) { return direction.dot(outside(origin + t * direction, half)); };
  double low = 0.0, slope_low = slope(low);
  if (slope_low >= 0.0) return low;
  double high = 1.0, slope_high = slope(high);
  if (slope_high <= 0.0) return high;
  for (int i = 0; i < 3; ++i) {
    for (const double face : {-half[i], half[i]}) {
      const double t = (face - origin[i]) / direction[i];
      if (!(t > low && t < high)) continue;
      const double here = slope(t);
      if (here < 0.0) {
        low = t;
        slope_low = here;
      } else {
        high = t;
        slope_high = here;
      }
    }
  }
  return slope_high > slope_low ? low + (high - low) * slope_low / (slope_low - slope_high) : low;
}

}  // namespace tccm
