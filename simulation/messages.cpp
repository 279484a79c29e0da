#include "simulation/messages.h"

#include <utility>

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

ros::Time toRos(Time stamp) {
  return ros::Time().fromNSec(static_cast<std::uint64_t>(stamp.time_since_epoch().count()));
}

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
    geometry_msgs::TransformStamped transform;
    transform.header.stamp = toRos(sample.stamp);
    transform.header.frame_id = model.links()[joint.parent];
    transform.child_frame_id = model.links()[joint.child];
    transform.transform.translation.x = T_parent_child.translation().x();
    transform.transform.translation.y = T_parent_child.translation().y();
    transform.transform.translation.z = T_parent_child.translation().z();
    transform.transform.rotation = toMessage(Eigen::Quaterniond(T_parent_child.linear()));
    message.transforms.push_back(transform);
  }
  return message;
}

visualization_msgs::MarkerArray sceneMarkers(const World& world, Time stamp) {
  visualization_msgs::MarkerArray message;
  for (const SceneObject& object : world) {
    const std::optional<Pose> pose = object.poseAt(stamp);
    if (!pose || object.name == "floor") continue;
    Marker marker;
    marker.header.stamp = toRos(stamp);
    marker.header.frame_id = "base_link";
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
