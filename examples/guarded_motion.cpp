#include "guarded_motion.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace tccm::example {
namespace {

using trajectory_msgs::JointTrajectory;

constexpr double kAnnouncedScaleMin = 0.01;  // no trajectory takes longer than messages can say

const char* name(GuardedMotion::State state) {
  switch (state) {
    case GuardedMotion::State::kIdle:
      return "IDLE";
    case GuardedMotion::State::kChecking:
      return "CHECKING";
    case GuardedMotion::State::kMoving:
      return "MOVING";
    case GuardedMotion::State::kHeld:
      return "HELD";
    case GuardedMotion::State::kRefused:
      return "REFUSED";
  }
  return "";
}

}  // namespace

void requireInRange(const std::string& key, double value, double lowest, double highest) {
  if (value >= lowest && value <= highest) return;
  throw std::invalid_argument(key + ": " + std::to_string(value) + " is outside [" +
                              std::to_string(lowest) + ", " + std::to_string(highest) + "]");
}

void GuardedMotion::Config::validate() const {
  requireInRange("lookahead_s", lookahead_s, 0.002, 0.2);
  requireInRange("scale_change_per_s", scale_change_per_s, 0.1, 100.0);
  requireInRange("retime_s", retime_s, 0.001, 1.0);
  requireInRange("dt_max_s", dt_max_s, 0.001, 0.2);
}

GuardedMotion::GuardedMotion(const Config& config) : config_(config) { config_.validate(); }

GuardedMotion::Output GuardedMotion::hear(const tccm_monitor::MotionPermission& permission,
                                          const Instant& now) {
  gate_.hear(permission, now);
  return holdUnlessPermitted(now);
}

GuardedMotion::Output GuardedMotion::step(const Instant& now) {
  Output output = holdUnlessPermitted(now);
  if (state_ != State::kMoving) return output;
  if (now.stamp < last_) return hold("time jumps back");
  advance(now);
  const double ahead = time_ + scale_ * config_.lookahead_s;
  output.command = path_->setpoint(ahead, scale_, config_.lookahead_s);
  if (time_ >= path_->duration()) {
    enter(State::kIdle, "the goal is reached");
    output.trajectory = nothing();
  } else if (trajectoryIsOff(now.stamp)) {
    output.trajectory = announce(now.stamp);
  }
  return output;
}

GuardedMotion::Output GuardedMotion::cancel() {
  if (state_ == State::kChecking) refuse("cancelled");
  return state_ == State::kMoving ? hold("cancelled") : Output();
}

void GuardedMotion::beginCheck() { enter(State::kChecking, ""); }

void GuardedMotion::refuse(const std::string& reason) { enter(State::kRefused, reason); }

GuardedMotion::Output GuardedMotion::start(GoalPath path, const Instant& now) {
  const std::string objection = gate_.objection(now);
  if (!objection.empty()) {
    refuse(objection);
    return {};
  }
  enter(State::kMoving, "");
  path_ = std::move(path);
  time_ = 0.0;
  scale_ = 0.0;
  last_ = now.stamp;
  return {std::nullopt, announce(now.stamp)};
}

std::string GuardedMotion::stateText() const {
  return reason_.empty() ? name(state_) : name(state_) + (": " + reason_);
}

/// The path does not outlive the motion: there is nothing left to resume.
void GuardedMotion::enter(State state, const std::string& reason) {
  state_ = state;
  reason_ = reason;
  if (state != State::kMoving) path_.reset();
}

GuardedMotion::Output GuardedMotion::hold(const std::string& reason) {
  enter(State::kHeld, reason);
  return {JointTrajectory(), nothing()};
}

GuardedMotion::Output GuardedMotion::holdUnlessPermitted(const Instant& now) {
  if (state_ != State::kMoving) return {};
  const std::string objection = gate_.objection(now);
  return objection.empty() ? Output() : hold(objection);
}

void GuardedMotion::advance(const Instant& now) {
  const double dt = std::min((now.stamp - last_).toSec(), config_.dt_max_s);
  last_ = now.stamp;
  const double change_max = config_.scale_change_per_s * dt;
  const double before = scale_;
  scale_ += std::clamp(gate_.speedScale() - scale_, -change_max, change_max);
  time_ += 0.5 * (before + scale_) * dt;
}

bool GuardedMotion::trajectoryIsOff(const ros::Time& now) const {
  const double announced = announced_time_ + announced_scale_ * (now - announced_).toSec();
  return std::abs(announced - time_) > config_.retime_s;
}

JointTrajectory GuardedMotion::announce(const ros::Time& now) {
  announced_ = now;
  announced_time_ = time_;
  announced_scale_ = std::max(gate_.speedScale(), kAnnouncedScaleMin);
  JointTrajectory message = path_->rest(time_, announced_scale_);
  message.header.stamp = now;
  joints_ = message.joint_names;
  return message;
}

/// Other arms may have trajectories of their own: only these joints' are over.
JointTrajectory GuardedMotion::nothing() const {
  JointTrajectory message;
  message.joint_names = joints_;
  return message;
}

}  // namespace tccm::example
