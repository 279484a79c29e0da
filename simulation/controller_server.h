#pragma once

#include <actionlib/server/action_server.h>
#include <control_msgs/FollowJointTrajectoryAction.h>
#include <ros/ros.h>
#include <trajectory_msgs/JointTrajectory.h>

#include <optional>

#include "simulation/trajectory_controller.h"

namespace tccm::simulation {

/// The ROS side of an arm's controller, as ros_controllers' JointTrajectoryController has it in its
/// namespace: the topic `command` and the action `follow_joint_trajectory`.
class ControllerServer {
 public:
  /// @param node in the controller's namespace. @param controller outlives this.
  ControllerServer(const ros::NodeHandle& node, TrajectoryController& controller);

  /// After each step of the controller.
  void report(Time now);

 private:
  using Server = actionlib::ActionServer<control_msgs::FollowJointTrajectoryAction>;
  using Result = control_msgs::FollowJointTrajectoryResult;

  void hearCommand(const trajectory_msgs::JointTrajectory& message);
  void hearGoal(const Server::GoalHandle& handle);
  void hearCancel(const Server::GoalHandle& goal);
  void preempt();
  void reportEnd(const TrajectoryController::GoalEnd& end);
  void publishFeedback(Time now);

  ros::NodeHandle node_;
  TrajectoryController& controller_;
  ros::Subscriber command_;
  Server server_;
  std::optional<Server::GoalHandle> goal_;  ///< the active one
  Time feedback_due_;
};

}  // namespace tccm::simulation
