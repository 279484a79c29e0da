#pragma once

#include <sensor_msgs/PointCloud2.h>

#include <vector>

#include "ros/conversions.h"
#include "scan/cloud.h"
#include "support/driver_clouds.h"

namespace tccm {

/// As drivers lay it out: x, y, z and a word beside them, of a lidar the time in nanoseconds.
inline sensor_msgs::PointCloud2 messageOf(const Cloud& cloud) {
  std::vector<test::DriverField> fields = {
      {"x", 0, test::kF32}, {"y", 4, test::kF32}, {"z", 8, test::kF32}};
  const bool is_timed = !cloud.offsets_s.empty();
  if (is_timed) fields.push_back({"t", 12, test::kU32});
  sensor_msgs::PointCloud2 message =
      test::emptyCloud(static_cast<std::uint32_t>(cloud.width),
                       static_cast<std::uint32_t>(cloud.height), 16, fields);
  message.header.stamp = toRos(cloud.stamp);
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    for (std::uint32_t k = 0; k < 3; ++k) test::put(message, i, 4 * k, cloud.points[i][k]);
    if (!is_timed) continue;
    test::put(message, i, 12,
              static_cast<std::uint32_t>(1e9 * static_cast<double>(cloud.offsets_s[i])));
  }
  return message;
}

}  // namespace tccm
