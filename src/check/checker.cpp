#include "tccm_monitor/checker.h"

#include <algorithm>

#include "base/stopwatch.h"
#include "check/checker_parts.h"
#include "tccm_monitor/config_error.h"

namespace tccm {

void Checker::Config::describe(ParameterTable& table) {
  pose.describe(table);
  way.describe(table);
  braking.describe(table);
  evidence.describe(table);
  governed_speed.describe(table);
  table.add("clearance_radius_m", &clearance_radius_m, "m", {0.0, 1.0},
            "clearances are measured up to this; 0: not at all");
  trajectory.describe(table);
  trajectories.describe(table);
  inputs.describe(table);
  permission.describe(table);
  exemptions.describe(table);
}

Judges::Judges(const std::shared_ptr<const RobotModel>& model, const Checker::Config& config)
    : robot(std::make_shared<CheckedRobot>(model, config.pose)),
      here(robot, config.evidence.slow_periods),
      ahead(here),
      asked(here),
      area(robot),
      contacts(robot, config.way, config.braking),
      evidence(robot, config.evidence),
      governed_speed(model, config.governed_speed, evidence.shapes()),
      trajectory(robot, config.trajectory, config.clearance_radius_m,
                 config.evidence.slow_periods) {
  const std::vector<std::string> missed = selfTest(*robot, asked);
  if (missed.empty()) return;
  std::string names;
  for (const std::string& link : missed) names += " '" + link + "'";
  throw ConfigError("self-test: a virtual cuboid is not found in" + names);
}

Checker::Parts::Parts(std::shared_ptr<const RobotModel> model, const Config& new_config)
    : config(validated(new_config)),
      bare_model(std::move(model)),
      inputs(bare_model, config.inputs),
      commanded(bare_model, config.trajectories),
      exemptions(config.exemptions),
      permission(config.permission),
      judges(bare_model, config) {}

void Checker::Parts::renew(const Config& new_config, std::vector<AttachedObject> objects) {
  auto model = bare_model;
  if (!objects.empty()) model = std::make_shared<const RobotModel>(bare_model->holding(objects));
  Judges new_judges(model, validated(new_config));
  new_judges.governed_speed.takeOver(judges.governed_speed);
  const double latency_s = config.braking.latency_s;
  config = new_config;
  config.braking.latency_s = latency_s;
  permission.reconfigure(config.permission);
  inputs.reconfigure(config.inputs);
  attached = std::move(objects);
  judges = std::move(new_judges);
  exempt();
}

void Checker::Parts::exempt() {
  judges.robot->collision.exempt(
      exemptions.regionsOf(model(), judges.robot->collision_body.shapes));
}

std::vector<AttachedObject> Checker::Parts::attachedBut(const std::string& name) const {
  std::vector<AttachedObject> objects = attached;
  objects.erase(std::remove_if(objects.begin(), objects.end(),
                               [&name](const auto& object) { return object.name == name; }),
                objects.end());
  return objects;
}

/// Their shapes and cuboids are numbered as before.
void Checker::Parts::forgetFindings() {
  verdict.now = {};
  verdict.ahead = {};
  verdict.first_contact.reset();
  verdict.clearances.clear();
  verdict.unseen_fraction = 0.0;
  verdict.placed = verdict.collision = verdict.occlusion = false;
}

void Checker::Parts::startAnew() {
  inputs.reset();
  commanded.clear();
  exemptions.clear();
  exempt();
  permission.startAnew();
  judges.governed_speed.startAnew();
  verdict.speed_scale = 0.0;
  started = false;
}

const Verdict& Checker::Parts::check(Time now) {
  clock_steps.add(now);
  if (started && verdict.stamp - now > fromSeconds(config.inputs.future_max_s)) startAnew();
  // A clock that is set back by a little goes on from where it was.
  if (started) now = std::max(now, verdict.stamp);
  started = true;
  if (exemptions.expire(now)) exempt();
  findings.causes.clear();
  findings.touching = {};
  inputs.appendCauses(now, findings.causes);
  inputs.unite(now);
  const JointSnapshot* joints = inputs.joints();
  const CuboidMap* map = inputs.map();
  verdict.stamp = now;
  verdict.joints_stamp = joints ? joints->oldest : Time();
  verdict.serial = map ? map->serial : 0;
  findings.window = map ? map->window : Duration::zero();
  if (clock_steps.goesToAndFro())
    findings.causes.emplace_back(Reason::kNoClock, clock_steps.text());
  verdict.known = findings.known = findings.causes.empty();
  if (const std::string defect = commanded.defect(); !defect.empty()) {
    findings.causes.push_back({Reason::kBadTrajectory, "a commanded trajectory: " + defect});
  }
  verdict.follows_trajectory = false;
  verdict.placed = map && joints && inputs.rootsKnown();
  if (verdict.placed) {
    judge(now, *joints);
  } else {
    forgetFindings();
  }
  decide(now);
  return verdict;
}

void Checker::Parts::judge(Time now, const JointSnapshot& joints) {
  const Surroundings around = inputs.around();
  const CuboidMap& map = around.map;
  Stopwatch stopwatch;
  commanded.follow(now, joints.positions);
  const Ways& ways = commanded.findWays(joints, config.way.horizon_s);
  verdict.follows_trajectory = ways.follows_trajectory;
  judges.here.place(joints.positions, inputs.rootPoses());
  judges.ahead.place(ways.end, inputs.rootPoses());
  if (const Cause outside = outsideArea(judges.here.posture()); outside.reason != Reason::kClear) {
    findings.causes.push_back(outside);
    verdict.known = findings.known = false;
  }
  judges.here.findContacts(map, verdict.now);
  judges.ahead.findContacts(map, verdict.ahead);
  times.collision_us = stopwatch.lapMicroseconds();
  judges.here.findOcclusion(around, verdict.now);
  judges.ahead.findOcclusion(around, verdict.ahead);
  times.occlusion_us = stopwatch.lapMicroseconds();

  const Situation situation{
      now,         around,        joints,         commanded,     judges.here,        judges.ahead,
      verdict.now, verdict.ahead, config.braking, verdict.known, verdict.speed_scale};
  const ContactJudge::Findings& contacts = judges.contacts.judge(situation, findings.causes);
  times.way_us = stopwatch.lapMicroseconds();
  judgeOcclusion(situation, config.pose.occlusion, config.way.moving_out_scale, findings.causes);
  judges.evidence.judge(situation, findings.causes);
  times.evidence_us = stopwatch.lapMicroseconds();
  judges.governed_speed.judge(situation, findings.causes);

  findings.touching = contacts.touching;
  verdict.collision = contacts.collision;
  verdict.first_contact = contacts.first_contact;
  verdict.way_poses = contacts.poses;
  verdict.occlusion = verdict.now.occlusion || verdict.ahead.occlusion;
  verdict.unseen_fraction = judges.evidence.findings().unseen_fraction;
  verdict.governed_scale = judges.governed_speed.limit().scale;
  if (config.clearance_radius_m <= 0.0) return;
  stopwatch.lapMicroseconds();
  verdict.clearances = judges.here.findClearances(map, config.clearance_radius_m);
  times.clearance_us = stopwatch.lapMicroseconds();
}

Cause Checker::Parts::outsideArea(const Posture& posture) const {
  return judges.area.judge(inputs.map()->grid, posture, inputs.rootsMove(),
                           config.inputs.fixed_frame);
}

void Checker::Parts::decide(Time now) {
  const Permission::Decision& decision = permission.decide(now, findings);
  verdict.level = decision.worst.level;
  verdict.reason = decision.worst.reason;
  verdict.detail = decision.worst.detail;
  verdict.link = decision.worst.link;
  verdict.reasons = decision.reasons;
  verdict.latched = decision.latched;
  verdict.speed_scale = decision.speed_scale;
  verdict.stop = verdict.level >= Level::kStop;
}

Checker::Checker(std::shared_ptr<const RobotModel> model, const Config& config)
    : parts_(std::make_unique<Parts>(std::move(model), config)) {}

Checker::~Checker() = default;

void Checker::reconfigure(const Config& config) { parts_->renew(config, parts_->attached); }
const Checker::Config& Checker::config() const { return parts_->config; }

JointStates::Added Checker::addJoints(Time now, Time stamp, const std::vector<std::string>& names,
                                      const std::vector<double>& positions,
                                      const std::vector<double>& velocities,
                                      const std::string& publisher) {
  return parts_->inputs.addJoints(now, stamp, names, positions, velocities, publisher);
}

void Checker::setRootPose(std::size_t root, Time stamp, const Pose& T_fixed_root, bool is_static) {
  parts_->inputs.setRootPose(root, stamp, T_fixed_root, is_static);
}

void Checker::addScanReport(Time now, const ScanReport& report, std::size_t sensor) {
  parts_->inputs.addScanReport(now, report, sensor);
}

void Checker::setMap(Time now, std::shared_ptr<const CuboidMap> map, std::size_t sensor) {
  parts_->inputs.setMap(now, std::move(map), sensor);
}

std::string Checker::command(Time now, const JointTrajectory& trajectory) {
  CheckInputs& inputs = parts_->inputs;
  const JointSnapshot* joints = inputs.placesRobot(now) ? inputs.joints() : nullptr;
  if (!joints) return parts_->commanded.command(now, trajectory, {});
  return parts_->commanded.command(now, trajectory, joints->positions, joints->velocities);
}

void Checker::setLatency(double seconds) { parts_->config.braking.latency_s = seconds; }
void Checker::setOutsideCause(const Cause& cause) { parts_->inputs.setOutsideCause(cause); }

void Checker::attach(const AttachedObject& object) {
  std::vector<AttachedObject> objects = parts_->attachedBut(object.name);
  objects.push_back(object);
  parts_->renew(parts_->config, std::move(objects));
  parts_->forgetFindings();
}

bool Checker::detach(const std::string& object) {
  std::vector<AttachedObject> objects = parts_->attachedBut(object);
  if (objects.size() == parts_->attached.size()) return false;
  parts_->renew(parts_->config, std::move(objects));
  parts_->forgetFindings();
  return true;
}

const std::vector<AttachedObject>& Checker::attached() const { return parts_->attached; }

void Checker::addExemption(Time now, const Exemption& exemption, double duration_s) {
  parts_->exemptions.add(now, exemption, duration_s, parts_->model());
  parts_->exempt();
}

const std::vector<Exemption>& Checker::exemptions() const { return parts_->exemptions.list(); }

const Verdict& Checker::check(Time now) { return parts_->check(now); }

const Verdict& Checker::fail(Time now, const Cause& cause) {
  Permission::Findings& findings = parts_->findings;
  Verdict& verdict = parts_->verdict;
  findings.causes.assign(1, cause);
  findings.touching = {};
  findings.known = verdict.known = false;
  parts_->forgetFindings();
  verdict.stamp = std::max(now, verdict.stamp);
  parts_->decide(verdict.stamp);
  return verdict;
}

std::string Checker::reset() { return parts_->permission.reset(); }
void Checker::startAnew() { parts_->startAnew(); }

const std::shared_ptr<const RobotModel>& Checker::model() const {
  return parts_->judges.robot->model;
}

std::vector<std::string> Checker::missingJoints() const {
  return parts_->inputs.jointStates().missingJoints();
}

const CuboidMap* Checker::map() const { return parts_->inputs.map(); }
const CheckTimes& Checker::times() const { return parts_->times; }
CheckInputs& Checker::inputs() { return parts_->inputs; }
const CheckInputs& Checker::inputs() const { return parts_->inputs; }
ModelAgreement& Checker::agreement() { return parts_->inputs.agreement(); }
const ModelAgreement& Checker::agreement() const { return parts_->inputs.agreement(); }
const EvidenceCheck& Checker::evidence() const { return parts_->judges.evidence; }
const PoseCheck& Checker::checkHere() const { return parts_->judges.here; }
const PoseCheck& Checker::checkAhead() const { return parts_->judges.ahead; }

}  // namespace tccm
