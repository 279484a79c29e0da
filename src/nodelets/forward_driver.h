#pragma once

#include <actionlib/client/action_client.h>
#include <control_msgs/FollowJointTrajectoryAction.h>
#include <ros/ros.h>
#include <trajectory_msgs/JointTrajectory.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "gate/gate_config.h"
#include "nodelets/arm_driver.h"
#include "nodelets/speed_slider.h"

namespace tccm {

/// By goals for the controller's own action. Where the arm is to go slower, or faster again, a goal
/// with what is left takes the place of the one before; or the arm's speed slider is moved.
class ForwardDriver : public ArmDriver {
 public:
  ForwardDriver(const ros::NodeHandle& node, const GateConfig::Controller& controller,
                std::vector<std::string> joints, double answer_timeout_s);

  void keepInTouch(const Instant& now) override;
  [[nodiscard]] std::string objection(const Instant& now) override;
  void begin(const GatedMotion& motion, const control_msgs::FollowJointTrajectoryGoal& goal,
             const Instant& now) override;
  void step(const GatedMotion& motion, const GatedMotion::Step& step, const Instant& now) override;
  [[nodiscard]] std::optional<End> end(const Instant& now) override;
  void hold(const std::vector<double>& positions, const std::vector<double>& velocities,
            const Instant& now) override;
  void stay(const std::vector<double>& positions, const std::vector<double>& velocities) override;
  /// Besides hold(), goals that somebody else has sent and that the controller has yet to hear of.
  /// Until ROS time is later than now it takes no goal.
  void cancelUnheard();

 private:
  using Client = actionlib::ActionClient<control_msgs::FollowJointTrajectoryAction>;

  /// A goal of what is left, from now or from the start on.
  void send(const trajectory_msgs::JointTrajectory& way, Time start, const Instant& now);
  void hearTransition(const Client::GoalHandle& handle);

  GateConfig::Controller controller_;
  std::vector<std::string> joints_;
  std::chrono::nanoseconds answer_timeout_;
  ros::NodeHandle node_;
  ros::Publisher command_;
  std::optional<Client> client_;  ///< once there is time: to make it waits for that
  std::unique_ptr<SpeedSlider> slider_;
  control_msgs::FollowJointTrajectoryGoal goal_;  ///< of the motion, to be sent with what is left
  bool waits_for_slider_ = false;                 ///< the goal is sent once it is set
  std::chrono::nanoseconds slid_at_{0};  ///< when the slider was last known to be where it is to be
  std::optional<Client::GoalHandle> sent_;      ///< the newest of the motion
  std::vector<Client::GoalHandle> superseded_;  ///< older ones that it may have yet to hear of
  std::optional<Client::GoalHandle> hold_;
  bool owes_hold_ = false;  ///< a goal to stay, once it is known where
  std::chrono::nanoseconds sent_at_{0}, looked_at_{0};
  bool is_answered_ = false, is_there_ = false;
  std::optional<End> end_;
};

}  // namespace tccm
