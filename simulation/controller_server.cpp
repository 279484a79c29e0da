#include "simulation/controller_server.h"

#include "ros/conversions.h"
#include "ros/goal_conversions.h"

namespace tccm::simulation {
namespace {

constexpr Duration kFeedbackPeriod = std::chrono::milliseconds(50);

}  // namespace

ControllerServer::ControllerServer(const ros::NodeHandle& node, TrajectoryController& controller)
    : node_(node),
      controller_(controller),
      command_(node_.subscribe("command", 1, &ControllerServer::hearCommand, this,
                               ros::TransportHints().tcpNoDelay())),
      server_(
          node_, "follow_joint_trajectory",
          [this](const Server::GoalHandle& goal) { hearGoal(goal); },
          [this](const Server::GoalHandle& goal) { hearCancel(goal); }, false) {
  server_.start();
}

void ControllerServer::hearCommand(const trajectory_msgs::JointTrajectory& message) {
  const std::string defect = controller_.command(toGoal(message));
  if (defect.empty()) return preempt();
  ROS_WARN_THROTTLE(1.0, "%s: a command is not taken: %s.", node_.getNamespace().c_str(),
                    defect.c_str());
}

void ControllerServer::hearGoal(const Server::GoalHandle& handle) {
  Server::GoalHandle goal = handle;
  const JudgedGoal judged = controller_.accept(toGoal(*goal.getGoal()));
  if (judged.fault != JudgedGoal::Fault::kNone) {
    Result result;
    result.error_code = errorCode(judged.fault);
    result.error_string = judged.text;
    return goal.setRejected(result, judged.text);
  }
  preempt();
  goal.setAccepted();
  goal_ = goal;
}

void ControllerServer::hearCancel(const Server::GoalHandle& goal) {
  if (!goal_ || !(*goal_ == goal)) return;
  controller_.cancel();
  preempt();
}

void ControllerServer::preempt() {
  if (goal_) goal_->setCanceled();
  goal_.reset();
}

void ControllerServer::report(Time now) {
  if (const auto end = controller_.takeEnd()) reportEnd(*end);
  if (goal_ && now >= feedback_due_) publishFeedback(now);
}

void ControllerServer::reportEnd(const TrajectoryController::GoalEnd& end) {
  using Kind = TrajectoryController::GoalEnd::Kind;
  if (!goal_) return;
  Result result;
  result.error_string = end.text;
  if (end.kind == Kind::kReached) {
    goal_->setSucceeded(result);
  } else {
    result.error_code = end.kind == Kind::kOffPath ? Result::PATH_TOLERANCE_VIOLATED
                                                   : Result::GOAL_TOLERANCE_VIOLATED;
    goal_->setAborted(result, end.text);
  }
  goal_.reset();
}

void ControllerServer::publishFeedback(Time now) {
  feedback_due_ = now + kFeedbackPeriod;
  control_msgs::FollowJointTrajectoryFeedback feedback;
  feedback.header.stamp = toRos(now);
  feedback.joint_names = controller_.joints();
  for (std::size_t j = 0; j < feedback.joint_names.size(); ++j) {
    feedback.desired.positions.push_back(controller_.desired()[j].position);
    feedback.desired.velocities.push_back(controller_.desired()[j].velocity);
    feedback.desired.accelerations.push_back(controller_.desired()[j].acceleration);
    feedback.error.positions.push_back(controller_.positionError(j));
    feedback.error.velocities.push_back(controller_.velocityError(j));
  }
  feedback.actual.positions = controller_.positions();
  feedback.actual.velocities = controller_.velocities();
  goal_->publishFeedback(feedback);
}

}  // namespace tccm::simulation
