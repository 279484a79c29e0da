#pragma once

#include <vector>

#include "tccm_monitor/shape.h"

namespace tccm {

/// How far a primitive reaches beyond the convex hull of points, at least one: the largest distance
/// of any of its points from the hull [m]. Never less than it is, but for rounding, and at most 0.1
/// mm more. The same input gives the same result.
[[nodiscard]] double overhang(const PlacedShape& primitive, const std::vector<Vector3>& points);

}  // namespace tccm
