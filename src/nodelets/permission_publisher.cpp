#include "nodelets/permission_publisher.h"

#include <std_msgs/Bool.h>
#include <std_msgs/Float64.h>
#include <tccm_monitor/MotionPermission.h>

#include "nodelets/status_conversions.h"
#include "ros/transform_history.h"

namespace tccm {
namespace {

std_msgs::Bool flag(bool value) {
  std_msgs::Bool message;
  message.data = value;
  return message;
}

}  // namespace

PermissionPublisher::PermissionPublisher(ros::NodeHandle node, const std::string& fixed_frame,
                                         ros::Duration valid_for)
    : frame_(withoutSlash(fixed_frame)), valid_for_(valid_for) {
  permission_ = node.advertise<tccm_monitor::MotionPermission>("motion_permission", 10);
  stop_ = node.advertise<std_msgs::Bool>("stop", 10);
  collision_ = node.advertise<std_msgs::Bool>("collision", 10);
  occlusion_ = node.advertise<std_msgs::Bool>("occlusion", 10);
  scale_ = node.advertise<std_msgs::Float64>("speed_scale", 10);
}

void PermissionPublisher::publish(const Verdict& verdict, const ros::Time& now) {
  tccm_monitor::MotionPermission permission;
  toMessage(verdict, permission);
  permission.header.frame_id = frame_;
  permission.header.stamp = now;
  permission.sequence = ++sequence_;
  permission.valid_until = now + valid_for_;
  permission_.publish(permission);
  stop_.publish(flag(verdict.stop));
  // What is not known is not clear.
  collision_.publish(flag(!verdict.known || verdict.collision));
  occlusion_.publish(flag(!verdict.known || verdict.occlusion));
  std_msgs::Float64 scale;
  scale.data = permission.speed_scale;
  scale_.publish(scale);
}

}  // namespace tccm
