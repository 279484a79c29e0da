#include "ros/goal_conversions.h"

#include <control_msgs/FollowJointTrajectoryResult.h>

#include "ros/conversions.h"

namespace tccm {
namespace {

using Tolerances = control_msgs::FollowJointTrajectoryGoal::_path_tolerance_type;

std::vector<TrajectoryGoal::Named> fromMessage(const Tolerances& message) {
  std::vector<TrajectoryGoal::Named> tolerances;
  for (const auto& joint : message) {
    tolerances.push_back({joint.name, {joint.position, joint.velocity, joint.acceleration}});
  }
  return tolerances;
}

}  // namespace

TrajectoryGoal toGoal(const trajectory_msgs::JointTrajectory& message) {
  TrajectoryGoal goal;
  goal.trajectory = fromMessage(message);
  if (!message.header.stamp.isZero()) goal.start = toTime(message.header.stamp);
  return goal;
}

TrajectoryGoal toGoal(const control_msgs::FollowJointTrajectoryGoal& message) {
  TrajectoryGoal goal = toGoal(message.trajectory);
  goal.path = fromMessage(message.path_tolerance);
  goal.end = fromMessage(message.goal_tolerance);
  goal.end_time_s = message.goal_time_tolerance.toSec();
  return goal;
}

trajectory_msgs::JointTrajectory toMessage(const JointTrajectory& trajectory) {
  trajectory_msgs::JointTrajectory message;
  message.joint_names = trajectory.names;
  for (const JointTrajectory::Point& point : trajectory.points) {
    message.points.emplace_back();
    message.points.back().positions = point.positions;
    message.points.back().velocities = point.velocities;
    message.points.back().accelerations = point.accelerations;
    message.points.back().time_from_start = ros::Duration(point.time_s);
  }
  return message;
}

void fromMessage(const tccm_monitor::MotionPermission& message, HeardPermission& heard) {
  using Permission = tccm_monitor::MotionPermission;
  heard.stamp = toTime(message.header.stamp);
  heard.valid_until = toTime(message.valid_until);
  heard.sequence = message.sequence;
  heard.permitted = message.permitted != 0 && message.level <= Permission::SLOW;
  heard.speed_scale = message.speed_scale;
  heard.why.clear();
  if (!message.reasons.empty()) heard.why += message.reasons.front();
  if (!message.reasons.empty() && !message.detail.empty()) heard.why += ", ";
  heard.why += message.detail;
}

Instant now() {
  return {toTime(ros::Time::now()), std::chrono::nanoseconds(ros::SteadyTime::now().toNSec())};
}

std::int32_t errorCode(JudgedGoal::Fault fault) {
  using Result = control_msgs::FollowJointTrajectoryResult;
  switch (fault) {
    case JudgedGoal::Fault::kInvalidGoal:
      return Result::INVALID_GOAL;
    case JudgedGoal::Fault::kInvalidJoints:
      return Result::INVALID_JOINTS;
    case JudgedGoal::Fault::kNone:
      break;
  }
  return Result::SUCCESSFUL;
}

}  // namespace tccm
