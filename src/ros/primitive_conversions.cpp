#include <tf2_eigen/tf2_eigen.h>

#include <cmath>

#include "ros/conversions.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

constexpr double kUnitTolerance = 1e-3;

struct Write {
  tccm_monitor::Primitive& message;
  void operator()(const Box& box) const {
    message.size.x = 2.0 * box.half_extents.x();
    message.size.y = 2.0 * box.half_extents.y();
    message.size.z = 2.0 * box.half_extents.z();
  }
  void operator()(const Cylinder& c) const {
    message.radius = c.radius;
    message.length = 2.0 * c.half_length;
  }
  void operator()(const Capsule& c) const { (*this)(Cylinder{c.radius, c.half_length}); }
  void operator()(const Sphere& s) const { message.radius = s.radius; }
};

}  // namespace

Pose fromMessage(const geometry_msgs::Pose& message, const std::string& owner) {
  const Eigen::Quaterniond q(message.orientation.w, message.orientation.x, message.orientation.y,
                             message.orientation.z);
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
    throw ConfigError(owner + ": shape '" + message.shape +
                      "' is none of box, cylinder, capsule, sphere");
  }
  return primitive;
}

tccm_monitor::Primitive toMessage(const PlacedShape& primitive) {
  tccm_monitor::Primitive message;
  message.shape = name(primitive.shape);
  message.pose = tf2::toMsg(primitive.pose);
  std::visit(Write{message}, primitive.shape);
  return message;
}

AttachedObject fromMessage(const tccm_monitor::AttachedObject& message) {
  return {message.name, message.link,
          fromMessage(message.primitive, "object '" + message.name + "'")};
}

}  // namespace tccm
