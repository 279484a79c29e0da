#include "nodelets/forward_driver.h"

#include <algorithm>
#include <utility>

#include "base/line_of.h"
#include "ros/conversions.h"
#include "ros/goal_conversions.h"
#include "ros/handles.h"

namespace tccm {
namespace {

using Result = control_msgs::FollowJointTrajectoryResult;

constexpr std::chrono::milliseconds kLookPeriod(100);
constexpr double kHoldLeast_s = 0.05;

std::string ended(const actionlib::TerminalState& state, const std::string& text) {
  return "the arm's controller: " + state.toString() + (text.empty() ? "" : ": " + text);
}

}  // namespace

ForwardDriver::ForwardDriver(const ros::NodeHandle& node, const GateConfig::Controller& controller,
                             std::vector<std::string> joints, double answer_timeout_s)
    : controller_(controller),
      joints_(std::move(joints)),
      answer_timeout_(fromSeconds(answer_timeout_s)),
      node_(node) {
  if (controller.hold == "command") {
    command_ =
        advertise<trajectory_msgs::JointTrajectory>(node, controller.downstream + "/command", 10);
  }
  if (!controller.slider.empty()) {
    slider_ = std::make_unique<SpeedSlider>(node, controller.slider, controller.slider_type);
  }
}

/// Looks seldom: that takes locks and memory.
void ForwardDriver::keepInTouch(const Instant& now) {
  if (now.steady - looked_at_ < kLookPeriod || !ros::Time::isValid()) return;
  looked_at_ = now.steady;
  if (!client_) {
    client_.emplace(node_, controller_.downstream + "/follow_joint_trajectory",
                    node_.getCallbackQueue());
  }
  is_there_ = client_->isServerConnected();
}

std::string ForwardDriver::objection(const Instant& now) {
  keepInTouch(now);
  if (!is_there_) {
    return "there is no action server " + controller_.downstream + "/follow_joint_trajectory";
  }
  return slider_ ? slider_->defect() : std::string();
}

void ForwardDriver::begin(const GatedMotion& motion,
                          const control_msgs::FollowJointTrajectoryGoal& goal, const Instant& now) {
  goal_.path_tolerance = goal.path_tolerance;
  goal_.goal_tolerance = goal.goal_tolerance;
  goal_.goal_time_tolerance = goal.goal_time_tolerance;
  end_.reset();
  owes_hold_ = false;
  waits_for_slider_ = slider_ != nullptr;
  if (slider_) {
    slid_at_ = now.steady;
    slider_->forget();
    return slider_->set(motion.aim());
  }
  send(toMessage(motion.plan()), motion.start(), now);
}

void ForwardDriver::step(const GatedMotion& motion, const GatedMotion::Step& step,
                         const Instant& now) {
  if (!slider_) {
    if (step.is_replanned) send(toMessage(motion.plan()), motion.start(), now);
    return;
  }
  if (step.is_replanned) slider_->set(motion.aim());
  if (!slider_->isSet()) return;
  slid_at_ = now.steady;
  if (!waits_for_slider_) return;
  waits_for_slider_ = false;
  send(toMessage(motion.whole()), motion.start(), now);
}

void ForwardDriver::send(const trajectory_msgs::JointTrajectory& way, Time start,
                         const Instant& now) {
  goal_.trajectory = way;
  // By a slider the controller's time goes otherwise than ROS time: now is when the goal comes.
  const bool is_now = slider_ && start <= now.stamp;
  goal_.trajectory.header.stamp = is_now ? ros::Time() : toRos(std::max(start, now.stamp));
  // The controller goes on from where it has the arm.
  goal_.trajectory.points.erase(goal_.trajectory.points.begin());
  sent_at_ = now.steady;
  is_answered_ = false;
  if (sent_) superseded_.push_back(*sent_);
  const auto is_heard_of = [](const Client::GoalHandle& goal) {
    return goal.getCommState() != actionlib::CommState::WAITING_FOR_GOAL_ACK;
  };
  superseded_.erase(std::remove_if(superseded_.begin(), superseded_.end(), is_heard_of),
                    superseded_.end());
  sent_ = client_->sendGoal(goal_,
                            [this](const Client::GoalHandle& handle) { hearTransition(handle); });
}

void ForwardDriver::hearTransition(const Client::GoalHandle& handle) {
  if (!sent_ || !(*sent_ == handle)) return;  // one that was replaced
  const auto state = handle.getCommState();
  is_answered_ = is_answered_ || state != actionlib::CommState::WAITING_FOR_GOAL_ACK;
  if (state != actionlib::CommState::DONE || end_) return;
  const actionlib::TerminalState terminal = handle.getTerminalState();
  const auto result = handle.getResult();
  const std::string text =
      result && !result->error_string.empty() ? result->error_string : terminal.getText();
  if (terminal == actionlib::TerminalState::SUCCEEDED) {
    end_ = End{true, Result::SUCCESSFUL, {}};
    return;
  }
  end_ = End{false, result ? result->error_code : std::int32_t{Result::INVALID_GOAL},
             ended(terminal, text)};
  if (end_->code == Result::SUCCESSFUL) end_->code = Result::INVALID_GOAL;
}

std::optional<ArmDriver::End> ForwardDriver::end(const Instant& now) {
  if (end_) return end_;
  const auto silent = [&](const std::string& who, std::chrono::nanoseconds since) {
    return End{
        false, Result::PATH_TOLERANCE_VIOLATED,
        lineOf("%.200s does not answer for %.1f s", who.c_str(), toSeconds(now.steady - since))};
  };
  if (slider_ && now.steady - slid_at_ > answer_timeout_) {
    return silent(controller_.slider, slid_at_);
  }
  if (sent_ && !is_answered_ && now.steady - sent_at_ > answer_timeout_) {
    return silent(controller_.downstream, sent_at_);
  }
  return std::nullopt;
}

void ForwardDriver::hold(const std::vector<double>& positions,
                         const std::vector<double>& velocities, const Instant& /*now*/) {
  // A controller that has given up a goal may go on with its trajectory: there is nothing to
  // cancel.
  owes_hold_ = client_ && (controller_.hold == "goal" || !sent_ || end_);
  // Whoever sent them.
  if (client_) client_->cancelAllGoals();
  // Cancellations come by a connection of their own, and overtake goals. A server notes those of a
  // goal that it does not know yet only by the goal's name.
  if (sent_) superseded_.push_back(*sent_);
  for (Client::GoalHandle& goal : superseded_) goal.cancel();
  superseded_.clear();
  sent_.reset();
  end_.reset();
  waits_for_slider_ = false;
  if (slider_) slider_->forget();
  if (controller_.hold == "command") command_.publish(trajectory_msgs::JointTrajectory());
  if (!positions.empty()) stay(positions, velocities);
}

void ForwardDriver::cancelUnheard() {
  const ros::Time now = ros::Time::now();
  if (client_ && !now.isZero()) client_->cancelGoalsAtAndBeforeTime(now - ros::Duration(0, 1));
}

void ForwardDriver::stay(const std::vector<double>& positions,
                         const std::vector<double>& velocities) {
  if (!owes_hold_) return;
  owes_hold_ = false;
  control_msgs::FollowJointTrajectoryGoal goal;
  goal.trajectory.joint_names = joints_;
  goal.trajectory.points.resize(1);
  trajectory_msgs::JointTrajectoryPoint& stand = goal.trajectory.points.front();
  const double duration_s = std::max(controller_.stop_duration_s, kHoldLeast_s);
  stand.time_from_start = ros::Duration(duration_s);
  for (std::size_t j = 0; j < positions.size(); ++j) {
    // As far as it goes when it slows down evenly.
    stand.positions.push_back(positions[j] + 0.5 * duration_s * velocities[j]);
    stand.velocities.push_back(0.0);
  }
  hold_ = client_->sendGoal(goal);
}

}  // namespace tccm
