#pragma once

#include <actionlib/client/simple_action_client.h>
#include <control_msgs/FollowJointTrajectoryAction.h>
#include <gtest/gtest.h>
#include <ros/ros.h>
#include <sensor_msgs/JointState.h>
#include <std_srvs/Trigger.h>
#include <tccm_monitor/CheckState.h>
#include <tccm_monitor/CheckTrajectory.h>
#include <tccm_monitor/MotionPermission.h>
#include <tccm_monitor/SetKeepOut.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <memory>
#include <mutex>
#include <regex>
#include <string>
#include <thread>
#include <vector>

namespace gated {

using Client = actionlib::SimpleActionClient<control_msgs::FollowJointTrajectoryAction>;
using State = actionlib::SimpleClientGoalState;
using Goal = control_msgs::FollowJointTrajectoryGoal;
using Result = control_msgs::FollowJointTrajectoryResult;
using tccm_monitor::CheckState;
using tccm_monitor::CheckTrajectory;
using tccm_monitor::MotionPermission;
using tccm_monitor::SetKeepOut;

constexpr char kAction[] = "right_arm/follow_joint_trajectory";
constexpr double kPatience_s = 40.0;    // until it happens, on a machine that is busy
constexpr double kApproachSpeed = 0.5;  // [rad/s] at most, of the joints
constexpr double kReached = 0.02;       // [rad], the goals' tolerance of arm_controllers.yaml
constexpr double kAtRest = 1e-6;        // [rad]
constexpr double kStandsFor_s = 0.5;
constexpr double kMovingOutScale = 0.2;  // collision_checker/moving_out_scale

inline bool waitFor(const std::function<bool()>& what, double patience_s = kPatience_s) {
  const ros::SteadyTime deadline = ros::SteadyTime::now() + ros::WallDuration(patience_s);
  while (!what()) {
    if (ros::SteadyTime::now() > deadline) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return true;
}

struct Way {
  struct Point {
    double time_s;
    std::vector<double> positions;
  };
  std::vector<std::string> joints;
  std::vector<Point> points;
};

/// examples/reach.yaml: the right hand stretches forward over the table.
inline Way reach() {
  const YAML::Node file = YAML::LoadFile(TCCM_SOURCE_DIR "/examples/reach.yaml");
  Way way{file["joint_names"].as<std::vector<std::string>>(), {}};
  for (const YAML::Node& point : file["points"]) {
    way.points.push_back(
        {point["time_from_start"].as<double>(), point["positions"].as<std::vector<double>>()});
  }
  return way;
}

struct Outcome {
  State state = State::LOST;
  int code = 0;
  std::string text = {};
};

inline Outcome outcomeOf(Client& client) {
  if (!client.waitForResult(ros::Duration(kPatience_s))) return {};
  const auto result = client.getResult();
  return {client.getState(), result->error_code, result->error_string};
}

inline bool isReached(const Outcome& outcome) {
  return outcome.state == State::SUCCEEDED && outcome.code == Result::SUCCESSFUL;
}

/// @param what a regular expression.
inline bool tells(const Outcome& outcome, const std::string& what) {
  return std::regex_search(outcome.text, std::regex(what));
}

/// The right arm behind the gate, all that its joints do and all that is permitted.
class GateClient : public testing::Test {
 protected:
  struct Sample {
    ros::Time stamp;
    std::vector<double> positions, velocities;  ///< in the way's order
  };

  void SetUp() override {
    ASSERT_TRUE(client_.waitForServer(ros::Duration(kPatience_s)));
    ASSERT_TRUE(waitFor([this] { return !samples().empty(); }));
    ASSERT_TRUE(waitFor([this] { return isPermitted(); })) << lastPermission();
  }

  void TearDown() override {
    client_.cancelAllGoals();
    SetKeepOut removal;
    removal.request.name = kRegion;
    removal.request.remove = 1;
    set_keep_out_.call(removal);
  }

  /// What holds until it is reset is reset, once its cause is over.
  bool isPermitted() {
    const auto permission = lastHeard();
    if (!permission) return false;
    if (names(*permission, "AWAITING_RESET")) {
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
      std_srvs::Trigger request;
      reset_.call(request);
      return false;
    }
    return permission->permitted && ros::Time::now() <= permission->valid_until;
  }

  std::string lastPermission() {
    const auto last = lastHeard();
    return last ? "the last permission: " + last->detail : "no permission was heard";
  }

  MotionPermission::ConstPtr lastHeard() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return permissions_.empty() ? nullptr : permissions_.back();
  }

  /// When the last permission came that names the reason; zero: none did.
  ros::Time lastTime(const std::string& reason) {
    const std::lock_guard<std::mutex> lock(mutex_);
    ros::Time last;
    for (const auto& permission : permissions_) {
      if (names(*permission, reason)) last = permission->header.stamp;
    }
    return last;
  }

  static bool names(const MotionPermission& permission, const std::string& reason) {
    const auto& reasons = permission.reasons;
    return std::find(reasons.begin(), reasons.end(), reason) != reasons.end();
  }

  std::vector<Sample> samples(const ros::Time& since = ros::Time()) {
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto begin = std::find_if(samples_.begin(), samples_.end(),
                                    [&](const Sample& sample) { return sample.stamp >= since; });
    return {begin, samples_.end()};
  }

  std::vector<double> positions() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return samples_.back().positions;
  }

  double distanceTo(const std::vector<double>& there) {
    const std::vector<double> here = positions();
    double most = 0.0;
    for (std::size_t j = 0; j < here.size(); ++j)
      most = std::max(most, std::abs(here[j] - there[j]));
    return most;
  }

  /// How far its joints are from where they were then.
  double wayOf(const std::vector<Sample>& log) {
    double most = 0.0;
    for (const Sample& sample : log) {
      for (std::size_t j = 0; j < sample.positions.size(); ++j) {
        most = std::max(most, std::abs(sample.positions[j] - log.front().positions[j]));
      }
    }
    return most;
  }

  /// It comes to rest, and stays where it is.
  bool comesToStand() {
    const bool rests = waitFor([this] {
      const std::lock_guard<std::mutex> lock(mutex_);
      const auto& v = samples_.back().velocities;
      return std::all_of(v.begin(), v.end(), [](double x) { return std::abs(x) < kAtRest; });
    });
    const ros::Time since = ros::Time::now();
    const ros::Time end = since + ros::Duration(kStandsFor_s);
    return rests && waitFor([&] { return samples().back().stamp > end; }) &&
           wayOf(samples(since)) < kAtRest;
  }

  /// Straight from where the arm is, of its joints; at an even speed where it is not smooth.
  Goal goalTo(const std::vector<double>& there, double time_s, bool is_smooth = true) {
    Goal goal;
    goal.trajectory.joint_names = way_.joints;
    goal.trajectory.points.resize(1);
    goal.trajectory.points[0].positions = there;
    if (is_smooth) goal.trajectory.points[0].velocities.assign(there.size(), 0.0);
    goal.trajectory.points[0].time_from_start = ros::Duration(time_s);
    return goal;
  }

  Goal goalTo(const std::vector<double>& there) {
    return goalTo(there, 0.5 + 1.5 * distanceTo(there) / kApproachSpeed);
  }

  /// To the first of the way's points and on to the last.
  Goal goalAlong(std::size_t first, std::size_t last) {
    Goal goal = goalTo(way_.points[first].positions);
    const ros::Duration approach = goal.trajectory.points[0].time_from_start;
    for (std::size_t i = first + 1; i <= last; ++i) {
      trajectory_msgs::JointTrajectoryPoint point;
      point.positions = way_.points[i].positions;
      point.time_from_start =
          approach + ros::Duration(way_.points[i].time_s - way_.points[first].time_s);
      goal.trajectory.points.push_back(point);
    }
    for (auto& point : goal.trajectory.points) point.velocities.clear();
    return goal;
  }

  /// Sends goals until one ends as wanted: on a machine that is busy the monitor may stop the robot
  /// for that alone. @return how the last one ended.
  Outcome sendUntil(const std::function<Goal()>& goal,
                    const std::function<bool(const Outcome&)>& is_wanted) {
    Outcome outcome;
    waitFor([&] {
      client_.sendGoal(goal());
      outcome = outcomeOf(client_);
      if (is_wanted(outcome)) return true;
      ROS_WARN("Sent again: %s", outcome.text.c_str());
      std::this_thread::sleep_for(std::chrono::milliseconds(200));
      waitFor([this] { return isPermitted(); }, 1.0);
      return false;
    });
    return outcome;
  }

  Outcome arriveAt(const std::vector<double>& there) {
    return sendUntil([&] { return goalTo(there); }, isReached);
  }

  /// A goal is being done, and the arm is that far on its way.
  bool isUnderWay(const std::function<Goal()>& goal, double way) {
    return waitFor([&] {
      const std::vector<double> start = positions();
      client_.sendGoal(goal());
      waitFor([&] { return client_.getState().isDone() || distanceTo(start) > way; });
      if (!client_.getState().isDone()) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(200));
      waitFor([this] { return isPermitted(); }, 1.0);
      return false;
    });
  }

  static constexpr char kRegion[] = "ahead of the hand";

  bool setRegion(double front_m) {
    SetKeepOut region;
    constexpr double kDepth = 0.4;
    region.request.name = kRegion;
    region.request.pose.position.x = front_m + 0.5 * kDepth;
    region.request.pose.position.y = -0.25;
    region.request.pose.position.z = 0.95;
    region.request.pose.orientation.w = 1.0;
    region.request.size.x = kDepth;
    region.request.size.y = 0.6;
    region.request.size.z = 0.6;
    return set_keep_out_.call(region) && region.response.success;
  }

  bool isInRegion() {
    CheckState question;
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      question.request.state = *joints_;
    }
    return check_state_.call(question) &&
           question.response.result == CheckState::Response::KEEP_OUT;
  }

  /// A region to keep out of reaches that far into the padding around the hand as it is now.
  bool putHandIntoRegion(double depth_m) {
    double near = 0.3, far = 1.3;  // [m] ahead of the robot's middle
    while (far - near > 1e-3) {
      const double middle = 0.5 * (near + far);
      if (!setRegion(middle)) return false;
      (isInRegion() ? near : far) = middle;
    }
    return setRegion(near - depth_m);
  }

  void hearJoints(const sensor_msgs::JointState::ConstPtr& message) {
    Sample sample{message->header.stamp, {}, {}};
    for (const std::string& joint : way_.joints) {
      const auto found = std::find(message->name.begin(), message->name.end(), joint);
      if (found == message->name.end()) return;
      const auto i = static_cast<std::size_t>(found - message->name.begin());
      sample.positions.push_back(message->position[i]);
      sample.velocities.push_back(message->velocity[i]);
    }
    const std::lock_guard<std::mutex> lock(mutex_);
    joints_ = message;
    samples_.push_back(sample);
  }

  void hearPermission(const MotionPermission::ConstPtr& message) {
    const std::lock_guard<std::mutex> lock(mutex_);
    permissions_.push_back(message);
  }

  const Way way_ = reach();
  const std::vector<double> back_ = way_.points[4].positions;    ///< hand near the body
  const std::vector<double> ahead_ = way_.points[10].positions;  ///< far over the table
  const std::vector<double> furthest_ = way_.points[12].positions;
  ros::NodeHandle node_;
  Client client_{kAction, true};
  std::mutex mutex_;
  sensor_msgs::JointState::ConstPtr joints_;
  std::vector<Sample> samples_;
  std::vector<MotionPermission::ConstPtr> permissions_;
  ros::ServiceClient reset_ = node_.serviceClient<std_srvs::Trigger>("reset");
  ros::ServiceClient check_state_ = node_.serviceClient<CheckState>("check_state");
  ros::ServiceClient check_trajectory_ = node_.serviceClient<CheckTrajectory>("check_trajectory");
  ros::ServiceClient set_keep_out_ = node_.serviceClient<SetKeepOut>("set_keep_out");
  ros::Subscriber joint_states_ = node_.subscribe("joint_states", 1000, &GateClient::hearJoints,
                                                  this, ros::TransportHints().tcpNoDelay());
  ros::Subscriber motion_permission_ =
      node_.subscribe("motion_permission", 1000, &GateClient::hearPermission, this,
                      ros::TransportHints().tcpNoDelay());
};

}  // namespace gated
