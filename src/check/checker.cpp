#include "check/checker.h"

#include <algorithm>
#include <cstdio>

#include "base/stopwatch.h"
#include "check/self_test.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

constexpr double kMoreVisible = 0.02;  // of a silhouette: the link comes out of its hiding place

std::string afterText(const std::string& what, double time_s) {
  char text[200];
  std::snprintf(text, sizeof text, "%.150s in %.0f ms", what.c_str(), 1e3 * time_s);
  return text;
}

}  // namespace

void Checker::Config::validate() const {
  pose.validate();
  inputs.validate();
  way.validate();
  evidence.validate();
  governed_speed.validate();
  trajectories.validate();
  permission.validate();
  exemptions.validate();
  trajectoryCheck().validate();
  requireInRange("occlusion_slow_scale", occlusion_slow_scale, 0.0, 1.0);
}

PoseCheck::Config Checker::Config::poseCheck() const {
  PoseCheck::Config config = pose;
  config.occlusion.old_periods = evidence.slow_periods;
  return config;
}

TrajectoryCheck::Config Checker::Config::trajectoryCheck() const {
  return {poseCheck(), clearance_radius_m, trajectory_step_m, trajectory_occlusion_poses};
}

Checker::Checks::Checks(const std::shared_ptr<const RobotModel>& model, const Config& config)
    : now(model, config.poseCheck()),
      ahead(now),
      state(now),
      way(model, config.pose, config.way),
      evidence(*model, config.evidence, now.collisionShapes(), config.pose.occlusion_use),
      governed_speed(model, config.governed_speed, evidence.shapes()),
      clearance(model, config.pose.collision_use, config.pose.collision, config.clearance_radius_m),
      trajectory(model, config.trajectoryCheck()),
      kinematics(model) {
  const std::vector<std::string> missed = selfTest(model, state, config.pose);
  if (missed.empty()) return;
  std::string names;
  for (const std::string& link : missed) names += " '" + link + "'";
  throw ConfigError("self-test: a virtual cuboid is not found in" + names);
}

Checker::Checker(std::shared_ptr<const RobotModel> model, const Config& config)
    : model_(std::move(model)),
      config_((config.validate(), config)),
      bare_model_(model_),
      inputs_(model_, config.inputs),
      commanded_(*model_, config.trajectories),
      exemptions_(config.exemptions),
      permission_(config.permission),
      checks_(model_, config) {}

void Checker::reconfigure(const Config& config) {
  config.validate();
  Checks checks(model_, config);
  checks.governed_speed.takeOver(checks_.governed_speed);
  permission_.reconfigure(config.permission);
  inputs_.reconfigure(config.inputs);
  config_ = config;
  checks_ = std::move(checks);
  exempt();
}

void Checker::hold(std::vector<AttachedObject> objects) {
  auto model = std::make_shared<const RobotModel>(bare_model_->holding(objects));
  Checks checks(model, config_);
  checks.governed_speed.takeOver(checks_.governed_speed);
  model_ = std::move(model);
  attached_ = std::move(objects);
  checks_ = std::move(checks);
  exempt();
  forgetFindings();
}

/// Their shapes and cuboids are numbered as before.
void Checker::forgetFindings() {
  verdict_.now = {};
  verdict_.ahead = {};
  verdict_.first_contact.reset();
  verdict_.clearances.clear();
  verdict_.unseen_fraction = 0.0;
  verdict_.placed = verdict_.collision = verdict_.occlusion = false;
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

void Checker::exempt() {
  const ExemptRegions regions = exemptions_.regionsOf(*model_, checks_.now.collisionShapes());
  checks_.now.exempt(regions);
  checks_.ahead.exempt(regions);
  checks_.state.exempt(regions);
  checks_.way.exempt(regions);
  checks_.trajectory.exempt(regions);
}

void Checker::addExemption(Time now, const Exemption& exemption, double duration_s) {
  exemptions_.add(now, exemption, duration_s, *model_);
  exempt();
}

std::string Checker::command(Time now, const JointTrajectory& trajectory) {
  const JointSnapshot* joints = inputs_.placesRobot(now) ? inputs_.joints() : nullptr;
  if (!joints) return commanded_.command(now, trajectory, *model_, {});
  return commanded_.command(now, trajectory, *model_, joints->positions, joints->velocities);
}

void Checker::startAnew() {
  inputs_.reset();
  commanded_.clear();
  exemptions_.clear();
  exempt();
  permission_.startAnew();
  checks_.governed_speed.startAnew();
  verdict_.speed_scale = 0.0;
  started_ = false;
}

const Verdict& Checker::check(Time now) {
  if (started_ && now < verdict_.stamp) {
    // A clock that is set back by a little goes on from where it was.
    if (verdict_.stamp - now > fromSeconds(config_.inputs.future_max_s)) {
      startAnew();
    } else {
      now = verdict_.stamp;
    }
  }
  started_ = true;
  if (exemptions_.expire(now)) exempt();
  const JointSnapshot* joints = inputs_.joints();
  const CuboidMap* map = inputs_.map();
  verdict_.stamp = now;
  verdict_.joints_stamp = joints ? joints->oldest : Time();
  verdict_.serial = map ? map->serial : 0;
  findings_.causes.clear();
  findings_.touching = {};
  findings_.speed_scale = 1.0;
  findings_.window = map ? map->window : Duration::zero();
  inputs_.appendCauses(now, findings_.causes);
  if (outside_.reason != Reason::kClear) findings_.causes.push_back(outside_);
  verdict_.known = findings_.known = findings_.causes.empty();
  if (std::string defect = commanded_.defect(); !defect.empty()) {
    add({Reason::kBadTrajectory, "a commanded trajectory: " + defect}, 0.0);
  }
  verdict_.collision = verdict_.occlusion = false;
  verdict_.follows_trajectory = false;
  verdict_.placed = map && joints && inputs_.rootsKnown();
  if (verdict_.placed) {
    look(now, *joints);
  } else {
    forgetFindings();
  }
  decide(now);
  return verdict_;
}

void Checker::look(Time now, const JointSnapshot& joints) {
  const CuboidMap& map = *inputs_.map();
  const std::vector<Pose>& T_fixed_roots = inputs_.rootPoses();
  commanded_.follow(now, joints.positions);
  checks_.way.setOut(joints, commanded_);
  verdict_.follows_trajectory = checks_.way.followsTrajectory();
  checks_.now.check(map, joints.positions, T_fixed_roots, verdict_.now);
  checks_.ahead.check(map, checks_.way.positionsAtEnd(), T_fixed_roots, verdict_.ahead);
  judgeContacts(joints);
  judgeOcclusion();
  judgeEvidence(now);
  governSpeed(now, joints);
  if (config_.clearance_radius_m > 0.0) {
    Stopwatch stopwatch;
    verdict_.clearances = checks_.clearance.find(map, joints.positions, T_fixed_roots);
    verdict_.clearance_us = stopwatch.lapMicroseconds();
  }
}

Cause Checker::contactCause(Reason reason, Level level, std::uint32_t shape,
                            const std::string& what) const {
  const std::string& link = model_->linkOf(shape);
  const std::string& object = model_->shapes()[shape].object;
  const std::string who = object.empty() ? link : "'" + object + "' on " + link;
  return {reason, level, who + what, link};
}

void Checker::add(Cause cause, double speed_scale) {
  findings_.causes.push_back(std::move(cause));
  findings_.speed_scale = std::min(findings_.speed_scale, speed_scale);
}

void Checker::judgeContacts(const JointSnapshot& joints) {
  const CuboidMap& map = *inputs_.map();
  const std::vector<Pose>& T_fixed_roots = inputs_.rootPoses();
  Stopwatch stopwatch;
  const double latency_s = latency_s_ + toSeconds(verdict_.stamp - joints.oldest);
  const auto ahead = checks_.way.firstContact(map, latency_s, T_fixed_roots, verdict_.now.contacts);
  verdict_.way_poses = checks_.way.poses();
  verdict_.first_contact = ahead;
  if (verdict_.now.collision) {
    const Contact& contact = verdict_.now.contacts.front();
    verdict_.first_contact = WayContact{contact};
    findings_.touching =
        contactCause(Reason::kCollision, Level::kStop, contact.shape, " touches the map");
    // Where not all is known no way out is known either.
    const bool is_blocked =
        !findings_.known || (ahead && checks_.way.levelOf(*ahead) == Level::kStop);
    if (!is_blocked &&
        checks_.way.movesOut(map, verdict_.now.contacts, joints, commanded_, T_fixed_roots)) {
      add(contactCause(Reason::kMovingOut, Level::kSlow, contact.shape, " moves out of contact"),
          config_.way.moving_out_scale);
    } else {
      add(findings_.touching, 0.0);
    }
  }
  verdict_.way_us = stopwatch.lapMicroseconds();
  verdict_.collision = verdict_.now.collision || (ahead && !ahead->by_margin);
  if (!ahead) return;
  const Level level = checks_.way.levelOf(*ahead);
  add(contactCause(Reason::kCollisionAhead, level, ahead->contact.shape,
                   afterText(ahead->by_margin ? " comes too near to the map for its speed"
                                              : " touches the map ahead",
                             ahead->time_s)),
      level == Level::kSlow ? checks_.way.speedScale(*ahead) : 0.0);
}

void Checker::judgeOcclusion() {
  verdict_.occlusion = verdict_.now.occlusion || verdict_.ahead.occlusion;
  if (!verdict_.occlusion) return;
  const bool ahead = !verdict_.now.occlusion;
  const std::string link = checks_.now.mostHiddenLink(ahead ? verdict_.ahead : verdict_.now);
  // The links are the same at both poses.
  bool comes_out = !ahead;
  for (std::size_t i = 0; comes_out && i < verdict_.now.links.size(); ++i) {
    const double now = verdict_.now.links[i].occluded_fraction;
    const double then = verdict_.ahead.links[i].occluded_fraction;
    const bool is_hidden = checks_.now.isOccluded(verdict_.now.links[i]);
    if (is_hidden) comes_out = then <= now - kMoreVisible;
    if (!is_hidden && checks_.now.isOccluded(verdict_.ahead.links[i])) comes_out = false;
  }
  if (comes_out) {
    return add({Reason::kMovingOut, link + " comes out of where it is hidden", link},
               config_.way.moving_out_scale);
  }
  const Reason reason = ahead ? Reason::kOcclusionAhead : Reason::kOcclusion;
  add({reason, config_.occlusion_stops ? Level::kStop : Level::kSlow,
       link + " is hidden from the sensor" + (ahead ? " ahead" : ""), link},
      config_.occlusion_stops ? 0.0 : config_.occlusion_slow_scale);
}

void Checker::judgeEvidence(Time now) {
  Stopwatch stopwatch;
  const EvidenceCheck::Config& limits = config_.evidence;
  const EvidenceCheck::Findings& found = checks_.evidence.find(
      *inputs_.map(), now, checks_.now.collisionBody(), checks_.ahead.collisionBody());
  verdict_.evidence_us = stopwatch.lapMicroseconds();
  verdict_.unseen_fraction = found.unseen_fraction;
  const auto nameOf = [this](const LinkEvidence* link) { return model_->links()[link->link]; };
  if (found.unseen_fraction > limits.unseen_fraction_max) {
    const std::string link = nameOf(found.mostUnseen());
    char text[200];
    std::snprintf(text, sizeof text, "%.0f %% of the way ahead is unseen, most of %.100s's",
                  100.0 * found.unseen_fraction, link.c_str());
    add({Reason::kUnseenAhead, limits.unseen_stops ? Level::kStop : Level::kSlow, text, link},
        limits.unseen_stops ? 0.0 : limits.slow_scale);
  }
  const LinkEvidence* lost = found.mostLost();
  const LinkEvidence* old = found.mostOld();
  if (lost && lost->lost_fraction > limits.old_fraction_max) {
    add({Reason::kEvidenceOld, "the sensor looks no more where " + nameOf(lost) + " is",
         nameOf(lost)},
        0.0);
  } else if (old && old->old_fraction > limits.old_fraction_max) {
    add({Reason::kEvidenceOld, Level::kSlow,
         "the sensor did not look lately where " + nameOf(old) + " is", nameOf(old)},
        limits.slow_scale);
  }
}

void Checker::governSpeed(Time now, const JointSnapshot& joints) {
  verdict_.governed_scale = 1.0;
  if (!checks_.governed_speed.active()) return;
  const GovernedSpeed::Limit& limit = checks_.governed_speed.find(
      *inputs_.map(), now, joints, inputs_.rootPoses(), verdict_.speed_scale);
  verdict_.governed_scale = limit.scale;
  if (limit.scale >= 1.0) return;
  const std::string& link = model_->links()[limit.link];
  char text[200];
  if (limit.next_look_s) {
    std::snprintf(text, sizeof text, "%.100s: the place ahead is looked at in %.0f ms",
                  link.c_str(), 1e3 * *limit.next_look_s);
  } else {
    std::snprintf(text, sizeof text, "%.100s: no look at the place ahead is due", link.c_str());
  }
  add({Reason::kSpeedGoverned, text, link}, limit.scale);
}

const Verdict& Checker::fail(Time now, const Cause& cause) {
  findings_.causes.assign(1, cause);
  findings_.touching = {};
  findings_.known = verdict_.known = false;
  forgetFindings();
  verdict_.stamp = std::max(now, verdict_.stamp);
  decide(verdict_.stamp);
  return verdict_;
}

void Checker::decide(Time now) {
  const Permission::Decision& decision = permission_.decide(now, findings_);
  verdict_.level = decision.worst.level;
  verdict_.reason = decision.worst.reason;
  verdict_.detail = decision.worst.detail;
  verdict_.link = decision.worst.link;
  verdict_.reasons = decision.reasons;
  verdict_.latched = decision.latched;
  verdict_.speed_scale = decision.speed_scale;
  verdict_.stop = verdict_.level >= Level::kStop;
}

}  // namespace tccm
