#pragma once

#include <sensor_msgs/Image.h>
#include <tccm_monitor/CuboidMap.h>
#include <visualization_msgs/Marker.h>
#include <visualization_msgs/MarkerArray.h>

#include <string>

#include "tccm_monitor/check/checker.h"

namespace tccm {

/// All cuboids as one TRIANGLE_LIST: static ones green, dynamic ones red (paper, Fig. 7), those in
/// collision magenta, occluding ones blue. @param static_windows dyn from which on one is static.
void toMarker(const tccm_monitor::CuboidMap& map, int static_windows,
              visualization_msgs::Marker& marker);

/// The primitives as checked for collision, now (solid) and ahead (pale): magenta where they touch
/// the map, blue where hidden from the sensor, grey otherwise; those drawn for occlusion (green);
/// the cuboid touched first on the way ahead (magenta; yellow where only the margin for speed
/// touches it); the regions of exemptions (cyan); and level, reason, speed and clearance as text.
/// Each in a namespace of its own.
void toMarkers(const Verdict& verdict, const Checker& checker, const std::string& frame,
               visualization_msgs::MarkerArray& markers);

/// The body as the self filter takes it, paddings included (yellow).
void toMarkers(const BodySample& sample, const std::string& frame,
               visualization_msgs::MarkerArray& markers);

/// The Z-buffer of the last check's present pose, as the sensor sees it, rgb8: links grey, where
/// hidden blue; everything else black.
void toImage(const ZBuffer& picture, sensor_msgs::Image& image);

}  // namespace tccm
