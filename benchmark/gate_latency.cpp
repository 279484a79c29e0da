/// How long it takes from a permission that is not given to the command that has the arm halt,
/// through the TrajectoryGate in a process of its own: this program is the monitor, the arm and the
/// client. With `_relay:=true` it is what stands in the gate's place to compare with: it answers
/// each permission that is not given with that command, and does nothing else. gate_latency.launch
/// starts both.

#include <actionlib/client/simple_action_client.h>
#include <control_msgs/FollowJointTrajectoryAction.h>
#include <ros/ros.h>
#include <sensor_msgs/JointState.h>
#include <tccm_monitor/CheckTrajectory.h>
#include <tccm_monitor/MotionPermission.h>
#include <tccm_monitor/ReportGoal.h>
#include <trajectory_msgs/JointTrajectory.h>

#include <algorithm>
#include <cstdio>
#include <exception>
#include <optional>
#include <string>
#include <vector>

namespace tccm {
namespace {

using tccm_monitor::MotionPermission;
using Client = actionlib::SimpleActionClient<control_msgs::FollowJointTrajectoryAction>;

/// In place of the gate.
class Relay {
 public:
  Relay() {
    command_ =
        node_.advertise<trajectory_msgs::JointTrajectory>("right_arm_controller/command", 10);
    permission_ = node_.subscribe("motion_permission", 10, &Relay::hear, this,
                                  ros::TransportHints().tcpNoDelay());
  }

 private:
  void hear(const MotionPermission& permission) {
    if (permission.permitted == 0) command_.publish(trajectory_msgs::JointTrajectory());
  }

  ros::NodeHandle node_;
  ros::Publisher command_;
  ros::Subscriber permission_;
};

class GateLatency {
 public:
  explicit GateLatency(bool has_gate) : has_gate_(has_gate) {
    node_.getParam("right_arm_controller/joints", joints_);
    permission_ = node_.advertise<MotionPermission>("motion_permission", 1);
    states_ = node_.advertise<sensor_msgs::JointState>("joint_states", 10);
    check_ = node_.advertiseService("check_trajectory", &GateLatency::answer, this);
    report_ = node_.advertiseService("report_goal", &GateLatency::takeReport, this);
    command_ = node_.subscribe("right_arm_controller/command", 10, &GateLatency::hear, this,
                               ros::TransportHints().tcpNoDelay());
  }

  int run(int count) {
    Client client("right_arm/follow_joint_trajectory", true);
    for (int i = 0; has_gate_ && ros::ok() && !client.isServerConnected() && i < 2000; ++i) {
      live(0.01);
    }
    live(0.5);
    while (ros::ok() && times_ms_.size() < static_cast<std::size_t>(count)) {
      is_permitted_ = true;
      live(0.05);
      if (has_gate_) setOff(client);
      live(0.1 + 0.0013 * static_cast<double>(times_ms_.size() % 17));
      halted_.reset();
      is_permitted_ = false;
      publishPermission();
      const ros::WallTime said = said_;
      live(0.1);
      if (halted_) times_ms_.push_back(1e3 * (*halted_ - said).toSec());
      if (has_gate_) client.waitForResult(ros::Duration(1.0));
    }
    return report();
  }

 private:
  bool answer(tccm_monitor::CheckTrajectory::Request& /*request*/,
              tccm_monitor::CheckTrajectory::Response& response) {
    response.result = tccm_monitor::CheckTrajectory::Response::FREE;
    return true;
  }

  bool takeReport(tccm_monitor::ReportGoal::Request& /*request*/,
                  tccm_monitor::ReportGoal::Response& response) {
    response.success = 1;
    return true;
  }

  void setOff(Client& client) {
    client.sendGoal(goal());
    for (int i = 0; i < 100 && client.getState() != actionlib::SimpleClientGoalState::ACTIVE; ++i) {
      live(0.01);
    }
  }

  void hear(const trajectory_msgs::JointTrajectory& command) {
    if (command.points.empty() && !halted_) halted_ = ros::WallTime::now();
  }

  [[nodiscard]] control_msgs::FollowJointTrajectoryGoal goal() const {
    control_msgs::FollowJointTrajectoryGoal goal;
    goal.trajectory.joint_names = joints_;
    goal.trajectory.points.resize(1);
    goal.trajectory.points[0].positions.assign(joints_.size(), 0.05);
    goal.trajectory.points[0].time_from_start = ros::Duration(5.0);
    return goal;
  }

  void publishPermission() {
    MotionPermission permission;
    permission.header.stamp = ros::Time::now();
    permission.valid_until = permission.header.stamp + ros::Duration(0.2);
    permission.sequence = ++sequence_;
    permission.permitted = static_cast<std::uint8_t>(is_permitted_);
    permission.level = is_permitted_ ? MotionPermission::OK : MotionPermission::STOP;
    permission.speed_scale = is_permitted_ ? 1.0F : 0.0F;
    said_ = ros::WallTime::now();
    permission_.publish(permission);
  }

  /// The arm stands at 0, the monitor speaks 50 times a second.
  void live(double seconds) {
    const ros::WallTime end = ros::WallTime::now() + ros::WallDuration(seconds);
    while (ros::ok() && ros::WallTime::now() < end) {
      const ros::WallTime now = ros::WallTime::now();
      if (now >= states_due_) {
        sensor_msgs::JointState state;
        state.header.stamp = ros::Time::now();
        state.name = joints_;
        state.position.assign(joints_.size(), 0.0);
        state.velocity.assign(joints_.size(), 0.0);
        states_.publish(state);
        states_due_ = now + ros::WallDuration(0.01);
      }
      if (now >= permission_due_) {
        publishPermission();
        permission_due_ = now + ros::WallDuration(0.02);
      }
      ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(0.0002));
    }
  }

  int report() {
    if (times_ms_.empty()) {
      std::puts("No goal was ever under way.");
      return 1;
    }
    std::sort(times_ms_.begin(), times_ms_.end());
    const auto at = [this](double share) {
      return times_ms_[static_cast<std::size_t>(share * static_cast<double>(times_ms_.size() - 1))];
    };
    std::printf(
        "%s, from a permission to the command, %zu times: p50 %.3f, p99 %.3f, max %.3f ms\n",
        has_gate_ ? "gate" : "relay", times_ms_.size(), at(0.5), at(0.99), at(1.0));
    return 0;
  }

  bool has_gate_;
  ros::NodeHandle node_;
  std::vector<std::string> joints_;
  ros::Publisher permission_, states_;
  ros::ServiceServer check_, report_;
  ros::Subscriber command_;
  std::uint32_t sequence_ = 0;
  bool is_permitted_ = true;
  ros::WallTime said_, states_due_, permission_due_;
  std::optional<ros::WallTime> halted_;
  std::vector<double> times_ms_;
};

}  // namespace
}  // namespace tccm

int main(int argc, char** argv) {
  try {
    ros::init(argc, argv, "gate_latency");
    int count = 300;
    bool is_relay = false, has_gate = true;
    ros::param::get("~count", count);
    ros::param::get("~relay", is_relay);
    ros::param::get("~has_gate", has_gate);
    if (!is_relay) return tccm::GateLatency(has_gate).run(count);
    const tccm::Relay relay;
    ros::spin();
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "gate_latency: %s\n", error.what());
  } catch (...) {  // ROS's own are not all of that kind
    std::fputs("gate_latency: failed\n", stderr);
  }
  return 1;
}
