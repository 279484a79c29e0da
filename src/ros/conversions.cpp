#include "ros/conversions.h"

#include <tf2_eigen/tf2_eigen.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include "base/printable.h"
#include "scan/scan_stage.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

using sensor_msgs::PointField;

/// One point of scan_cloud: a field every four bytes.
struct CloudPoint {
  Eigen::Vector3f point, viewpoint;
  float tilt;
  std::uint8_t kind;
  std::uint8_t padding[3];
  Eigen::Vector3f end;
};
constexpr std::array<const char*, 11> kFields{"x",    "y",    "z",     "vp_x",  "vp_y", "vp_z",
                                              "tilt", "kind", "end_x", "end_y", "end_z"};
constexpr std::size_t kKind = 7;  // the only one of a byte; the others are floats
static_assert(sizeof(CloudPoint) == 4 * kFields.size());

std::uint8_t typeOf(std::size_t field) {
  return field == kKind ? PointField::UINT8 : PointField::FLOAT32;
}

void layOut(sensor_msgs::PointCloud2& message) {
  if (message.fields.size() == kFields.size() && message.point_step == sizeof(CloudPoint)) return;
  message.fields.resize(kFields.size());
  for (std::size_t i = 0; i < kFields.size(); ++i) {
    message.fields[i].name = kFields[i];
    message.fields[i].offset = static_cast<std::uint32_t>(4 * i);
    message.fields[i].datatype = typeOf(i);
    message.fields[i].count = 1;
  }
  message.point_step = sizeof(CloudPoint);
  message.height = 1;
  message.is_bigendian = false;
  message.is_dense = false;
}

/// @param offsets where a point of the cloud has each field. @return empty, or what it lacks.
std::string findFields(const sensor_msgs::PointCloud2& message,
                       std::array<std::size_t, kFields.size()>& offsets) {
  for (std::size_t i = 0; i < kFields.size(); ++i) {
    const std::string name = kFields[i];
    const auto found = std::find_if(message.fields.begin(), message.fields.end(),
                                    [&name](const PointField& f) { return f.name == name; });
    if (found == message.fields.end() || found->datatype != typeOf(i)) {
      return (i == kKind ? "it has no byte field '" : "it has no float field '") + name + "'";
    }
    offsets[i] = found->offset;
    if (offsets[i] + (i == kKind ? 1 : 4) > message.point_step) {
      return "its field '" + name + "' reaches beyond a point";
    }
  }
  return {};
}

}  // namespace

ros::Time toRos(Time time) {
  constexpr Duration kLast = std::chrono::seconds(std::numeric_limits<std::uint32_t>::max());
  return ros::Time().fromNSec(static_cast<std::uint64_t>(
      std::clamp(time.time_since_epoch(), Duration::zero(), kLast).count()));
}

ros::Duration toRos(Duration duration) {
  constexpr Duration kLongest = std::chrono::seconds(std::numeric_limits<std::int32_t>::max());
  return ros::Duration().fromNSec(std::clamp(duration, -kLongest, kLongest).count());
}

void fromMessage(const sensor_msgs::LaserScan& message, LaserScan& scan) {
  scan.stamp = toTime(message.header.stamp);
  scan.angle_min = message.angle_min;
  scan.angle_increment = message.angle_increment;
  scan.angle_max = message.angle_max;
  // Not finite or absurd: negative, which defectOf() refuses.
  scan.time_increment =
      std::abs(message.time_increment) <= 1.0F ? fromSeconds(message.time_increment) : Duration(-1);
  scan.range_min = message.range_min;
  scan.range_max = message.range_max;
  scan.ranges = message.ranges;
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
  const Eigen::Vector3f none = Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN());
  for (const Beam& beam : scan.beams) {
    const Eigen::Vector3f end = beam.p_fixed.cast<float>();
    *point++ = {beam.kind == BeamKind::kReturn ? end : none,
                beam.viewpoint.cast<float>(),
                static_cast<float>(beam.tilt),
                static_cast<std::uint8_t>(beam.kind),
                {0, 0, 0},
                end};
  }
}

std::string fromMessage(const sensor_msgs::PointCloud2& message, ScanReturns& returns) {
  std::array<std::size_t, kFields.size()> offsets;
  std::string missing = findFields(message, offsets);
  if (!missing.empty()) return missing;
  const std::size_t count = static_cast<std::size_t>(message.width) * message.height;
  if (count == 0 || message.point_step == 0 || count > message.data.size() / message.point_step ||
      message.is_bigendian) {
    return "it has no points, fewer bytes than it says, or big-endian numbers";
  }
  returns.stamp = toTime(message.header.stamp);
  returns.is_whole = false;
  returns.points.clear();
  returns.looks.clear();
  for (std::size_t i = 0; i < count; ++i) {
    CloudPoint point;
    for (std::size_t k = 0; k < kFields.size(); ++k) {
      std::memcpy(reinterpret_cast<std::uint8_t*>(&point) + 4 * k,
                  &message.data[i * message.point_step + offsets[k]], k == kKind ? 1 : 4);
    }
    const Vector3 p = point.point.cast<double>(), end = point.end.cast<double>();
    returns.viewpoint = point.viewpoint.cast<double>();
    if (i == 0) returns.tilt = point.tilt;
    if (p.allFinite()) returns.points.push_back(p);
    const auto kind =
        point.kind < kBeamKinds ? static_cast<BeamKind>(point.kind) : BeamKind::kUnknown;
    if (end.allFinite() && returns.viewpoint.allFinite()) {
      returns.looks.push_back({returns.viewpoint, end, seenBy(kind)});
    }
  }
  return {};
}

Pose fromMessage(const geometry_msgs::Pose& message, const std::string& owner) {
  constexpr double kUnitTolerance = 1e-3;
  Eigen::Quaterniond q;
  tf2::fromMsg(message.orientation, q);
  if (!(std::abs(q.norm() - 1.0) <= kUnitTolerance)) {
    throw ConfigError(owner + ": its orientation is no unit quaternion");
  }
  Pose pose = Pose::Identity();
  pose.linear() = q.normalized().toRotationMatrix();
  pose.translation() << message.position.x, message.position.y, message.position.z;
  if (!isRigid(pose)) throw ConfigError(owner + ": its position is not finite");
  return pose;
}

PlacedShape fromMessage(const tccm_monitor::Primitive& message, const std::string& owner) {
  PlacedShape primitive{Sphere{message.radius}, fromMessage(message.pose, owner)};
  const double half_length = 0.5 * message.length;
  if (message.shape == "box") {
    primitive.shape = Box{0.5 * Vector3(message.size.x, message.size.y, message.size.z)};
  } else if (message.shape == "cylinder") {
    primitive.shape = Cylinder{message.radius, half_length};
  } else if (message.shape == "capsule") {
    primitive.shape = Capsule{message.radius, half_length};
  } else if (message.shape != "sphere") {
    throw ConfigError(printable(owner + ": shape '" + message.shape, kLineMax) +
                      "' is none of box, cylinder, capsule, sphere");
  }
  return primitive;
}

tccm_monitor::Primitive toMessage(const PlacedShape& primitive) {
  tccm_monitor::Primitive message;
  message.shape = name(primitive.shape);
  message.pose = tf2::toMsg(primitive.pose);
  std::visit(
      [&message](const auto& shape) {
        using T = std::decay_t<decltype(shape)>;
        if constexpr (std::is_same_v<T, Box>) {
          tf2::toMsg(Vector3(2.0 * shape.half_extents), message.size);
        } else {
          message.radius = shape.radius;
          if constexpr (!std::is_same_v<T, Sphere>) message.length = 2.0 * shape.half_length;
        }
      },
      primitive.shape);
  return message;
}

AttachedObject fromMessage(const tccm_monitor::AttachedObject& message) {
  return {message.name, message.link,
          fromMessage(message.primitive, printable("object '" + message.name + "'", kLineMax))};
}

void fromMessage(const tccm_monitor::ScanReport& message, ScanReport& report) {
  using Outcome = ScanReport::Outcome;
  report.stamp = toTime(message.header.stamp);
  report.outcome = Outcome::kDropped;
  if (message.outcome == tccm_monitor::ScanReport::WAITING) report.outcome = Outcome::kWaiting;
  if (message.outcome == tccm_monitor::ScanReport::ASSEMBLED) report.outcome = Outcome::kAssembled;
  report.dropped = message.dropped;
  report.detail = message.detail;
  report.self_link = message.self_link;
}

}  // namespace tccm
