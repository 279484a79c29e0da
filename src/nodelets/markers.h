#pragma once

#include <sensor_msgs/Image.h>
#include <tccm_monitor/CuboidMap.h>
#include <visualization_msgs/Marker.h>
#include <visualization_msgs/MarkerArray.h>

#include <string>

#include "check/checker_config.h"
#include "ros/stop_cause.h"

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
