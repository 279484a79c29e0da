#pragma once

#include "tccm_monitor/look_image.h"

namespace tccm {

constexpr double kNearestLook = 1e-3;  // [m]; what is this near has no direction

/// What one beam says of the space along it: there was nothing between the viewpoint and its end.
struct Look {
  Vector3 viewpoint;  ///< the sensor's origin [m, fixed frame]
  Vector3 end;        ///< [m, fixed frame]
  Seen what = Seen::kSurface;
};

/// What the map takes of a scan.
struct ScanReturns {
  Time stamp;                           ///< of the first beam
  Vector3 viewpoint = Vector3::Zero();  ///< the sensor's origin at the last beam [m]
  double tilt = 0.0;                    ///< of the sensor at the first beam [rad]
  /// A camera's frame or a lidar's turn: it has no tilt, and its looks are a pass of their own.
  bool is_whole = false;
  std::vector<Vector3> points;  ///< in the fixed frame [m]
  std::vector<Look> looks;
};

}  // namespace tccm
