#pragma once

#include <vector>

#include "tccm_monitor/shape.h"

namespace tccm {

/// Small primitives around points. Each takes at least one point, all finite, and contains every
/// one of them up to rounding. No size is below kThinnest, so that every result is a valid shape.
/// The same points give the same result.
constexpr double kThinnest = 1e-6;  // [m]

/// The smallest.
[[nodiscard]] PlacedShape enclosingSphere(const std::vector<Vector3>& points);

/// The smallest to within a few per cent of volume: exact for a given direction of one axis, which
/// is searched for among the hull's faces and edges, the principal and the coordinate axes and an
/// even spread, and then refined.
[[nodiscard]] PlacedShape enclosingBox(const std::vector<Vector3>& points);
[[nodiscard]] PlacedShape enclosingCylinder(const std::vector<Vector3>& points);
/// As above; place and radius are refined as well.
[[nodiscard]] PlacedShape enclosingCapsule(const std::vector<Vector3>& points);

/// The one of least volume of the four.
[[nodiscard]] PlacedShape smallestEnclosing(const std::vector<Vector3>& points);

/// A quick upper bound of smallestEnclosing's volume [m3]: an axis along one of directions [unit
/// vectors] or no axis.
[[nodiscard]] double enclosingVolumeAlong(const std::vector<Vector3>& points,
                                          const std::vector<Vector3>& directions);

}  // namespace tccm
