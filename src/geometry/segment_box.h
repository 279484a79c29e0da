#pragma once

#include <algorithm>

#include "tccm_monitor/pose.h"

namespace tccm {

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
