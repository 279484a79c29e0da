#pragma once

#include <array>
#include <cstddef>
#include <string>
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
  /// How many of them were taken for each shape of the body, in its order.
  std::vector<std::size_t> self_counts = {};

  /// How many beams are of each kind, indexed by BeamKind.
  [[nodiscard]] BeamCounts counts() const;
};

/// Why a scan cannot be projected at all; empty where it can: no beams, more than max_beams, range
/// limits or angles that are not finite or contradict each other, a negative time increment.
[[nodiscard]] std::string defectOf(const LaserScan& scan, std::size_t max_beams);

/// Projects each beam with the sensor's pose at that beam's own time and sorts it by REP 117 and
/// the scan's range limits. Writes into result, whose capacity is reused.
/// @return false, with result left without beams, where T_fixed_sensor does not cover the scan.
[[nodiscard]] bool project(const LaserScan& scan, const PosePath& T_fixed_sensor,
                           AssembledScan& result);

}  // namespace tccm
