#pragma once

#include <string>

#include "scan/assembled_scan.h"

namespace tccm {

/// Why a scan cannot be projected at all; empty where it can: no beams, more than max_beams, range
/// limits or angles that are not finite or contradict each other, a negative time increment.
[[nodiscard]] std::string defectOf(const LaserScan& scan, std::size_t max_beams);

/// Projects each beam with the sensor's pose at that beam's own time and sorts it by REP 117 and
/// the scan's range limits. Writes into result, whose capacity is reused.
/// @return false, with result left without beams, where T_fixed_sensor does not cover the scan.
[[nodiscard]] bool project(const LaserScan& scan, const PosePath& T_fixed_sensor,
                           AssembledScan& result);

}  // namespace tccm
