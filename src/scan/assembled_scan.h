#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "tccm_monitor/laser_scan.h"
#include "tccm_monitor/pose.h"

namespace tccm {

/// A beam in the fixed frame, each with the sensor's pose at the beam's own time.
struct Beam {
  Time stamp;
  /// Where it hit [m]; of kNoReturn, how far it could have seen. Where no range was measured, a
  /// point that tells the direction alone.
  Vector3 p_fixed;
  Vector3 viewpoint;  ///< the sensor's origin in the fixed frame [m]
  double tilt = 0.0;  ///< elevation of the sensor's x axis over the fixed frame's xy plane [rad]
  BeamKind kind = BeamKind::kUnknown;

  /// True for every kind that a range was measured for, also where a filter removed it.
  [[nodiscard]] bool measured() const {
    return kind == BeamKind::kReturn || kind == BeamKind::kMixedPixel || kind == BeamKind::kSelf ||
           kind == BeamKind::kShadow;
  }
};

/// A scan's beams in the fixed frame, in the order they were measured.
struct AssembledScan {
  Time stamp;
  std::vector<Beam> beams;

  /// How many beams are of each kind, indexed by BeamKind.
  [[nodiscard]] BeamCounts counts() const;
};

}  // namespace tccm
