/// A process of its own beside a TrajectoryGate that forwards goals: where the gate is gone, or
/// hangs, while an arm moves, the arm's own controller would go on to the end. This one has it
/// halt.

#include <ros/ros.h>
#include <sensor_msgs/JointState.h>
#include <std_msgs/Bool.h>

#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "gate/gate_config.h"
#include "nodelets/controller_rules.h"
#include "nodelets/forward_driver.h"
#include "nodelets/joint_positions.h"
#include "ros/conversions.h"
#include "ros/goal_conversions.h"
#include "ros/handles.h"
#include "ros/server_config.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

constexpr char kUsage[] =
    R"(usage: gate_guard [--help] [NAME:=VALUE ...]

Has the arms halt where the trajectory_gate is silent for 60 ms while one of them moves.

  trajectory_gate/moving  in: std_msgs/Bool, in each of the gate's cycles
  trajectory_gate/controllers  parameter: those of the mode 'forward' are guarded
)";

class GateGuard {
 public:
  explicit GateGuard(const GateConfig& config) : joints_age_max_s_(config.joints_age_max_s) {
    const std::string name = node_.resolveName(GateConfig::kGuardName);
    if (ros::this_node::getName() != name) {
      throw ConfigError("it has to be named " + name +
                        ": by its name the trajectory_gate knows it");
    }
    const auto model = sharedRobotModel(node_);
    for (GateConfig::Controller controller : config.controllers) {
      if (!controller.forwards()) continue;
      controller.slider.clear();  // that is the gate's
      Arm& arm = arms_.emplace_back();
      const std::vector<std::string> names = rulesOf(node_, controller, *model).joints;
      for (const std::string& name : names) arm.joints.push_back(joints_.watch(name));
      arm.driver = std::make_unique<ForwardDriver>(node_, controller, names, 1.0);
    }
    joint_states_ = hear(node_, "joint_states", 200, &GateGuard::receiveJoints, this);
    // By the wall clock, which goes on where simulated time stands still.
    timer_ = node_.createSteadyTimer(ros::WallDuration(0.005),
                                     [this](const ros::SteadyTimerEvent&) { watch(); });
    ROS_INFO("Arms that are guarded: %zu.", arms_.size());
  }

 private:
  struct Arm {
    std::unique_ptr<ForwardDriver> driver;
    std::vector<const JointPositions::Joint*> joints;
  };

  void receiveJoints(const sensor_msgs::JointState::ConstPtr& message) {
    joints_.hear(*message, toTime(message->header.stamp), now().stamp);
  }

  void receive(const std_msgs::Bool::ConstPtr& moving) {
    is_moving_ = moving->data != 0;
    holds_ = false;
    heard_ = ros::SteadyTime::now();
  }

  void watch() {
    constexpr double kSilence_s = 0.06;
    keepInTouch();
    if (holds_) stay();
    const double silent_s = (ros::SteadyTime::now() - heard_).toSec();
    if (!is_moving_ || silent_s <= kSilence_s) return;
    is_moving_ = false;
    ROS_ERROR("The trajectory_gate is silent for %.3f s while an arm moves: all arms are held.",
              silent_s);
    for (const Arm& arm : arms_) hold(arm);
    holds_ = true;
  }

  /// Where arms are may not have been known when they were held.
  void stay() {
    for (const Arm& arm : arms_) {
      if (whereIs(arm)) arm.driver->stay(positions_, velocities_);
    }
  }

  bool whereIs(const Arm& arm) {
    return JointPositions::expect(arm.joints, now().stamp, joints_age_max_s_, positions_,
                                  velocities_);
  }

  /// The gate takes goals as soon as somebody hears whether arms move. That is not before all arms
  /// can be held.
  void keepInTouch() {
    const Instant instant = now();
    bool can_hold = true;
    for (const Arm& arm : arms_) {
      arm.driver->keepInTouch(instant);
      can_hold = can_hold && arm.driver->objection(instant).empty();
    }
    if (can_hold == bool(moving_)) return;
    if (!can_hold) return moving_.shutdown();
    moving_ = hear(node_, "trajectory_gate/moving", 10, &GateGuard::receive, this);
  }

  void hold(const Arm& arm) {
    whereIs(arm);  // or nowhere
    arm.driver->cancelUnheard();
    arm.driver->hold(positions_, velocities_, now());
  }

  ros::NodeHandle node_;
  JointPositions joints_;
  std::vector<Arm> arms_;
  ros::Subscriber joint_states_, moving_;
  ros::SteadyTimer timer_;
  std::vector<double> positions_, velocities_;  ///< of one arm's joints
  double joints_age_max_s_;
  bool is_moving_ = false, holds_ = false;
  ros::SteadyTime heard_ = ros::SteadyTime::now();
};

/// @return the exit status.
int run(int argc, char** argv) {
  std::vector<std::string> arguments;
  ros::removeROSArgs(argc, argv, arguments);
  for (std::size_t i = 1; i < arguments.size(); ++i) {
    const bool help = arguments[i] == "--help" || arguments[i] == "-h";
    std::fputs(kUsage, help ? stdout : stderr);
    return help ? 0 : 2;
  }
  ros::init(argc, argv, "gate_guard");
  const ros::NodeHandle node;  // outlives the try: ROS logs nothing after the last one
  try {
    const GateGuard guard(configFrom<GateConfig>(ros::NodeHandle("trajectory_gate")));
    ros::spin();
  } catch (const std::exception& error) {
    ROS_FATAL("gate_guard refuses to start: %s", error.what());
    return 1;
  }
  return 0;
}

}  // namespace
}  // namespace tccm

int main(int argc, char** argv) { return tccm::run(argc, argv); }
