#pragma once

#include <cmath>
#include <utility>
#include <vector>

#include "map/mapper.h"
#include "support/small_map.h"

/// Scans of a sensor that tilts up and down evenly.
namespace tccm::test::tilted {

constexpr double kScanPeriod = 0.025;  // [s]
constexpr double kTiltPeriod = 2.0;    // [s]

/// Up and down between -0.5 and 0.5 rad, evenly.
inline double tiltAt(double stamp) {
  const double phase = stamp / kTiltPeriod - std::floor(stamp / kTiltPeriod);
  return phase < 0.5 ? 2.0 * phase - 0.5 : 1.5 - 2.0 * phase;
}

inline ScanReturns scanAt(double stamp, std::vector<Vector3> points = {}) {
  ScanReturns scan;
  scan.stamp = Time(fromSeconds(stamp));
  scan.tilt = tiltAt(stamp);
  scan.points = std::move(points);
  return scan;
}

/// Scans from `first` to `last` at the tilt that `tilt` gives; the last stamp at which the map was
/// complete.
template <typename Tilt>
double lastComplete(Mapper& mapper, double first, double last, Tilt&& tilt) {
  double complete = -1.0;
  for (int i = 0; first + i * kScanPeriod <= last; ++i) {
    const double stamp = first + i * kScanPeriod;
    ScanReturns scan = scanAt(stamp);
    scan.tilt = tilt(stamp);
    mapper.add(scan);
    if (snapshotOf(mapper).complete) complete = stamp;
  }
  return complete;
}

}  // namespace tccm::test::tilted
