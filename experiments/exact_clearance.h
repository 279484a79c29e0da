#pragma once

#include "tccm_monitor/shape.h"

namespace tccm::simulation {

/// Distance between two bodies [m], 0 where they meet, by FCL on the shapes themselves: nothing of
/// the monitor's own geometry judges it. Its solver stops at about 1e-6 m.
[[nodiscard]] double exactClearance(const Body& a, const Body& b);

/// Whether they meet, by the same, at a fraction of the cost.
[[nodiscard]] bool exactlyTouch(const Body& a, const Body& b);

}  // namespace tccm::simulation
