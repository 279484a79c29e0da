#pragma once

#include "tccm_monitor/shape.h"

namespace tccm {

/// Whether a placed shape and an upright box have a point in common: exact for every shape, up to
/// rounding (touching counts). The core of collision detection (paper, section IV.A).
/// Sphere and capsule by the distance of a point or segment to the box, box by the separating axis
/// theorem's 15 axes, cylinder by clipping the box to the cylinder's slab and projecting it along
/// the axis.
[[nodiscard]] bool overlaps(const Shape& shape, const Pose& T_fixed_shape, const UprightBox& box);

}  // namespace tccm
