#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "tccm_monitor/pose.h"
#include "tccm_monitor/shape.h"
#include "tccm_monitor/time.h"

namespace tccm::simulation {

/// Everything a beam can hit at one instant, and the sensor. A target is a shape of the body.
struct Snapshot {
  Time stamp;
  Pose T_fixed_sensor;
  Body targets;
  std::vector<std::size_t> labels;  ///< what each target is called in BeamTruth
};

/// What a beam really met.
struct BeamTruth {
  std::optional<std::size_t> label;  ///< of the surface on the beam's axis; nothing within range
  bool mixed = false;                ///< the range lies between two surfaces
  std::size_t mixed_near = 0;        ///< label of the nearer of them; only where mixed
  std::size_t mixed_far = 0;         ///< label of the farther one
};

}  // namespace tccm::simulation
