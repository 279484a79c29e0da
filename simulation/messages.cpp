#include "simulation/messages.h"

#include <cmath>
#include <cstring>
#include <utility>

#include "ros/conversions.h"

namespace tccm::simulation {
namespace {

using visualization_msgs::Marker;

geometry_msgs::Quaternion toMessage(const Eigen::Quaterniond& q) {
  geometry_msgs::Quaternion message;
  message.x = q.x();
  message.y = q.y();
  message.z = q.z();
  message.w = q.w();
  return message;
}

geometry_msgs::TransformStamped transformMessage(const std::string& parent,
                                                 const std::string& child, const Pose& pose,
                                                 Time stamp) {
  geometry_msgs::TransformStamped transform;
  transform.header.stamp = toRos(stamp);
  transform.header.frame_id = parent;
  transform.child_frame_id = child;
  transform.transform.translation.x = pose.translation().x();
  transform.transform.translation.y = pose.translation().y();
  transform.transform.translation.z = pose.translation().z();
  transform.transform.rotation = toMessage(Eigen::Quaterniond(pose.linear()));
  return transform;
}

void addField(sensor_msgs::PointCloud2& message, const std::string& name, std::uint32_t offset,
              std::uint8_t type) {
  sensor_msgs::PointField field;
  field.name = name;
  field.offset = offset;
  field.datatype = type;
  field.count = 1;
  message.fields.push_back(field);
}

/// With the fields x, y and z, which are filled, and room for others.
sensor_msgs::PointCloud2 pointsMessage(const Cloud& cloud, const std::string& frame,
                                       std::uint32_t point_step) {
  sensor_msgs::PointCloud2 message;
  message.header.stamp = toRos(cloud.stamp);
  message.header.frame_id = frame;
  message.width = static_cast<std::uint32_t>(cloud.width);
  message.height = static_cast<std::uint32_t>(cloud.height);
  message.point_step = point_step;
  message.row_step = message.width * point_step;
  for (std::uint32_t i = 0; i < 3; ++i) {
    addField(message, std::string(1, "xyz"[i]), 4 * i, sensor_msgs::PointField::FLOAT32);
  }
  message.data.resize(static_cast<std::size_t>(message.height) * message.row_step);
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    std::memcpy(&message.data[i * point_step], cloud.points[i].data(), 12);
  }
  return message;
}

/// Draws one shape as markers; a capsule takes three.
struct Draw {
  Marker marker;
  Pose T_fixed_shape;
  std::vector<Marker>& markers;

  void add(int type, const Vector3& scale, double z = 0.0) const {
    Marker next = marker;
    const Vector3 position = T_fixed_shape * Vector3(0.0, 0.0, z);
    next.id = static_cast<int>(markers.size());
    next.type = type;
    next.pose.position.x = position.x();
    next.pose.position.y = position.y();
    next.pose.position.z = position.z();
    next.pose.orientation = toMessage(Eigen::Quaterniond(T_fixed_shape.linear()));
    next.scale.x = scale.x();
    next.scale.y = scale.y();
    next.scale.z = scale.z();
    markers.push_back(next);
  }
  void operator()(const Box& box) const { add(Marker::CUBE, 2.0 * box.half_extents); }
  void operator()(const Cylinder& c) const {
    add(Marker::CYLINDER, 2.0 * Vector3(c.radius, c.radius, c.half_length));
  }
  void operator()(const Capsule& c) const {
    (*this)(Cylinder{c.radius, c.half_length});
    for (const double z : {-c.half_length, c.half_length}) {
      add(Marker::SPHERE, Vector3::Constant(2.0 * c.radius), z);
    }
  }
  void operator()(const Sphere& s) const { add(Marker::SPHERE, Vector3::Constant(2.0 * s.radius)); }
};

}  // namespace

ArmCommand toCommand(const trajectory_msgs::JointTrajectory& message, Time now) {
  const ros::Time& stamp = message.header.stamp;
  ArmCommand command;
  command.start = stamp.isZero() ? now : Time(Duration(static_cast<Duration::rep>(stamp.toNSec())));
  command.joints = message.joint_names;
  for (const auto& point : message.points) {
    command.points.push_back(
        {Duration(point.time_from_start.toNSec()), point.positions, point.velocities});
  }
  return command;
}

sensor_msgs::LaserScan toMessage(const LaserScan& scan, double scan_period_s) {
  sensor_msgs::LaserScan message;
  message.header.stamp = toRos(scan.stamp);
  message.header.frame_id = "laser_link";
  message.angle_min = static_cast<float>(scan.angle_min);
  message.angle_max = static_cast<float>(
      scan.angle_min + static_cast<double>(scan.ranges.size() - 1) * scan.angle_increment);
  message.angle_increment = static_cast<float>(scan.angle_increment);
  message.time_increment = static_cast<float>(toSeconds(scan.time_increment));
  message.scan_time = static_cast<float>(scan_period_s);
  message.range_min = static_cast<float>(scan.range_min);
  message.range_max = static_cast<float>(scan.range_max);
  message.ranges = scan.ranges;
  return message;
}

sensor_msgs::PointCloud2 cameraMessage(const Cloud& cloud) {
  sensor_msgs::PointCloud2 message = pointsMessage(cloud, kCameraFrame, 20);
  addField(message, "rgb", 16, sensor_msgs::PointField::FLOAT32);
  return message;
}

sensor_msgs::PointCloud2 lidarMessage(const Cloud& cloud) {
  using sensor_msgs::PointField;
  constexpr std::uint32_t kStep = 48, kTime = 20;
  sensor_msgs::PointCloud2 message = pointsMessage(cloud, kLidarFrame, kStep);
  addField(message, "intensity", 16, PointField::FLOAT32);
  addField(message, "t", kTime, PointField::UINT32);
  addField(message, "reflectivity", 24, PointField::UINT16);
  addField(message, "ring", 26, PointField::UINT16);
  addField(message, "ambient", 28, PointField::UINT16);
  addField(message, "range", 32, PointField::UINT32);
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    if (!isMeasured(cloud.points[i])) std::memset(&message.data[i * kStep], 0, 12);
    const auto t =
        static_cast<std::uint32_t>(std::lround(1e9 * static_cast<double>(cloud.offsets_s[i])));
    std::memcpy(&message.data[i * kStep + kTime], &t, sizeof t);
    const auto ring = static_cast<std::uint16_t>(i / cloud.width);
    std::memcpy(&message.data[i * kStep + 26], &ring, sizeof ring);
  }
  return message;
}

tf2_msgs::TFMessage mountMessage(const Mount& mount, const std::string& frame, Time stamp) {
  tf2_msgs::TFMessage message;
  message.transforms.push_back(transformMessage(mount.link, frame, mount.T_link_sensor, stamp));
  return message;
}

tf2_msgs::TFMessage mountMessage(const Simulator::Config& config) {
  tf2_msgs::TFMessage message;
  const auto add = [&](const Mount& mount, const char* frame) {
    message.transforms.push_back(mountMessage(mount, frame, config.start).transforms.front());
  };
  if (config.has(SensorKind::kCamera)) add(config.clouds.camera_mount, kCameraFrame);
  if (config.has(SensorKind::kLidar)) add(config.clouds.lidar_mount, kLidarFrame);
  return message;
}

sensor_msgs::JointState jointMessage(const RobotModel& model, const RobotSample& sample) {
  sensor_msgs::JointState message;
  message.header.stamp = toRos(sample.stamp);
  for (const JointVariable& variable : model.variables()) message.name.push_back(variable.name);
  message.position = sample.positions;
  message.velocity = sample.velocities;
  return message;
}

tf2_msgs::TFMessage transformMessage(const RobotModel& model, const RobotSample& sample) {
  tf2_msgs::TFMessage message;
  for (const RobotJoint& joint : model.joints()) {
    const Pose T_parent_child =
        sample.link_poses[joint.parent].inverse() * sample.link_poses[joint.child];
    message.transforms.push_back(transformMessage(
        model.links()[joint.parent], model.links()[joint.child], T_parent_child, sample.stamp));
  }
  return message;
}

visualization_msgs::MarkerArray sceneMarkers(const World& world, const std::string& frame,
                                             Time stamp) {
  visualization_msgs::MarkerArray message;
  message.markers.emplace_back();
  message.markers.back().action = Marker::DELETEALL;
  for (const SceneObject& object : world) {
    const std::optional<Pose> pose = object.poseAt(stamp);
    if (!pose || object.name == "floor") continue;
    Marker marker;
    marker.header.stamp = toRos(stamp);
    marker.header.frame_id = frame;
    marker.ns = "scene";
    marker.color.r = object.colour.x();
    marker.color.g = object.colour.y();
    marker.color.b = object.colour.z();
    marker.color.a = 0.35F;
    std::visit(Draw{marker, *pose, message.markers}, object.shape);
  }
  return message;
}

}  // namespace tccm::simulation
