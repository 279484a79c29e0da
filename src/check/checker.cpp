#include "tccm_monitor/check/checker.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

std::string ageText(const std::string& what, Duration age) {
  char text[160];
  std::snprintf(text, sizeof text, "%s %.0f ms old", what.c_str(), 1e3 * toSeconds(age));
  return text;
}

constexpr double kTolerance = 1e-3;  // [rad or m]

/// A mimic or fixed joint whose position, as asked about, is not what its source or the
/// configuration makes it.
std::optional<std::string> jointThatContradicts(const RobotModel& model,
                                                const std::vector<double>& variables,
                                                const std::vector<std::string>& names,
                                                const std::vector<double>& positions) {
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto fixed = model.fixedJoints().find(names[i]);
    if (fixed == model.fixedJoints().end()) continue;
    if (std::abs(positions[i] - fixed->second) > kTolerance) return names[i];
  }
  for (const RobotJoint& joint : model.joints()) {
    if (joint.motion == RobotJoint::Motion::kFixed) continue;
    const auto named = std::find(names.begin(), names.end(), joint.name);
    if (named == names.end()) continue;
    const double follows = joint.multiplier * variables[joint.variable] + joint.offset;
    const double asked = positions[static_cast<std::size_t>(named - names.begin())];
    if (std::abs(asked - follows) > kTolerance) return joint.name;
  }
  return std::nullopt;
}

std::string neverPublished(const std::vector<std::string>& joints) {
  constexpr std::size_t kNamed = 5;
  if (joints.empty()) return "no joint states";
  std::string names;
  for (std::size_t i = 0; i < std::min(kNamed, joints.size()); ++i) {
    names += (i > 0 ? ", '" : "'") + joints[i] + "'";
  }
  if (joints.size() > kNamed) names += " and " + std::to_string(joints.size() - kNamed) + " more";
  return joints.size() == 1 ? "joint " + names + " was never published"
                            : "joints " + names + " were never published";
}

}  // namespace

void Checker::Config::validate() const {
  pose.validate();
  joints.validate();
  requireInRange("horizon_s", horizon_s, 0.0, 10.0);
  requireInRange("joint_timeout_s", joint_timeout_s, 0.001, 10.0);
  requireInRange("transform_timeout_s", transform_timeout_s, 0.001, 10.0);
  requireInRange("scan_timeout_periods", scan_timeout_periods, 1.0, 100.0);
  requireInRange("map_age_max_s", map_age_max_s, 0.001, 10.0);
  requireInRange("future_max_s", future_max_s, 0.0, 10.0);
  requireInRange("transform_future_max_s", transform_future_max_s, 0.0, 10.0);
  requireInRange("release_s", release_s, 0.0, 600.0);
}

Checker::Checker(std::shared_ptr<const RobotModel> model, const Config& config)
    : model_(std::move(model)),
      config_((config.validate(), config)),
      bare_model_(model_),
      joints_(*model_, config.joints),
      kinematics_(model_),
      check_now_(model_, config.pose),
      check_ahead_(model_, config.pose),
      check_state_(model_, config.pose),
      roots_(model_->roots().size()),
      T_fixed_roots_(model_->roots().size(), Pose::Identity()),
      positions_ahead_(model_->variables().size()) {}

JointStates::Added Checker::addJoints(Time stamp, const std::vector<std::string>& names,
                                      const std::vector<double>& positions,
                                      const std::vector<double>& velocities) {
  return joints_.add(stamp, names, positions, velocities);
}

void Checker::reconfigure(const Config& config) {
  config.validate();
  PoseCheck check(model_, config.pose);
  config_ = config;
  check_now_ = check_ahead_ = check_state_ = std::move(check);
}

void Checker::setRootPose(std::size_t root, Time stamp, const Pose& T_fixed_root, bool is_static) {
  if (!isRigid(T_fixed_root)) return;
  roots_[root] = RootPose{stamp, is_static};
  T_fixed_roots_[root] = T_fixed_root;
}

bool Checker::rootsKnown() const {
  return std::all_of(roots_.begin(), roots_.end(), [](const auto& root) { return bool(root); });
}

void Checker::hold(std::vector<AttachedObject> objects) {
  auto model = std::make_shared<const RobotModel>(bare_model_->holding(objects));
  PoseCheck check(model, config_.pose);
  model_ = std::move(model);
  attached_ = std::move(objects);
  check_now_ = check_ahead_ = check_state_ = std::move(check);
  verdict_.now = {};  // its shapes are numbered as before
  verdict_.ahead = {};
  verdict_.placed = false;
}

void Checker::attach(const AttachedObject& object) {
  std::vector<AttachedObject> objects = attached_;
  objects.erase(std::remove_if(objects.begin(), objects.end(),
                               [&](const auto& other) { return other.name == object.name; }),
                objects.end());
  objects.push_back(object);
  hold(std::move(objects));
}

bool Checker::detach(const std::string& object) {
  std::vector<AttachedObject> objects = attached_;
  objects.erase(std::remove_if(objects.begin(), objects.end(),
                               [&](const auto& other) { return other.name == object; }),
                objects.end());
  if (objects.size() == attached_.size()) return false;
  hold(std::move(objects));
  return true;
}

std::optional<Pose> Checker::linkPose(Time now, const std::string& link) {
  if (!started_) started_ = now;
  const JointSnapshot* joints = joints_.latest();
  const auto found = std::find(model_->links().begin(), model_->links().end(), link);
  if (found == model_->links().end() || clock_stalls_ ||
      jointsCause(now, joints).reason != Reason::kClear ||
      rootCause(now).reason != Reason::kClear) {
    return std::nullopt;
  }
  kinematics_.update(joints->positions, T_fixed_roots_);
  return kinematics_.linkPoses()[static_cast<std::size_t>(found - model_->links().begin())];
}

void Checker::setMap(Time now, std::shared_ptr<const CuboidMap> map) {
  if (map_ && map->stamp > map_->stamp) {
    const double period = toSeconds(map->stamp - map_->stamp);
    // One pause must not teach it to be patient.
    scan_period_s_ =
        scan_period_s_ ? 0.9 * *scan_period_s_ +
                             0.1 * std::min(period, config_.scan_timeout_periods * *scan_period_s_)
                       : period;
  }
  map_ = std::move(map);
  map_arrival_ = now;
}

void Checker::reset() {
  joints_.reset();
  map_.reset();
  scan_period_s_.reset();
  started_.reset();
  std::fill(roots_.begin(), roots_.end(), std::nullopt);
  was_known_ = false;
  last_stop_.reset();
}

bool Checker::within(Time now, double seconds) const {
  return now - *started_ <= fromSeconds(seconds);
}

Checker::Cause Checker::jointsCause(Time now, const JointSnapshot* joints) const {
  if (!joints_.contradiction().empty()) {
    return {Reason::kNoJoints, joints_.contradiction(), {}};
  }
  if (!joints) {
    if (within(now, config_.joint_timeout_s))
      return {Reason::kInit, "waiting for joint states", {}};
    return {Reason::kNoJoints, neverPublished(joints_.missingJoints()), {}};
  }
  const Duration lead = joints->newest - now;
  if (lead > fromSeconds(config_.future_max_s)) {
    return {Reason::kFuture, ageText("a joint state is stamped in the future,", -lead), {}};
  }
  const Duration age = now - joints->oldest;
  if (age > fromSeconds(config_.joint_timeout_s)) {
    return {Reason::kNoJoints, ageText("a joint's last position is", age), {}};
  }
  return {};
}

Checker::Cause Checker::rootCause(Time now) const {
  Cause worst;
  for (std::size_t root = 0; root < roots_.size(); ++root) {
    Cause cause = rootCause(now, root);
    if (cause.reason > worst.reason) worst = std::move(cause);
  }
  return worst;
}

Checker::Cause Checker::rootCause(Time now, std::size_t index) const {
  const std::optional<RootPose>& root = roots_[index];
  const std::string& link = model_->links()[model_->roots()[index]];
  if (!root) {
    if (within(now, config_.transform_timeout_s)) {
      return {Reason::kInit, "waiting for the pose of '" + link + "'", {}};
    }
    return {Reason::kNoTransform,
            "no transform from the robot's root '" + link + "' to fixed_frame '" +
                config_.fixed_frame + "'",
            {}};
  }
  const Duration age = now - root->stamp;
  if (!root->is_static && -age > fromSeconds(config_.transform_future_max_s)) {
    return {
        Reason::kFuture, ageText("the pose of '" + link + "' is stamped in the future,", age), {}};
  }
  if (root->is_static || age <= fromSeconds(config_.transform_timeout_s)) return {};
  return {
      Reason::kNoTransform, ageText("the pose of '" + link + "' in the fixed frame is", age), {}};
}

Checker::Cause Checker::mapCause(Time now) const {
  if (!map_) {
    if (within(now, config_.map_age_max_s))
      return {Reason::kInit, "waiting for the first scan", {}};
    return {Reason::kNoMap, "no scan was ever mapped", {}};
  }
  const Duration age = now - map_->stamp;
  if (-age > fromSeconds(config_.future_max_s)) {
    return {Reason::kFuture, ageText("the newest scan is stamped in the future,", age), {}};
  }
  const double silence_s = scan_period_s_ ? std::min(config_.scan_timeout_periods * *scan_period_s_,
                                                     config_.map_age_max_s)
                                          : config_.map_age_max_s;
  if (now - map_arrival_ > fromSeconds(silence_s)) {
    return {Reason::kNoMap, ageText("no scan was mapped lately: the last is", age), {}};
  }
  if (age > fromSeconds(config_.map_age_max_s)) {
    return {Reason::kMapLate, ageText("the newest scan in the map is", age), {}};
  }
  if (map_->overflowed) return {Reason::kMapOverflow, "points were left out of the map", {}};
  if (!map_->complete) return {Reason::kInit, "the map does not hold a whole sweep yet", {}};
  return {};
}

Checker::Cause Checker::inputCause(Time now, const JointSnapshot* joints) const {
  if (clock_stalls_) return {Reason::kNoClock, "simulated time stands still", {}};
  return std::max({jointsCause(now, joints), rootCause(now), mapCause(now)},
                  [](const Cause& a, const Cause& b) { return a.reason < b.reason; });
}

Checker::Cause Checker::findingsCause(const PoseFindings& findings, bool ahead) const {
  const std::string when = ahead ? " ahead" : "";
  if (findings.collision) {
    const std::uint32_t shape = findings.contacts.front().shape;
    const std::string& link = model_->linkOf(shape);
    const std::string& object = model_->shapes()[shape].object;
    const std::string who = object.empty() ? link : "'" + object + "' on " + link;
    return {ahead ? Reason::kCollisionAhead : Reason::kCollision, who + " touches the map" + when,
            link};
  }
  if (findings.occlusion) {
    const auto worst = std::min_element(
        findings.links.begin(), findings.links.end(), [this](const auto& a, const auto& b) {
          const bool a_hidden = check_now_.isOccluded(a), b_hidden = check_now_.isOccluded(b);
          return a_hidden != b_hidden ? a_hidden : a.visible_fraction < b.visible_fraction;
        });
    const std::string& link = model_->links()[worst->link];
    return {ahead ? Reason::kOcclusionAhead : Reason::kOcclusion,
            link + " is hidden from the sensor" + when, link};
  }
  return {};
}

void Checker::lookAhead(const JointSnapshot& joints) {
  for (std::size_t i = 0; i < positions_ahead_.size(); ++i) {
    const JointVariable& variable = model_->variables()[i];
    double& ahead = positions_ahead_[i];
    ahead = joints.positions[i] + config_.horizon_s * joints.velocities[i];
    // A joint measured beyond its limit stays where it is: a clamp must not move it back in.
    if (variable.lower) ahead = std::max(ahead, std::min(*variable.lower, joints.positions[i]));
    if (variable.upper) ahead = std::min(ahead, std::max(*variable.upper, joints.positions[i]));
  }
}

const Verdict& Checker::check(Time now) {
  if (started_ && now < verdict_.stamp) {
    // A clock that is set back by a little goes on from where it was.
    if (verdict_.stamp - now > fromSeconds(config_.future_max_s)) {
      reset();
    } else {
      now = verdict_.stamp;
    }
  }
  if (!started_) started_ = now;
  const JointSnapshot* joints = joints_.latest();
  verdict_.stamp = now;
  verdict_.joints_stamp = joints ? joints->oldest : Time();
  verdict_.serial = map_ ? map_->serial : 0;
  Cause cause = inputCause(now, joints);
  verdict_.known = cause.reason == Reason::kClear;
  verdict_.collision = verdict_.occlusion = false;
  verdict_.placed = map_ && joints && rootsKnown();
  if (verdict_.placed) {
    lookAhead(*joints);
    check_now_.check(*map_, joints->positions, T_fixed_roots_, verdict_.now);
    check_ahead_.check(*map_, positions_ahead_, T_fixed_roots_, verdict_.ahead);
    verdict_.collision = verdict_.now.collision || verdict_.ahead.collision;
    verdict_.occlusion = verdict_.now.occlusion || verdict_.ahead.occlusion;
    const Cause finding =
        std::max(findingsCause(verdict_.now, false), findingsCause(verdict_.ahead, true),
                 [](const Cause& a, const Cause& b) { return a.reason < b.reason; });
    if (finding.reason > cause.reason) cause = finding;
  } else {
    verdict_.now = {};
    verdict_.ahead = {};
  }
  decide(cause);
  return verdict_;
}

bool Checker::needsRelease(Reason reason) const {
  const bool found = reason > Reason::kInit && levelOf(reason) == Level::kStop;
  return found || (was_known_ && levelOf(reason) == Level::kFault);
}

void Checker::decide(const Cause& cause) {
  was_known_ = was_known_ || verdict_.known;
  verdict_.reason = cause.reason;
  verdict_.detail = cause.detail;
  verdict_.link = cause.link;
  if (cause.reason == Reason::kClear && last_stop_) {
    const Duration release = std::max(fromSeconds(config_.release_s), map_->window);
    if (verdict_.stamp - *last_stop_ < release) {
      verdict_.reason = Reason::kReleasing;
      verdict_.detail = "clear, but not for a whole window yet";
    } else {
      last_stop_.reset();
    }
  } else if (last_stop_ ? cause.reason != Reason::kClear : needsRelease(cause.reason)) {
    last_stop_ = verdict_.stamp;  // what is not known to be clear does not count towards release
  }
  verdict_.level = levelOf(verdict_.reason);
  verdict_.stop = verdict_.level != Level::kOk;
}

Checker::StateAnswer Checker::checkState(Time now, const std::vector<std::string>& names,
                                         const std::vector<double>& positions) {
  StateAnswer answer;
  if (!started_) started_ = now;
  const JointSnapshot* joints = joints_.latest();
  const Cause fault = inputCause(now, joints);
  const auto refuse = [&](Reason reason, const std::string& detail) {
    answer.reason = reason;
    answer.detail = detail;
    return answer;
  };
  if (names.empty() || names.size() != positions.size()) {
    return refuse(Reason::kBadQuestion,
                  "as many positions as joint names are needed, and one at least");
  }
  if (fault.reason != Reason::kClear) return refuse(fault.reason, fault.detail);
  std::vector<double> asked = joints->positions;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (!model_->hasJoint(names[i]) || !std::isfinite(positions[i])) {
      return refuse(Reason::kBadQuestion,
                    "joint '" + names[i] + "' is unknown, or its position is not finite");
    }
    for (std::size_t v = 0; v < asked.size(); ++v) {
      if (model_->variables()[v].name == names[i]) asked[v] = positions[i];
    }
  }
  if (const auto contradiction = jointThatContradicts(*model_, asked, names, positions)) {
    return refuse(Reason::kBadQuestion,
                  "joint '" + *contradiction +
                      "' is not where the joint that it mimics, or fixed_joints, puts it");
  }
  check_state_.check(*map_, asked, T_fixed_roots_, answer.findings);
  const Cause found = findingsCause(answer.findings, false);
  answer.reason = found.reason;
  answer.detail = found.detail;
  answer.link = found.link;
  return answer;
}

}  // namespace tccm
