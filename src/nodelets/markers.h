#pragma once

#include <sensor_msgs/Image.h>
#include <tccm_monitor/CuboidMap.h>
#include <visualization_msgs/Marker.h>
#include <visualization_msgs/MarkerArray.h>

#include <string>
#include <utility>
#include <vector>

#include "check/checker_config.h"

namespace tccm {

using visualization_msgs::Marker;
using visualization_msgs::MarkerArray;

enum class CuboidLayer {
  kLive,  ///< what the window's scans saw
  kHeld,  ///< what left the window while nobody looked at its place
};

/// A layer's cuboids as one TRIANGLE_LIST: static ones green, dynamic ones red (paper, Fig. 7),
/// held ones violet and translucent, in a namespace of their own.
/// @param static_windows dyn from which on one is static.
[[nodiscard]] Marker toMarker(const tccm_monitor::CuboidMap& map, CuboidLayer layer,
                              int static_windows);

/// What brought a stop about, kept while the stop lasts: people see nothing that is over within a
/// few hundredths of a second.
class StopCause {
 public:
  /// To be told each verdict. @param map that it rests on; null where there is none.
  void follow(const Verdict& verdict, const CuboidMap* map);

  /// Whether the stop lasts although nothing is found any more.
  [[nodiscard]] bool outlives(const Verdict& verdict) const;
  [[nodiscard]] Reason reason() const { return reason_; }
  [[nodiscard]] const std::string& detail() const { return detail_; }
  /// What was touched or hid a link, and its col as in Cuboid.msg.
  [[nodiscard]] const std::vector<std::pair<UprightBox, std::uint8_t>>& boxes() const {
    return boxes_;
  }

 private:
  Reason reason_ = Reason::kClear;  ///< no stop lasts
  std::string detail_;
  std::vector<std::pair<UprightBox, std::uint8_t>> boxes_;
};

/// The robot as it was checked, and what was found, each in a namespace of its own: those of
/// robot_markers in docs/interfaces.md. @param cause of the stop, where one lasts.
[[nodiscard]] MarkerArray toMarkers(const Verdict& verdict, const StopCause& cause,
                                    const Checker& checker, const std::string& frame);

/// The body as the self filter takes it, paddings included (yellow).
[[nodiscard]] MarkerArray toMarkers(const BodySample& sample, const std::string& frame);

/// The Z-buffer of the last check's present pose, as the sensor sees it, rgb8: links grey, where
/// hidden blue; everything else black.
[[nodiscard]] sensor_msgs::Image toImage(const ZBuffer& picture);

}  // namespace tccm
