#pragma once

#include <sensor_msgs/Image.h>
#include <tccm_monitor/CuboidMap.h>
#include <visualization_msgs/Marker.h>
#include <visualization_msgs/MarkerArray.h>

#include <string>

#include "check/checker_config.h"

namespace tccm {

enum class CuboidLayer {
  kLive,  ///< what the window's scans saw
  kHeld,  ///< what left the window while nobody looked at its place
};

/// A layer's cuboids as one TRIANGLE_LIST: static ones green, dynamic ones red (paper, Fig. 7),
/// held ones violet and translucent, in a namespace of their own.
/// @param static_windows dyn from which on one is static.
void toMarker(const tccm_monitor::CuboidMap& map, CuboidLayer layer, int static_windows,
              visualization_msgs::Marker& marker);

/// The primitives as checked for collision, now (solid) and ahead (pale): magenta where they touch
/// the map, blue where hidden from the sensor, grey otherwise; those drawn for occlusion (green);
/// the cuboids that they touch (magenta) or are hidden behind (blue); the one touched first on the
/// way ahead (magenta; yellow where only the margin for speed
/// touches it); places on the way ahead that were not seen (orange); at each link whose way is
/// watched the age of what is known of it (green, and red when it is too old; "?" where nothing
/// is); the regions of exemptions (cyan); and level, reason, speed, unseen share and clearance as
/// text. Each in a namespace of its own.
void toMarkers(const Verdict& verdict, const Checker& checker, const std::string& frame,
               visualization_msgs::MarkerArray& markers);

/// The body as the self filter takes it, paddings included (yellow).
void toMarkers(const BodySample& sample, const std::string& frame,
               visualization_msgs::MarkerArray& markers);

/// The Z-buffer of the last check's present pose, as the sensor sees it, rgb8: links grey, where
/// hidden blue; everything else black.
void toImage(const ZBuffer& picture, sensor_msgs::Image& image);

}  // namespace tccm
