#include <sensor_msgs/JointState.h>
#include <std_msgs/Bool.h>
#include <std_msgs/String.h>

#include <memory>
#include <optional>
#include <pluginlib/class_list_macros.hpp>
#include <vector>

#include "nodelets/arm_gate.h"
#include "nodelets/controller_rules.h"
#include "nodelets/diagnosed_nodelet.h"
#include "ros/conversions.h"
#include "ros/goal_conversions.h"
#include "ros/server_config.h"
#include "tccm_monitor/config_error.h"

namespace tccm {

/// Nodelet: FollowJointTrajectory goals in; what of them is permitted out, to the arms' own
/// controllers.
class TrajectoryGate : public DiagnosedNodelet {
 public:
  TrajectoryGate() : DiagnosedNodelet("trajectory gate") {}
  ~TrajectoryGate() override { end(); }

 private:
  void setUp() override {
    config_ = configFrom<GateConfig>(privateNode());
    tellDifferences(privateNode(), config_);
    if (config_.controllers.empty()) throw ConfigError("controllers: there is none");
    if (getName() != node().resolveName(MonitorConfig::kGateSection)) {
      throw ConfigError("it has to be named " + node().resolveName(MonitorConfig::kGateSection) +
                        ": there the checker reads how long arms take to halt");
    }
    const auto model = sharedRobotModel(node());
    trajectory_ = advertise<trajectory_msgs::JointTrajectory>(node(), "trajectory", 10);
    if (!config_.execution_event.empty()) {
      execution_event_ = advertise<std_msgs::String>(node(), config_.execution_event, 10);
    }
    questions_ = std::make_unique<TrajectoryQuestions>(node());
    moving_ = advertiseCounting<std_msgs::Bool>(node(), "trajectory_gate/moving", 10, guards_,
                                                node().resolveName(GateConfig::kGuardName));
    for (const GateConfig::Controller& controller : config_.controllers) {
      arms_.push_back(std::make_unique<ArmGate>(
          node(), config_, controller, rulesOf(node(), controller, *model),
          ArmGate::Shared{joints_, permission_, *questions_, trajectory_, execution_event_,
                          guards_}));
    }
    inputs_.push_back(hear("motion_permission", 10, &TrajectoryGate::receivePermission));
    inputs_.push_back(hear("joint_states", 200, &TrajectoryGate::receiveJoints));
    cycle_ = timer(1.0 / config_.rate_hz, [this] { step(); });
  }

  void receivePermission(const tccm_monitor::MotionPermission::ConstPtr& message) {
    fromMessage(*message, heard_);
    permission_.hear(heard_, now());
    step();
  }

  void receiveJoints(const sensor_msgs::JointState::ConstPtr& message) {
    joints_.hear(*message, toTime(message->header.stamp), now().stamp);
  }

  void step() {
    const Instant instant = now();
    if (instant.stamp < last_) joints_.clear();
    last_ = instant.stamp;
    bool moves = false;
    for (const auto& arm : arms_) {
      arm->step(instant);
      moves = moves || arm->isMoving();
    }
    if (moves || moved_) tellMoving(moves);
    moved_ = moves;
  }

  void tellMoving(bool moves) {
    const auto message = moving_messages_.take();
    message->data = static_cast<std::uint8_t>(moves);
    moving_.publish(std_msgs::Bool::ConstPtr(message));
  }

  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) override {
    for (const auto& arm : arms_) {
      if (arm->fault().empty()) continue;
      return status.summary(diagnostic_msgs::DiagnosticStatus::ERROR, arm->fault());
    }
    const std::string objection = permission_.objection(now());
    status.summary(objection.empty() ? diagnostic_msgs::DiagnosticStatus::OK
                                     : diagnostic_msgs::DiagnosticStatus::WARN,
                   objection.empty() ? "the arms may move" : objection);
  }

  GateConfig config_;
  JointPositions joints_;
  PermissionGate permission_;
  HeardPermission heard_;
  Time last_;
  ros::Publisher trajectory_, execution_event_, moving_;
  MessagePool<std_msgs::Bool> moving_messages_;
  int guards_ = 0;  ///< that hear whether arms move
  bool moved_ = false;
  std::unique_ptr<TrajectoryQuestions> questions_;
  std::vector<std::unique_ptr<ArmGate>> arms_;
  std::vector<ros::Subscriber> inputs_;
  ros::WallTimer cycle_;
};

}  // namespace tccm

PLUGINLIB_EXPORT_CLASS(tccm::TrajectoryGate, nodelet::Nodelet)
