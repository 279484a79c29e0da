#pragma once

#include "tccm_monitor/look_image.h"

namespace tccm {

/// What one beam says of the space along it: there was nothing between the viewpoint and its end.
struct Look {
  Vector3 viewpoint;  ///< the sensor's origin [m, fixed frame]
  Vector3 end;        ///< [m, fixed frame]
  Seen what = Seen::kSurface;
};

}  // namespace tccm
