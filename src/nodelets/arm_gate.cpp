#include "nodelets/arm_gate.h"

#include <actionlib_msgs/GoalStatusArray.h>
#include <std_msgs/String.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/line_of.h"
#include "nodelets/forward_driver.h"
#include "nodelets/stream_driver.h"
#include "ros/conversions.h"
#include "ros/goal_conversions.h"
#include "ros/handles.h"

namespace tccm {
namespace {

constexpr double kStands = 0.003;  // [rad or m] within kStandsFor
constexpr Duration kStandsFor = std::chrono::milliseconds(100);
constexpr double kStandsLongest_s = 2.0;  // beyond what halting takes; then a goal is refused
constexpr double kHoldAgain_s = 0.4;      // the same; then the arm is told to halt anew
constexpr int kHoldsMax = 3;
constexpr Duration kFeedbackPeriod = std::chrono::milliseconds(50);

GatedMotion::Config motionConfig(const GateConfig& config,
                                 const GateConfig::Controller& controller) {
  GatedMotion::Config motion = config.motion;
  motion.stop_duration_s = controller.stop_duration_s;
  motion.pace = controller.pace();
  return motion;
}

std::unique_ptr<ArmDriver> makeDriver(const ros::NodeHandle& node, const GateConfig& config,
                                      const GateConfig::Controller& controller,
                                      const std::vector<std::string>& joints) {
  if (controller.forwards()) {
    return std::make_unique<ForwardDriver>(node, controller, joints, config.answer_timeout_s);
  }
  return std::make_unique<StreamDriver>(node, controller.downstream, joints,
                                        config.motion.lookahead_s);
}

}  // namespace

ArmGate::ArmGate(const ros::NodeHandle& node, const GateConfig& config,
                 const GateConfig::Controller& controller, const GoalRules::Config& rules,
                 Shared shared)
    : config_(config),
      name_(controller.name),
      forwards_(controller.forwards()),
      rules_(rules),
      shared_(shared),
      motion_(motionConfig(config, controller)),
      driver_(makeDriver(node, config, controller, rules.joints)),
      server_(
          node, controller.name + "/follow_joint_trajectory",
          [this](const Handle& handle) { hearGoal(handle); },
          [this](const Handle& handle) { hearCancel(handle); }, false) {
  config_.motion.stop_duration_s = controller.stop_duration_s;
  for (const std::string& joint : rules_.joints()) watched_.push_back(shared_.joints.watch(joint));
  positions_.resize(watched_.size());
  velocities_.resize(watched_.size());
  told_velocities_.reserve(watched_.size());
  rest_.assign(watched_.size(), std::nan(""));
  server_.start();
  const auto hears = [this](int change) {
    return [this, change](const ros::SingleSubscriberPublisher& listener) {
      hearListener(listener.getSubscriberName(), change);
    };
  };
  ros::NodeHandle handle(node);
  const std::string status = controller.name + "/follow_joint_trajectory/status";
  status_ =
      required(handle.advertise<actionlib_msgs::GoalStatusArray>(status, 50, hears(1), hears(-1)),
               handle, status);
}

ArmGate::~ArmGate() {
  try {
    if (active_) finish(GatedMotion::End::kNotPermitted, "the gate ends", now());
    if (pending_) reject(Result::INVALID_GOAL, "the gate ends");
  } catch (const std::exception& error) {
    ROS_ERROR("%s: as the gate ends: %s", name_.c_str(), error.what());
  }
}

std::string ArmGate::readJoints(Time now) {
  told_velocities_.clear();
  for (std::size_t j = 0; j < watched_.size(); ++j) {
    const JointPositions::Joint& joint = *watched_[j];
    if (!joint.is_known) {
      return lineOf("nobody publishes the position of %.100s", rules_.joints()[j].c_str());
    }
    const double age_s = toSeconds(now - joint.stamp);
    if (age_s > config_.joints_age_max_s) {
      return lineOf("the position of %.100s is %.3f s old, at most %.3g s are allowed",
                    rules_.joints()[j].c_str(), age_s, config_.joints_age_max_s);
    }
    positions_[j] = joint.position;
    velocities_[j] = joint.velocity;
    if (joint.tells_velocity) told_velocities_.push_back(joint.velocity);
  }
  if (told_velocities_.size() != velocities_.size()) told_velocities_.clear();
  return {};
}

std::string ArmGate::ownerOf(const Handle& handle) {
  std::string id = handle.getGoalID().id;  // NAME-COUNT-TIME
  for (int part = 0; part < 2; ++part) id.erase(std::min(id.size(), id.rfind('-')));
  return id;
}

void ArmGate::hearListener(const std::string& name, int change) {
  if ((listeners_[name] += change) > 0) return;
  listeners_.erase(name);
  const std::string why = "the node " + name + ", which sent the goal, is gone";
  if (pending_ && ownerOf(pending_->handle) == name) reject(Result::INVALID_GOAL, why);
  if (active_ && ownerOf(*active_) == name) abort(Result::INVALID_GOAL, why, now());
}

void ArmGate::hearGoal(Handle handle) {
  const Instant now = tccm::now();
  const auto goal = handle.getGoal();
  if (!goal) return;  // the action server is about to end
  // What is no goal for this controller does not disturb the one under way.
  std::string unknown = readJoints(now.stamp);
  JudgedGoal judged;
  if (unknown.empty()) {
    judged = rules_.judge(toGoal(*goal), now.stamp, positions_, velocities_);
  }
  if (!unknown.empty() || judged.fault != JudgedGoal::Fault::kNone) {
    Result result;
    result.error_code =
        unknown.empty() ? errorCode(judged.fault) : std::int32_t{Result::INVALID_GOAL};
    result.error_string = unknown.empty() ? judged.text : unknown;
    return handle.setRejected(result, result.error_string);
  }
  if (pending_) cancelPending("another goal has come");
  if (active_) {
    hold(now);
    active_->setCanceled(Result(), "another goal has come");
    active_.reset();
  }
  if (judged.way.points.empty()) {  // to be held
    if (!held_) hold(now);
    handle.setAccepted();
    return handle.setSucceeded();
  }
  pending_.emplace(Pending{handle, *goal, std::move(judged), nullptr, nullptr, now.steady});
}

void ArmGate::cancelPending(const std::string& why) {
  if (pending_->told) tellNothing();
  pending_->handle.setCanceled(Result(), why);
  pending_.reset();
}

void ArmGate::hearCancel(const Handle& handle) {
  if (pending_ && pending_->handle == handle) cancelPending({});
  if (!active_ || !(*active_ == handle)) return;
  hold(tccm::now());
  active_->setCanceled();
  active_.reset();
}

void ArmGate::step(const Instant& now) {
  if (active_) return stepActive(now);
  driver_->keepInTouch(now);
  if (!held_ && !pending_) return;
  const std::string unknown = readJoints(now.stamp);
  if (unknown.empty()) {
    watchRest(now);
    driver_->stay(positions_, velocities_);
  } else {
    rests_since_ = now.steady;  // it is not known to
  }
  if (held_) watchHold(now);
  if (!pending_) return;
  if (!unknown.empty()) return reject(Result::INVALID_GOAL, unknown);
  stepPending(now);
}

void ArmGate::watchRest(const Instant& now) {
  for (std::size_t j = 0; j < positions_.size(); ++j) {
    if (std::abs(positions_[j] - rest_[j]) <= kStands) continue;
    rest_ = positions_;
    rests_since_ = now.steady;
    return;
  }
}

bool ArmGate::isAtRest(const Instant& now) const { return now.steady - rests_since_ >= kStandsFor; }

void ArmGate::watchHold(const Instant& now) {
  const double since_s = toSeconds(now.steady - *held_);
  if (since_s < config_.motion.stop_duration_s) return;
  if (isAtRest(now)) {
    held_.reset();
    holds_ = 0;
    fault_.clear();
    return;
  }
  if (since_s < config_.motion.stop_duration_s + kHoldAgain_s || holds_ >= kHoldsMax) return;
  fault_ = lineOf(
      "%.100s: the arm is not known to stand %.1f s after it was told to: look at its "
      "controller and its joint states",
      name_.c_str(), since_s);
  ROS_ERROR("%s", fault_.c_str());
  const int holds = holds_ + 1;
  hold(now);
  holds_ = holds;
}

void ArmGate::stepPending(const Instant& now) {
  const double waited_s = toSeconds(now.steady - pending_->asked);
  if (!pending_->question) {
    if (held_ || !isAtRest(now)) {
      if (waited_s < config_.motion.stop_duration_s + kStandsLongest_s) return;
      return reject(Result::INVALID_GOAL, "the arm does not come to rest");
    }
    // Anew: since it came, the arm has come to rest elsewhere and time has passed.
    pending_->judged = rules_.judge(toGoal(pending_->goal), now.stamp, positions_, velocities_);
    if (pending_->judged.fault != JudgedGoal::Fault::kNone) {
      return reject(errorCode(pending_->judged.fault), pending_->judged.text);
    }
    pending_->asked = now.steady;
    pending_->reported =
        shared_.questions.report(ownerOf(pending_->handle), pending_->handle.getGoalID().id);
    pending_->question = shared_.questions.ask(toMessage(pending_->judged.way));
    return;
  }
  const auto answer = pending_->question->answer();
  if (!answer) {
    if (waited_s < config_.check_timeout_s) return;
    return reject(Result::INVALID_GOAL,
                  lineOf("check_trajectory has not answered for %.1f s", waited_s));
  }
  if (!answer->is_free) return reject(Result::INVALID_GOAL, answer->why);
  std::string objection = beginIfPermitted(now);
  if (!objection.empty()) reject(Result::INVALID_GOAL, objection);
}

std::string ArmGate::objection(const Instant& now) {
  if (forwards_ && shared_.guards == 0) {
    return "no gate_guard listens, or it does not reach all arms: without it nobody would hold the "
           "arm where the gate is gone";
  }
  return driver_->objection(now);
}

std::string ArmGate::beginIfPermitted(const Instant& now) {
  for (std::size_t j = 0; j < positions_.size(); ++j) {
    const double moved = std::abs(positions_[j] - pending_->judged.way.points[0].positions[j]);
    if (moved <= config_.start_tolerance) continue;
    return lineOf("%.100s moved by %.3g while its goal was checked", rules_.joints()[j].c_str(),
                  moved);
  }
  std::string objection = this->objection(now);
  if (!objection.empty()) return objection;
  objection = shared_.permission.objection(now);
  if (objection.empty()) {
    begin(now);
    return {};
  }
  if (!pending_->question->answer()->moves_out) return objection;
  // The monitor permits what leads out of a contact only where it knows what is commanded.
  if (!pending_->told) {
    pending_->told = now.steady;
    tell(pending_->judged.way, pending_->judged.start);
  }
  const bool waits = now.steady - *pending_->told < fromSeconds(config_.moving_out_wait_s);
  return waits ? std::string() : objection;
}

void ArmGate::begin(const Instant& now) {
  pending_->judged.start = std::max(pending_->judged.start, now.stamp);
  motion_.begin(pending_->judged, now, shared_.permission);
  active_ = pending_->handle;
  reported_ = std::move(pending_->reported);
  active_->setAccepted();
  fault_.clear();
  tell(motion_.rest(now), std::max(now.stamp, motion_.start()));
  driver_->begin(motion_, pending_->goal, now);
  pending_.reset();
}

void ArmGate::stepActive(const Instant& now) {
  std::string unknown = readJoints(now.stamp);
  if (unknown.empty()) unknown = objection(now);
  if (!unknown.empty()) return finish(GatedMotion::End::kNotPermitted, unknown, now);
  const GatedMotion::Step& step =
      motion_.step(now, shared_.permission, positions_, told_velocities_);
  if (step.end != GatedMotion::End::kNone) return finish(step.end, step.text, now);
  driver_->step(motion_, step, now);
  if (const auto end = driver_->end(now)) {
    return end->is_reached ? succeed() : abort(end->code, end->text, now);
  }
  if (step.is_retimed) tell(motion_.rest(now), std::max(now.stamp, motion_.start()));
  if (now.stamp >= feedback_due_) publishFeedback(now);
}

void ArmGate::publishFeedback(const Instant& now) {
  feedback_due_ = now.stamp + kFeedbackPeriod;
  feedback_.header.stamp = toRos(now.stamp);
  feedback_.joint_names = rules_.joints();
  feedback_.desired.positions = motion_.desired().positions;
  feedback_.desired.velocities = motion_.desired().velocities;
  for (double& velocity : feedback_.desired.velocities) velocity *= motion_.scale();
  feedback_.desired.time_from_start = ros::Duration(motion_.timeAlong());
  feedback_.actual.positions = positions_;
  feedback_.actual.velocities = velocities_;
  feedback_.error.positions.resize(positions_.size());
  for (std::size_t j = 0; j < positions_.size(); ++j) {
    feedback_.error.positions[j] = motion_.desired().positions[j] - positions_[j];
  }
  active_->publishFeedback(feedback_);
}

void ArmGate::tell(const JointTrajectory& way, Time start) {
  trajectory_msgs::JointTrajectory message = toMessage(way);
  message.header.stamp = toRos(start);
  shared_.trajectory.publish(message);
}

/// Other arms may have trajectories of their own: only these joints' are over.
void ArmGate::tellNothing() { tell({rules_.joints(), {}}, now().stamp); }

void ArmGate::hold(const Instant& now) {
  // Goals end where joint states grow too old: until then the arm went on.
  std::vector<double> positions, velocities;
  JointPositions::expect(watched_, now.stamp, 2.0 * config_.joints_age_max_s, positions,
                         velocities);
  driver_->hold(positions, velocities, now);  // before all that can wait
  motion_.forget();
  held_ = now.steady;
  rests_since_ = now.steady;
  holds_ = 0;
  tellNothing();
  reported_.reset();
}

void ArmGate::reject(std::int32_t code, const std::string& why) {
  Result result;
  result.error_code = code;
  result.error_string = why;
  ROS_WARN("%s: a goal is refused: %s", name_.c_str(), why.c_str());
  if (pending_->told) tellNothing();
  pending_->handle.setRejected(result, why);
  pending_.reset();
}

void ArmGate::finish(GatedMotion::End end, const std::string& why, const Instant& now) {
  using End = GatedMotion::End;
  if (end == End::kReached) return succeed();
  // No code says that a motion is not permitted; clients look at the state, and the text.
  std::int32_t code =
      end == End::kOffGoal ? Result::GOAL_TOLERANCE_VIOLATED : Result::PATH_TOLERANCE_VIOLATED;
  const bool is_forbidden = end == End::kNotPermitted || end == End::kTimeJumped;
  if (is_forbidden) code = Result::INVALID_GOAL;
  abort(code, why, now);
  if (!is_forbidden || !shared_.execution_event) return;
  std_msgs::String event;
  event.data = "stop";
  shared_.execution_event.publish(event);
}

void ArmGate::abort(std::int32_t code, const std::string& why, const Instant& now) {
  Handle handle = *active_;
  active_.reset();
  hold(now);
  ROS_WARN("%s: held: %s", name_.c_str(), why.c_str());
  Result result;
  result.error_code = code;
  result.error_string = why;
  handle.setAborted(result, why);
}

void ArmGate::succeed() {
  Handle handle = *active_;
  active_.reset();
  motion_.forget();
  reported_.reset();
  tellNothing();
  handle.setSucceeded();
}

}  // namespace tccm
