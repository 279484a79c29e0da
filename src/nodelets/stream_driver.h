#pragma once

#include <ros/ros.h>
#include <trajectory_msgs/JointTrajectory.h>

#include <string>
#include <vector>

#include "nodelets/arm_driver.h"
#include "ros/message_pool.h"

namespace tccm {

/// By setpoints on the controller's topic `command`, one a cycle, each to be reached a little
/// later: where they do not come any more the arm stands. Without points: stop and hold.
class StreamDriver : public ArmDriver {
 public:
  StreamDriver(const ros::NodeHandle& node, const std::string& downstream,
               std::vector<std::string> joints, double lookahead_s);

  [[nodiscard]] std::string objection(const Instant& now) override;
  void begin(const GatedMotion&, const control_msgs::FollowJointTrajectoryGoal&,
             const Instant&) override {}
  void step(const GatedMotion& motion, const GatedMotion::Step& step, const Instant& now) override;
  [[nodiscard]] std::optional<End> end(const Instant& /*now*/) override { return std::nullopt; }
  void hold(const std::vector<double>& positions, const std::vector<double>& velocities,
            const Instant& now) override;

 private:
  std::vector<std::string> joints_;
  ros::Duration lookahead_;
  int listeners_ = 0;
  ros::Publisher command_;
  MessagePool<trajectory_msgs::JointTrajectory> setpoints_;
};

}  // namespace tccm
