#pragma once

#include <cstdint>

#include "geometry/pose.h"

namespace tccm {

/// What one beam says of the space along it: there was nothing between the viewpoint and its end.
struct Look {
  enum class End : std::uint8_t {
    kSurface,  ///< of the surroundings
    kNothing,  ///< as far as the sensor can see
    kRobot,    ///< the robot itself: what lies behind it is not known
    kUnclear,  ///< no range, or one that is not to be trusted; the end tells the direction alone
  };
  Vector3 viewpoint;  ///< the sensor's origin [m, fixed frame]
  Vector3 end;        ///< [m, fixed frame]
  End what = End::kSurface;
};

}  // namespace tccm
