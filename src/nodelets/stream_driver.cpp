#include "nodelets/stream_driver.h"

#include <utility>

#include "ros/handles.h"

namespace tccm {

StreamDriver::StreamDriver(const ros::NodeHandle& node, const std::string& downstream,
                           std::vector<std::string> joints, double lookahead_s)
    : joints_(std::move(joints)), lookahead_(lookahead_s) {
  command_ = advertiseCounting<trajectory_msgs::JointTrajectory>(node, downstream + "/command", 10,
                                                                 listeners_);
}

std::string StreamDriver::objection(const Instant& /*now*/) {
  if (listeners_ > 0) return {};
  return "no controller listens to " + command_.getTopic();
}

void StreamDriver::step(const GatedMotion& /*motion*/, const GatedMotion::Step& step,
                        const Instant& /*now*/) {
  if (step.setpoint == nullptr) return;
  const auto message = setpoints_.take();
  message->joint_names = joints_;
  message->points.resize(1);
  message->points[0].positions = step.setpoint->positions;
  message->points[0].velocities = step.setpoint->velocities;
  message->points[0].time_from_start = lookahead_;
  command_.publish(trajectory_msgs::JointTrajectory::ConstPtr(message));
}

void StreamDriver::hold(const std::vector<double>& /*positions*/,
                        const std::vector<double>& /*velocities*/, const Instant& /*now*/) {
  command_.publish(trajectory_msgs::JointTrajectory());
}

}  // namespace tccm
