#include "ros/conversions.h"

#include <sensor_msgs/point_cloud2_iterator.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "scan/scan_stage.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

using sensor_msgs::PointField;

/// One point of scan_cloud, as its fields are laid out.
struct CloudPoint {
  float x, y, z;
  float vp_x, vp_y, vp_z;
  float tilt;
  std::uint8_t kind;
  std::uint8_t padding[3];
  float end_x, end_y, end_z;
};
static_assert(sizeof(CloudPoint) == 44, "the fields below name these offsets");

PointField field(const char* name, std::uint32_t offset, std::uint8_t type) {
  PointField f;
  f.name = name;
  f.offset = offset;
  f.datatype = type;
  f.count = 1;
  return f;
}

void layOut(sensor_msgs::PointCloud2& message) {
  if (message.fields.size() == 11 && message.point_step == sizeof(CloudPoint)) return;
  message.fields = {
      field("x", 0, PointField::FLOAT32),      field("y", 4, PointField::FLOAT32),
      field("z", 8, PointField::FLOAT32),      field("vp_x", 12, PointField::FLOAT32),
      field("vp_y", 16, PointField::FLOAT32),  field("vp_z", 20, PointField::FLOAT32),
      field("tilt", 24, PointField::FLOAT32),  field("kind", 28, PointField::UINT8),
      field("end_x", 32, PointField::FLOAT32), field("end_y", 36, PointField::FLOAT32),
      field("end_z", 40, PointField::FLOAT32)};
  message.point_step = sizeof(CloudPoint);
  message.height = 1;
  message.is_bigendian = false;
  message.is_dense = false;
}

std::string missingField(const sensor_msgs::PointCloud2& message) {
  for (const char* name :
       {"x", "y", "z", "vp_x", "vp_y", "vp_z", "tilt", "kind", "end_x", "end_y", "end_z"}) {
    const auto found = std::find_if(message.fields.begin(), message.fields.end(),
                                    [name](const PointField& f) { return f.name == name; });
    const bool is_kind = std::string(name) == "kind";
    const std::uint8_t type = is_kind ? PointField::UINT8 : PointField::FLOAT32;
    if (found == message.fields.end() || found->datatype != type) {
      return std::string(is_kind ? "it has no byte field '" : "it has no float field '") + name +
             "'";
    }
    if (std::uint64_t{found->offset} + (is_kind ? 1 : sizeof(float)) > message.point_step) {
      return std::string("its field '") + name + "' reaches beyond a point";
    }
  }
  return {};
}

using PointReader = sensor_msgs::PointCloud2ConstIterator<float>;

}  // namespace

ros::Time toRos(Time time) {
  constexpr Duration kLast = std::chrono::seconds(std::numeric_limits<std::uint32_t>::max());
  ros::Time result;
  result.fromNSec(static_cast<std::uint64_t>(
      std::clamp(time.time_since_epoch(), Duration::zero(), kLast).count()));
  return result;
}

ros::Duration toRos(Duration duration) {
  constexpr Duration kLongest = std::chrono::seconds(std::numeric_limits<std::int32_t>::max());
  ros::Duration result;
  result.fromNSec(std::clamp(duration, -kLongest, kLongest).count());
  return result;
}

LaserScan fromMessage(const sensor_msgs::LaserScan& message) {
  LaserScan scan;
  scan.stamp = toTime(message.header.stamp);
  scan.angle_min = message.angle_min;
  scan.angle_increment = message.angle_increment;
  // Not finite or absurd: negative, which defectOf() refuses.
  scan.time_increment =
      std::abs(message.time_increment) <= 1.0F ? fromSeconds(message.time_increment) : Duration(-1);
  scan.range_min = message.range_min;
  scan.range_max = message.range_max;
  scan.ranges = message.ranges;
  return scan;
}

JointTrajectory fromMessage(const trajectory_msgs::JointTrajectory& message) {
  JointTrajectory trajectory{message.joint_names, {}};
  for (const auto& point : message.points) {
    trajectory.points.push_back(
        {point.time_from_start.toSec(), point.positions, point.velocities, point.accelerations});
  }
  return trajectory;
}

void toMessage(const AssembledScan& scan, const std::string& frame,
               sensor_msgs::PointCloud2& message) {
  layOut(message);
  message.header.frame_id = frame;
  message.header.stamp = toRos(scan.stamp);
  message.width = static_cast<std::uint32_t>(scan.beams.size());
  message.row_step = message.width * message.point_step;
  message.data.resize(message.row_step);
  auto* point = reinterpret_cast<CloudPoint*>(message.data.data());
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
  for (const Beam& beam : scan.beams) {
    const Eigen::Vector3f p = beam.p_fixed.cast<float>();
    const Eigen::Vector3f viewpoint = beam.viewpoint.cast<float>();
    const bool kept = beam.kind == BeamKind::kReturn;
    *point++ = {kept ? p.x() : kNaN,
                kept ? p.y() : kNaN,
                kept ? p.z() : kNaN,
                viewpoint.x(),
                viewpoint.y(),
                viewpoint.z(),
                static_cast<float>(beam.tilt),
                static_cast<std::uint8_t>(beam.kind),
                {0, 0, 0},
                p.x(),
                p.y(),
                p.z()};
  }
}

std::string fromMessage(const sensor_msgs::PointCloud2& message, ScanReturns& returns) {
  std::string missing = missingField(message);
  if (!missing.empty()) return missing;
  const std::size_t count = static_cast<std::size_t>(message.width) * message.height;
  if (count == 0 || message.point_step == 0 || count > message.data.size() / message.point_step ||
      message.is_bigendian) {
    return "it has no points, fewer bytes than it says, or big-endian numbers";
  }
  returns.stamp = toTime(message.header.stamp);
  returns.points.clear();
  returns.looks.clear();
  PointReader x(message, "x"), y(message, "y"), z(message, "z");
  PointReader vp_x(message, "vp_x"), vp_y(message, "vp_y"), vp_z(message, "vp_z");
  PointReader end_x(message, "end_x"), end_y(message, "end_y"), end_z(message, "end_z");
  sensor_msgs::PointCloud2ConstIterator<std::uint8_t> kind(message, "kind");
  returns.tilt = *PointReader(message, "tilt");
  for (std::size_t i = 0; i < count; ++i) {
    const Vector3 p(*x, *y, *z), end(*end_x, *end_y, *end_z);
    returns.viewpoint = {*vp_x, *vp_y, *vp_z};
    if (p.allFinite()) returns.points.push_back(p);
    const auto what = *kind < kBeamKinds ? static_cast<BeamKind>(*kind) : BeamKind::kUnknown;
    if (end.allFinite() && returns.viewpoint.allFinite()) {
      returns.looks.push_back({returns.viewpoint, end, seenBy(what)});
    }
    for (PointReader* field : {&x, &y, &z, &vp_x, &vp_y, &vp_z, &end_x, &end_y, &end_z}) ++*field;
    ++kind;
  }
  return {};
}

}  // namespace tccm
