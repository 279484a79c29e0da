#pragma once

#include <vector>

#include "sight/look.h"
#include "tccm_monitor/time.h"

namespace tccm {

/// What the map takes of a scan.
struct ScanReturns {
  Time stamp;                           ///< of the first beam
  Vector3 viewpoint = Vector3::Zero();  ///< the sensor's origin at the last beam [m]
  double tilt = 0.0;                    ///< of the sensor at the first beam [rad]
  std::vector<Vector3> points;          ///< in the fixed frame [m]
  std::vector<Look> looks;              ///< what its beams say of the space along them
};

}  // namespace tccm
