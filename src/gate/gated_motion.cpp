#include "gate/gated_motion.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/line_of.h"

namespace tccm {
namespace {

constexpr double kToldScaleMin = 0.01;  // no trajectory takes longer than messages can say
// Plans take a while to come into effect, and cost: one is made for a little less than is
// permitted, and lasts while what is permitted falls by no more than that.
constexpr double kPlannedShare = 0.9;
constexpr double kRiseWorthAPlan = 1.2;
constexpr Duration kRisesAfter = std::chrono::milliseconds(300);
constexpr double kPlanStep_s = 0.04;    // between points while the scale changes
constexpr double kSearchAhead_s = 0.5;  // how far an arm can come between two cycles, at most
constexpr std::size_t kSearchSteps = 50;

}  // namespace

void GatedMotion::Config::describe(ParameterTable& table) {
  table.add("lookahead_s", &lookahead_s, "s", {0.002, 0.2},
            "setpoints are to be reached so much later");
  table.add("scale_rise_per_s", &scale_rise_per_s, "1/s", {0.1, 100.0},
            "how fast the scale of the speed rises; it falls within `stop_duration_s`");
  table.add("retime_s", &retime_s, "s", {0.001, 1.0},
            "`trajectory` is published anew when what is left is off by this");
  table.add("dt_max_s", &dt_max_s, "s", {0.001, 0.2}, "a cycle that comes later does not catch up");
  table.add("settle_s", &settle_s, "s", {0.0, 10.0},
            "after a goal's end its tolerances have so long to be kept, and what it asks itself");
  table.add("deviation_max", &deviation_max, "rad or m", {0.01, 3.0},
            "a motion ends where a joint is further from where it is to be, whatever the "
            "tolerances");
}

void GatedMotion::begin(const JudgedGoal& goal, const Instant& now, const PermissionGate& gate) {
  path_.emplace(goal.way);
  tolerances_ = goal.tolerances;
  start_ = goal.start;
  last_ = now.stamp;
  time_s_ = scale_ = aim_ = 0.0;
  static_cast<void>(aimAt(now, gate.speedScale()));
  if (config_.pace != Pace::kSetpoints) scale_ = aim_;  // the way itself begins as it may
  arrived_.reset();
  step_ = {};
  path_->at(0.0, desired_);
  path_->at(0.0, setpoint_);
}

const GatedMotion::Step& GatedMotion::finish(End end, std::string text) {
  path_.reset();
  step_ = {end, std::move(text), nullptr, false, false};
  return step_;
}

/// Until then the scale goes on changing as it does.
void GatedMotion::findSetpoint() {
  const double fall_s = fallDuration(), change = aim_ - scale_;
  const double rate = change > 0.0   ? config_.scale_rise_per_s
                      : fall_s > 0.0 ? -1.0 / fall_s
                                     : 0.0;  // it has fallen already
  const double changes_s = rate != 0.0 ? std::min(config_.lookahead_s, change / rate) : 0.0;
  const double scale = scale_ + rate * changes_s;
  const double ahead_s =
      0.5 * (scale_ + scale) * changes_s + scale * (config_.lookahead_s - changes_s);
  path_->at(time_s_ + ahead_s, setpoint_);
  for (double& velocity : setpoint_.velocities) velocity *= scale;
}

std::string GatedMotion::astray(const std::vector<double>& positions) const {
  for (std::size_t j = 0; j < positions.size(); ++j) {
    const double off = std::abs(positions[j] - desired_.positions[j]);
    if (off <= config_.deviation_max) continue;
    return lineOf("%.100s does not follow: it is off by %.4g, deviation_max is %.4g",
                  path_->names()[j].c_str(), off, config_.deviation_max);
  }
  return {};
}

std::string GatedMotion::beyond(const std::vector<JointTolerance>& tolerances,
                                const std::vector<double>& positions,
                                const std::vector<double>& velocities) const {
  for (std::size_t j = 0; j < tolerances.size(); ++j) {
    const double off = std::abs(positions[j] - desired_.positions[j]);
    if (tolerances[j].position > 0.0 && !(off <= tolerances[j].position)) {
      return lineOf("%.100s is off by %.4g, its tolerance is %.4g", path_->names()[j].c_str(), off,
                    tolerances[j].position);
    }
    if (velocities.empty() || !(tolerances[j].velocity > 0.0)) continue;
    const double fast = std::abs(velocities[j] - scale_ * desired_.velocities[j]);
    if (!(fast <= tolerances[j].velocity)) {
      return lineOf("%.100s's velocity is off by %.4g, its tolerance is %.4g",
                    path_->names()[j].c_str(), fast, tolerances[j].velocity);
    }
  }
  return {};
}

/// From 1 to 0. What is left of a plan has to begin with a point that is near, at its new speed:
/// the spline to one that is far away would go on at the old one for a while.
double GatedMotion::fallDuration() const {
  return config_.pace == Pace::kPlans ? std::max(config_.stop_duration_s, kPlanStep_s)
                                      : config_.stop_duration_s;
}

bool GatedMotion::aimAt(const Instant& now, double permitted_scale) {
  const double before = aim_;
  if (config_.pace != Pace::kPlans) {
    aim_ = permitted_scale;
  } else if (const double planned = permitted_scale < 1.0 ? kPlannedShare * permitted_scale : 1.0;
             permitted_scale < aim_ || aim_ == 0.0 ||
             (now.stamp - aimed_ > kRisesAfter && planned > kRiseWorthAPlan * aim_)) {
    aim_ = planned;
    aimed_ = now.stamp;
  }
  return aim_ != before;
}

double GatedMotion::findTimeAlong(const std::vector<double>& positions) {
  double nearest = std::numeric_limits<double>::infinity(), found_s = time_s_;
  for (std::size_t i = 0; i <= kSearchSteps; ++i) {
    const double at_s = time_s_ + kSearchAhead_s * static_cast<double>(i) / kSearchSteps;
    path_->at(at_s, searched_);
    double off = 0.0;
    for (std::size_t j = 0; j < positions.size(); ++j) {
      off = std::max(off, std::abs(positions[j] - searched_.positions[j]));
    }
    if (!(off < nearest)) continue;
    nearest = off;
    found_s = at_s;
  }
  return found_s;
}

void GatedMotion::advance(const Instant& now, const std::vector<double>& positions) {
  const double since = toSeconds(now.stamp - last_);
  // A plan goes on also where a cycle is late.
  const double dt = config_.pace == Pace::kPlans ? since : std::min(since, config_.dt_max_s);
  const double before = scale_;
  const double fall_s = fallDuration();
  const double fall = fall_s > 0.0 ? dt / fall_s : before;  // or at once
  scale_ = std::clamp(aim_, before - fall, before + config_.scale_rise_per_s * dt);
  const double time_s = config_.pace == Pace::kMeasured ? findTimeAlong(positions)
                                                        : time_s_ + 0.5 * (before + scale_) * dt;
  time_s_ = std::min(time_s, path_->duration());
}

/// Beyond the end of the way.
const GatedMotion::Step& GatedMotion::settle(const Instant& now,
                                             const std::vector<double>& positions,
                                             const std::vector<double>& velocities) {
  if (!arrived_) arrived_ = now.stamp;
  std::string off = beyond(tolerances_.end, positions, velocities);
  const bool is_judge = config_.pace == Pace::kSetpoints;
  if (off.empty() && is_judge) return finish(End::kReached, {});
  const double since = toSeconds(now.stamp - *arrived_);
  if (since <= config_.settle_s + tolerances_.end_time_s) return step_;
  if (off.empty())
    off = "the arm is there, and its controller does not say that the goal is reached";
  return finish(End::kOffGoal, std::move(off));
}

const GatedMotion::Step& GatedMotion::step(const Instant& now, const PermissionGate& gate,
                                           const std::vector<double>& positions,
                                           const std::vector<double>& velocities) {
  std::string objection = gate.objection(now);
  if (!objection.empty()) return finish(End::kNotPermitted, std::move(objection));
  if (now.stamp < last_) return finish(End::kTimeJumped, "time jumps back");
  step_.setpoint = nullptr;
  step_.is_retimed = false;
  const bool waits = now.stamp < start_;
  // A plan goes on until the next one.
  const bool follows_plan = config_.pace == Pace::kPlans && !waits;
  if (!follows_plan) step_.is_replanned = aimAt(now, gate.speedScale());
  if (waits) {
    if (config_.pace != Pace::kSetpoints) scale_ = aim_;
    last_ = now.stamp;
    return step_;
  }
  last_ = std::max(last_, start_);
  advance(now, positions);
  if (follows_plan) step_.is_replanned = aimAt(now, gate.speedScale());
  last_ = now.stamp;
  path_->at(time_s_, desired_);
  findSetpoint();
  step_.setpoint = &setpoint_;
  std::string off = astray(positions);
  if (!off.empty()) return finish(End::kOffPath, std::move(off));
  if (time_s_ >= path_->duration()) {
    if (follows_plan) step_.is_replanned = false;  // nothing is left to be planned
    return settle(now, positions, velocities);
  }
  if (config_.pace == Pace::kSetpoints) off = beyond(tolerances_.path, positions, velocities);
  if (!off.empty()) return finish(End::kOffPath, std::move(off));
  const double told_s = told_time_s_ + told_scale_ * toSeconds(now.stamp - told_);
  step_.is_retimed = std::abs(told_s - time_s_) > config_.retime_s;
  return step_;
}

JointTrajectory GatedMotion::rest(const Instant& now) {
  told_ = std::max(now.stamp, start_);
  told_time_s_ = time_s_;
  told_scale_ = std::max(aim_, kToldScaleMin);
  return path_->rest(time_s_, told_scale_);
}

JointTrajectory GatedMotion::plan() const {
  const double change = aim_ - scale_;
  const double change_s =
      change > 0.0 ? change / config_.scale_rise_per_s : -change * fallDuration();
  if (change_s <= 0.0 || time_s_ >= path_->duration()) return path_->rest(time_s_, aim_);
  // Until then the scale goes from what it is to what it is to be.
  JointTrajectory plan;
  plan.names = path_->names();
  GoalPath::Sample sample;
  const auto along = [&](double since_s) {
    return time_s_ + since_s * (scale_ + 0.5 * change * since_s / change_s);
  };
  for (double since_s = 0.0; since_s < change_s && along(since_s) < path_->duration();
       since_s += kPlanStep_s) {
    const double scale = scale_ + change * since_s / change_s;
    path_->at(along(since_s), sample);
    for (double& velocity : sample.velocities) velocity *= scale;
    plan.points.push_back({since_s, sample.positions, sample.velocities, {}});
  }
  const double changed_s = along(change_s);
  if (changed_s >= path_->duration()) {  // it is over before
    // time_s_ + s t + c t^2 / (2 T) = duration, the first t
    const double way_s = path_->duration() - time_s_, half = 0.5 * change / change_s;
    const double root = std::sqrt(std::max(0.0, scale_ * scale_ + 4.0 * half * way_s));
    path_->at(path_->duration(), sample);
    plan.points.push_back(
        {std::max(plan.points.back().time_s + 1e-3, 2.0 * way_s / (scale_ + root)),
         sample.positions,
         sample.velocities,
         {}});
    return plan;
  }
  JointTrajectory rest = path_->rest(changed_s, aim_);
  if (!plan.points.empty() && change_s - plan.points.back().time_s < 1e-3) plan.points.pop_back();
  for (JointTrajectory::Point& point : rest.points) {
    point.time_s += change_s;
    plan.points.push_back(std::move(point));
  }
  return plan;
}

}  // namespace tccm
