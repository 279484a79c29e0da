#include "ros/cloud_scan.h"

#include <sensor_msgs/point_cloud2_iterator.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>

#include "base/line_of.h"
#include "ros/conversions.h"

namespace tccm {
namespace {

using tccm_monitor::CloudScan;

geometry_msgs::Point toPoint(const Vector3& p) {
  geometry_msgs::Point point;
  point.x = p.x();
  point.y = p.y();
  point.z = p.z();
  return point;
}

Vector3 fromPoint(const geometry_msgs::Point& point) { return {point.x, point.y, point.z}; }

void put(const Vector3& p, float* numbers) {
  for (int k = 0; k < 3; ++k) numbers[k] = static_cast<float>(p[k]);
}

Vector3 take(const float* numbers) {
  return Eigen::Map<const Eigen::Vector3f>(numbers).cast<double>();
}

/// Its place in the list, at the end where it is new. Few are asked for: the latest come first.
std::uint16_t placeOf(const Vector3& viewpoint, std::vector<geometry_msgs::Point>& list) {
  constexpr std::size_t kMost = std::numeric_limits<std::uint16_t>::max();
  const auto is_it = [&](const geometry_msgs::Point& known) {
    return known.x == viewpoint.x() && known.y == viewpoint.y() && known.z == viewpoint.z();
  };
  const auto found = std::find_if(list.rbegin(), list.rend(), is_it);
  if (found != list.rend()) return static_cast<std::uint16_t>(list.rend() - found - 1);
  if (list.size() <= kMost) list.push_back(toPoint(viewpoint));
  return static_cast<std::uint16_t>(list.size() - 1);
}

bool isKind(std::uint8_t kind) { return kind >= CloudScan::SURFACE && kind <= CloudScan::UNCLEAR; }

std::string defectOf(const CloudScan& message) {
  const std::size_t looks = message.look_kinds.size();
  if (message.points.size() % 3 != 0 || message.look_ends.size() != 3 * looks) {
    return lineOf("it has %zu numbers for points, and %zu for %zu looks: three each are needed",
                  message.points.size(), message.look_ends.size(), looks);
  }
  const std::size_t viewpoints = message.look_viewpoints.size();
  const bool is_one = message.look_origins.empty() && viewpoints == 1;
  const bool is_each = message.look_origins.size() == looks &&
                       std::all_of(message.look_origins.begin(), message.look_origins.end(),
                                   [&](std::uint16_t origin) { return origin < viewpoints; });
  if (!is_one && !is_each) {
    return lineOf("it has %zu look_origins for %zu looks from %zu look_viewpoints",
                  message.look_origins.size(), looks, viewpoints);
  }
  if (!std::all_of(message.look_kinds.begin(), message.look_kinds.end(), isKind)) {
    return "it has a look of a kind that there is not";
  }
  return {};
}

}  // namespace

void toMessage(const ScanReturns& returns, const std::string& frame, CloudScan& message) {
  message.header.frame_id = frame;
  message.header.stamp = toRos(returns.stamp);
  message.viewpoint = toPoint(returns.viewpoint);
  message.points.resize(3 * returns.points.size());
  for (std::size_t i = 0; i < returns.points.size(); ++i) {
    put(returns.points[i], &message.points[3 * i]);
  }
  message.look_ends.resize(3 * returns.looks.size());
  message.look_kinds.resize(returns.looks.size());
  message.look_origins.resize(returns.looks.size());
  message.look_viewpoints.clear();
  for (std::size_t i = 0; i < returns.looks.size(); ++i) {
    const Look& look = returns.looks[i];
    put(look.end, &message.look_ends[3 * i]);
    message.look_kinds[i] = static_cast<std::uint8_t>(look.what);
    message.look_origins[i] = placeOf(look.viewpoint, message.look_viewpoints);
  }
  if (message.look_viewpoints.size() == 1) message.look_origins.clear();
}

std::string fromMessage(const CloudScan& message, ScanReturns& returns) {
  std::string defect = defectOf(message);
  if (!defect.empty()) return defect;
  returns.stamp = toTime(message.header.stamp);
  returns.viewpoint = fromPoint(message.viewpoint);
  returns.tilt = 0.0;
  returns.is_whole = true;
  returns.points.resize(message.points.size() / 3);
  Vector3* next = returns.points.data();
  for (std::size_t i = 0; i < message.points.size(); i += 3) {
    const float* p = &message.points[i];
    *next = take(p);
    if ((p[0] - p[0]) + (p[1] - p[1]) + (p[2] - p[2]) == 0.0F) ++next;  // all finite
  }
  returns.points.resize(static_cast<std::size_t>(next - returns.points.data()));
  returns.looks.clear();
  for (std::size_t i = 0; i < message.look_kinds.size(); ++i) {
    const std::size_t origin = message.look_origins.empty() ? 0 : message.look_origins[i];
    const Look look{fromPoint(message.look_viewpoints[origin]), take(&message.look_ends[3 * i]),
                    static_cast<Seen>(message.look_kinds[i])};
    if (look.end.allFinite() && look.viewpoint.allFinite()) returns.looks.push_back(look);
  }
  return {};
}

void toPoints(const ScanReturns& returns, const std::string& frame,
              sensor_msgs::PointCloud2& message) {
  message.header.frame_id = frame;
  message.header.stamp = toRos(returns.stamp);
  sensor_msgs::PointCloud2Modifier layout(message);
  layout.setPointCloud2Fields(3, "x", 1, sensor_msgs::PointField::FLOAT32, "y", 1,
                              sensor_msgs::PointField::FLOAT32, "z", 1,
                              sensor_msgs::PointField::FLOAT32);
  layout.resize(returns.points.size());
  message.is_dense = 1;
  std::uint8_t* bytes = message.data.data();
  for (const Vector3& p_fixed : returns.points) {
    float numbers[3];
    put(p_fixed, numbers);
    std::memcpy(bytes, numbers, sizeof numbers);
    bytes += sizeof numbers;
  }
}

}  // namespace tccm
