#include "tccm_monitor/checker.h"

#include <algorithm>

#include "base/stopwatch.h"
#include "check/checker_parts.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

bool isMilder(const Cause& one, const Cause& other) { return other.isWorseThan(one); }

}  // namespace

void Checker::Config::describe(ParameterTable& table) {
  pose.describe(table);
  way.describe(table);
  braking.describe(table);
  evidence.describe(table);
  governed_speed.describe(table);
  approach.describe(table);
  table.add("clearance_radius_m", &clearance_radius_m, "m", {0.0, 1.0},
            "clearances are measured up to this; 0: not at all");
  trajectory.describe(table);
  trajectories.describe(table);
  inputs.describe(table);
  permission.describe(table);
  exemptions.describe(table);
  keep_out.describe(table);
}

Judges::Judges(const std::shared_ptr<const RobotModel>& model, const Checker::Config& config)
    : robot(std::make_shared<CheckedRobot>(model, config.pose)),
      here(robot, config.evidence.slow_periods),
      ahead(here),
      asked(here),
      area(robot),
      contacts(robot, config.way, config.braking),
      keep_out(robot, config.way, config.braking, ContactJudge::Against::kKeepOut),
      evidence(robot, config.evidence),
      governed_speed(model, config.governed_speed, evidence.shapes()),
      approach(robot, config.approach),
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
      keep_out(config.keep_out, *bare_model, config.inputs.fixed_frame),
      permission(config.permission),
      judges(bare_model, config) {
  keep_out.take(*judges.robot->model, judges.robot->collision_body);
}

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
  keep_out.take(*judges.robot->model, judges.robot->collision_body);
  ++revision;
}

void Checker::Parts::exempt() {
  judges.robot->collision.exempt(
      exemptions.regionsOf(model(), judges.robot->collision_body.shapes));
}

Exemptions::Limits Checker::Parts::transformLimits() const {
  return {config.inputs.transform_timeout_s, config.inputs.transform_future_max_s};
}

void Checker::Parts::updateExemptions(Time now) {
  if (exemptions.update(now, transformLimits())) exempt();
  judges.robot->collision.updateRegions(exemptions.regions());
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
  verdict.keep_out = false;
  verdict.approached.reset();
  verdict.clearances.clear();
  verdict.unseen_fraction = 0.0;
  verdict.placed = verdict.collision = verdict.occlusion = false;
}

void Checker::Parts::startAnew() {
  ++revision;
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
  updateExemptions(now);
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
  const Surroundings around = this->around();
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
  judges.here.findContacts(around, verdict.now);
  judges.ahead.findContacts(around, verdict.ahead);
  times.collision_us = stopwatch.lapMicroseconds();
  judges.here.findOcclusion(around, verdict.now, judges.ahead, verdict.ahead);
  times.occlusion_us = stopwatch.lapMicroseconds();

  const Situation situation{
      now,         around,        joints,         commanded,     judges.here,        judges.ahead,
      verdict.now, verdict.ahead, config.braking, verdict.known, verdict.speed_scale};
  const ContactJudge::Findings& contacts = judges.contacts.judge(situation, findings.causes);
  const ContactJudge::Findings& keep_out = judges.keep_out.judge(situation, findings.causes);
  times.way_us = stopwatch.lapMicroseconds();
  judgeOcclusion(situation, config.pose.occlusion, config.way.moving_out_scale, findings.causes);
  judges.evidence.judge(situation, findings.causes);
  times.evidence_us = stopwatch.lapMicroseconds();
  judges.governed_speed.judge(situation, findings.causes);
  verdict.approached = judges.approach.judge(situation, findings.causes);

  // What was not looked along to its end is not known to be free.
  const auto isTooLong = [](const Cause& cause) { return cause.reason == Reason::kCheckLate; };
  if (std::any_of(findings.causes.begin(), findings.causes.end(), isTooLong)) {
    verdict.known = findings.known = false;
  }
  findings.touching = std::max(contacts.touching, keep_out.touching, isMilder);
  verdict.collision = contacts.touches;
  verdict.keep_out = keep_out.touches;
  verdict.first_contact = contacts.first_contact;
  verdict.way_poses = contacts.poses;
  verdict.occlusion = verdict.now.occlusion || verdict.ahead.occlusion;
  verdict.unseen_fraction = judges.evidence.findings().unseen_fraction;
  verdict.governed_scale = judges.governed_speed.limit().scale;
  if (config.clearance_radius_m <= 0.0) return;
  stopwatch.lapMicroseconds();
  verdict.clearances = judges.here.findClearances(around, config.clearance_radius_m);
  times.clearance_us = stopwatch.lapMicroseconds();
}

Surroundings Checker::Parts::around() {
  if (keep_out.size() == 0) return inputs.around(nullptr);
  keep_out.place(inputs.rootPoses(), inputs.rootsMove());
  return inputs.around(&keep_out);
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
double Checker::latency() const { return parts_->config.braking.latency_s; }
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
  ++parts_->revision;
  parts_->exempt();
  parts_->updateExemptions(now);
}

void Checker::setKeepOut(const KeepOutRegion& region) {
  parts_->keep_out.set(region, *parts_->bare_model, parts_->config.inputs.fixed_frame);
  ++parts_->revision;
  parts_->forgetFindings();
}

void Checker::removeKeepOut(const std::string& name) {
  parts_->keep_out.remove(name);
  ++parts_->revision;
  parts_->forgetFindings();
}

const std::vector<KeepOutRegion>& Checker::keepOut() const { return parts_->keep_out.regions(); }

std::size_t Checker::liftExemptions(const std::string& owner, const std::string& link) {
  const std::size_t lifted = parts_->exemptions.lift(owner, link);
  parts_->revision += lifted;
  parts_->exempt();
  return lifted;
}

void Checker::reportGoal(Time now, const std::string& owner, const std::string& goal,
                         bool under_way) {
  parts_->exemptions.reportGoal(now, owner, goal, under_way);
  if (!parts_->exemptions.list().empty()) ++parts_->revision;
  parts_->exempt();
  parts_->updateExemptions(now);
}

std::vector<std::string> Checker::exemptFrames() const { return parts_->exemptions.frames(); }

void Checker::setExemptFrame(const std::string& frame, Time stamp, const Pose& T_fixed_frame,
                             bool is_static) {
  parts_->exemptions.setFrame(frame, stamp, T_fixed_frame, is_static);
}

void Checker::updateExemptions(Time now) { parts_->updateExemptions(now); }

const std::vector<Exemption>& Checker::exemptions() const { return parts_->exemptions.list(); }

std::string Checker::whyNotInForce(const Exemption& exemption) const {
  return tccm::whyNotInForce(exemption, parts_->transformLimits());
}

std::optional<Pose> Checker::regionPose(std::size_t index) const {
  const ExemptRegion& region = parts_->exemptions.regions()[index];
  if (parts_->exemptions.list()[index].state == Exemption::State::kNoTransform) return std::nullopt;
  if (!region.link) return region.placed.pose;
  if (!parts_->verdict.placed) return std::nullopt;
  return parts_->judges.here.posture().T_fixed_links[*region.link] * region.placed.pose;
}

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

std::size_t Checker::revision() const { return parts_->revision; }

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
