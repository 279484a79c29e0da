#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "tccm_monitor/time.h"

namespace tccm {

/// One scan of a planar laser range finder, as REP 117 and sensor_msgs/LaserScan define it: beam i
/// leaves at angle_min + i * angle_increment about the sensor's z axis, 0 along x.
struct LaserScan {
  Time stamp;                    ///< of the first beam
  double angle_min = 0.0;        ///< [rad]
  double angle_increment = 0.0;  ///< [rad], may be negative
  Duration time_increment{0};    ///< between two beams; 0: all at the stamp
  double range_min = 0.0;        ///< [m]
  double range_max = 0.0;        ///< [m]
  std::vector<float> ranges;     ///< [m]; +inf nothing hit, -inf too close, NaN unknown
  /// [rad]; where the last beam leaves, to one increment, by what the driver says. Nothing: not
  /// said.
  std::optional<double> angle_max = {};

  [[nodiscard]] Time beamTime(std::size_t beam) const {
    return stamp + static_cast<Duration::rep>(beam) * time_increment;
  }
  /// The stamp where there are no beams.
  [[nodiscard]] Time lastBeamTime() const {
    return ranges.empty() ? stamp : beamTime(ranges.size() - 1);
  }
};

/// What became of a beam on its way to the map.
enum class BeamKind : std::uint8_t {
  kReturn,      ///< a point for the map
  kNoReturn,    ///< nothing within range_max: +inf (REP 117), or range_max itself
  kTooClose,    ///< -inf, or nearer than range_min
  kUnknown,     ///< NaN: no measurement; or a range beyond range_max, which says nothing
  kMixedPixel,  ///< between two surfaces (paper, section VI.A, Fig. 12 left)
  kSelf,        ///< in or near the robot's own body (Fig. 12 right)
  kShadow,      ///< behind the edge of the robot's body (Fig. 12 right)
  kThinned,     ///< of a cloud, so near to others that these stand for it
};
constexpr std::size_t kBeamKinds = 8;
using BeamCounts = std::array<std::size_t, kBeamKinds>;  ///< indexed by BeamKind

}  // namespace tccm
