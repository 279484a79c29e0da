#pragma once

#include <algorithm>
#include <limits>

#include "geometry/distance.h"
#include "map/region.h"

namespace tccm::test {

/// The least of the distances beyond each shape's padding.
inline double distanceBeyondPadding(const Region& region, const Vector3& p_fixed) {
  double least = std::numeric_limits<double>::infinity();
  for (const auto& [placed, padding] : region) {
    const Vector3 p_shape =
        placed.pose.linear().transpose() * (p_fixed - placed.pose.translation());
    least = std::min(least, distance(placed.shape, p_shape) - padding);
  }
  return least;
}

}  // namespace tccm::test
