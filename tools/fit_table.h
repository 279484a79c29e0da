#pragma once

#include <ostream>
#include <string>

#include "tccm_monitor/robot_model.h"

namespace tccm {

/// What a fit came to, over all elements that are meshes.
struct FitTotals {
  std::size_t meshes = 0;
  std::size_t primitives = 0;
  double volume_m3 = 0.0;       ///< of the primitives, what they share counted twice
  double hull_volume_m3 = 0.0;  ///< of the meshes' convex hulls
  double overhang_m = 0.0;      ///< the furthest
};

[[nodiscard]] FitTotals totalsOf(const RobotModel& model);

/// One line a primitive: link, what the URDF has there, kind, size [mm], volume against the hull's,
/// largest overhang [mm]; then the totals, and the links that have no shape.
void printTable(const RobotModel& model, std::ostream& out);

}  // namespace tccm
