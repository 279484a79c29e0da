#include "draft.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <set>
#include <tuple>

#include "robot/kinematics.h"

namespace tccm {
namespace {

constexpr int kPoses = 2000;                // that the arms' reach is taken from
constexpr double kAreaMargin = 0.1;         // [m]
constexpr double kAround = 0.5;             // [m] around a robot without arms
constexpr double kAreaStep = 0.05;          // [m]
constexpr double kAreaMax = 4.0;            // [m]
constexpr double kFloorMargin = 0.02;       // [m]
constexpr double kVisibleMin = 0.6;         // of a silhouette: a link that sensors see
constexpr std::size_t kArmJoints = 3;       // a link that so many joints move is one of an arm
constexpr double kPatientRate = 10.0;       // [Hz] of permissions
constexpr double kPaddingRaisedTo = 0.035;  // [m]; more hides hands, and is a model that is off

/// By how many joints that move each link is moved.
std::vector<std::size_t> depthsOf(const RobotModel& model) {
  std::vector<std::size_t> depths(model.links().size(), 0);
  for (const RobotJoint& joint : model.joints()) {
    const bool moves = joint.motion != RobotJoint::Motion::kFixed;
    depths[joint.child] = depths[joint.parent] + (moves ? 1 : 0);
  }
  return depths;
}

/// Links that have a shape, and are moved by at least so many joints.
std::set<std::size_t> linksFrom(const RobotModel& model, std::size_t joints) {
  const std::vector<std::size_t> depths = depthsOf(model);
  std::set<std::size_t> links;
  for (const LinkShape& shape : model.shapes()) {
    if (depths[shape.link] >= joints) links.insert(shape.link);
  }
  return links;
}

std::size_t mostJoints(const RobotModel& model) {
  const std::vector<std::size_t> depths = depthsOf(model);
  std::size_t most = 0;
  for (const LinkShape& shape : model.shapes()) most = std::max(most, depths[shape.link]);
  return most;
}

/// Somewhere between its limits, and within half a turn where it has none; sliding ones without
/// limits stay at 0.
double somewhere(const JointVariable& variable, bool slides, std::mt19937& random) {
  const double free = slides ? 0.0 : M_PI;
  const double lower = std::max(variable.lower.value_or(-free), slides ? -10.0 : -M_PI);
  const double upper = std::min(variable.upper.value_or(free), slides ? 10.0 : M_PI);
  const double share = static_cast<double>(random()) / static_cast<double>(std::mt19937::max());
  return lower + share * std::max(0.0, upper - lower);
}

double roundedDown(double metres) { return kAreaStep * std::floor(metres / kAreaStep + 1e-9); }
double roundedUp(double metres) { return roundedTo(metres, kAreaStep); }

}  // namespace

SetupDraft::SetupDraft(const Survey& survey, std::shared_ptr<const RobotModel> model)
    : survey_(survey), model_(std::move(model)) {
  text_.remark(
      "Written by `rosrun tccm_monitor setup` from what the robot published. It holds what");
  text_.remark("differs from config/default.yaml; docs/parameters.md has all parameters.");
  chooseFixedFrame();
  chooseSensors();
  if (model_) {
    chooseArea();
    chooseLinks();
  }
  chooseTimes();
}

void SetupDraft::chooseFixedFrame() {
  if (model_) {
    base_frame_ = model_->rootFrames().front();
  } else {
    base_frame_ = survey_.upFrom(*survey_.sensors.front().frames.begin()).back();
  }
  const std::vector<std::string> moving = survey_.movingBelow(base_frame_, "");
  fixed_frame_ = moving.empty() ? base_frame_ : survey_.frames.at(moving.front()).parent;
  for (const std::string& name : survey_.upFrom(base_frame_)) {
    if (name == fixed_frame_) break;
    T_fixed_base_ = survey_.frames.at(name).begin * T_fixed_base_;
  }
  const std::string why =
      moving.empty() ? "the robot's root, as nothing moves it"
                     : formatted("'%s' moves in it, by %.2f m and %.2f rad", moving.front().c_str(),
                                 survey_.frames.at(moving.front()).travel_m,
                                 survey_.frames.at(moving.front()).turn_rad);
  text_.set("collision_checker", "fixed_frame", fixed_frame_, why);
}

void SetupDraft::chooseArea() {
  const bool has_arms = mostJoints(*model_) >= kArmJoints;
  const std::set<std::size_t> arms = linksFrom(*model_, has_arms ? kArmJoints : 0);
  const std::set<std::size_t> moved = linksFrom(*model_, 1);
  Kinematics kinematics(model_);
  std::mt19937 random;  // NOLINT(cert-msc51-cpp): the same at every run
  UprightBox reach;
  bottom_m_ = INFINITY;
  std::vector<double> positions(model_->variables().size());
  const std::vector<Pose> roots(model_->roots().size(), T_fixed_base_);
  for (int i = 0; i < kPoses; ++i) {
    for (std::size_t v = 0; v < positions.size(); ++v) {
      positions[v] = somewhere(model_->variables()[v], model_->slides(v), random);
    }
    const Posture& posture = kinematics.update(positions, roots);
    for (std::size_t s = 0; s < model_->shapes().size(); ++s) {
      const LinkShape& shape = model_->shapes()[s];
      const UprightBox box = bounds(shape.shape, posture.T_fixed_shapes[s]);
      if (arms.count(shape.link) > 0) reach.extend(box);
      if (moved.count(shape.link) == 0) bottom_m_ = std::min(bottom_m_, box.min().z());
    }
  }
  if (!std::isfinite(bottom_m_)) bottom_m_ = T_fixed_base_.translation().z();
  const std::string why =
      has_arms ? formatted("the reach of what %zu joints or more move, by the URDF", kArmJoints)
               : formatted("the robot, which has no arms, and %.1f m around it", kAround);
  const double margin = has_arms ? kAreaMargin : kAround;
  const char* const keys[] = {"x", "y"};
  for (const Sensor& sensor : sensors_) {
    const std::string mapper = sectionOf(sensor, SensorConfig::kMapper);
    for (int axis = 0; axis < 2; ++axis) {
      const double middle = reach.center()[axis];
      const double half = std::min(0.5 * kAreaMax, 0.5 * reach.sizes()[axis] + margin);
      const double origin = roundedDown(middle - half);
      text_.set(mapper, formatted("area_origin_%s_m", keys[axis]), origin,
                axis == 0 ? why : "the same reach");
      text_.set(mapper, formatted("area_size_%s_m", keys[axis]), roundedUp(middle + half - origin),
                "the same reach");
    }
    text_.set(mapper, "height_max_m", roundedUp(reach.max().z() + margin), "the same reach");
  }
}

void SetupDraft::chooseLinks() {
  const std::size_t most = mostJoints(*model_);
  if (most < kArmJoints) {
    text_.set("collision_checker", "check_occlusion", "false", "the robot has no arms");
    return;
  }
  for (const std::size_t link : linksFrom(*model_, (2 * most + 2) / 3)) {
    hands_.push_back(model_->links()[link]);
  }
  text_.set("collision_checker", "occlusion_links", yamlList(hands_),
            "those that most joints move");
  text_.set("collision_checker", "evidence_links", yamlList(hands_),
            "whose way a sensor should have seen: likewise those that most joints move");
  if (!model_->linksWithoutShape().empty()) {
    text_.remark("Not watched, as they have no shape: " + yamlList(model_->linksWithoutShape()));
  }
}

void SetupDraft::chooseTimes() {
  if (!model_) return;
  std::set<std::string> wanted;
  for (const JointVariable& variable : model_->variables()) wanted.insert(variable.name);
  joint_topic_ = survey_.topicOfJoints(wanted);
  if (joint_topic_.empty()) return;
  if (joint_topic_ != "/joint_states") {
    text_.set("topics", "joint_states", joint_topic_, "the topic that has the URDF's joints");
  }
  std::string latest;
  double gap_s = 0.0;
  for (const auto& [name, joint] : survey_.joints.at(joint_topic_)) {
    const double longest_s = joint.longestGap(kGapMax);  // a longer one is a fault, and told
    if (wanted.count(name) == 0 || longest_s <= gap_s) continue;
    gap_s = longest_s;
    latest = name;
  }
  if (kHeadroom * gap_s <= 0.1) return;
  const std::string why = formatted("%s was silent for up to %.0f ms", latest.c_str(), 1e3 * gap_s);
  for (const Sensor& sensor : sensors_) {
    const char* stage =
        sensor.heard->is_cloud ? SensorConfig::kCloudAssembler : SensorConfig::kScanAssembler;
    text_.set(sectionOf(sensor, stage), "joint_gap_max_s", roundedTo(kHeadroom * gap_s, 0.01), why);
  }
}

MonitorConfig SetupDraft::settings() const {
  const ScratchFile file("yaml");
  writeText(file.path(), yaml());
  return readMonitorConfig(file.path());
}

MonitorConfig SetupDraft::trialSettings() const {
  constexpr double kBelow = 0.5;           // [m] the robot's lowest part
  constexpr std::size_t kScansMax = 8192;  // of a tilt that takes minutes
  MonitorConfig trial = settings();
  trial.checker.checker.permission.hold_until_reset = false;
  trial.checker.checker.inputs.joint_timeout_s = kGapMax;
  const auto widen = [this](MapperConfig& config) {
    IntegrationMap::Config& map = config.mapper.map;
    map.grid.height_min_m = bottom_m_ - kBelow;
    map.grid.height_max_m = std::max(map.grid.height_max_m, bottom_m_ + kBelow);
    map.scans_max = kScansMax;
  };
  widen(trial.mapper);
  for (SensorConfig& sensor : trial.named_sensors) widen(sensor.mapper);
  return trial;
}

void SetupDraft::setTimes(const Lessons& lessons, bool is_patient) {
  const std::string patience = "--patient: this computer pauses now and then";
  double timeout_s = roundedTo(kHeadroom * lessons.joint_age_s, 0.01);
  std::string why = formatted("joint states were up to %.0f ms old", 1e3 * lessons.joint_age_s);
  if (is_patient && timeout_s <= 0.3) std::tie(timeout_s, why) = std::tuple(0.3, patience);
  if (timeout_s > 0.1) {
    text_.set("collision_checker", "joint_timeout_s", timeout_s, why);
    joints_late_ = {timeout_s, why};
  }
  double most = is_patient ? 10.0 : 0.0;
  why = patience;
  for (std::size_t i = 0; model_ && i < sensors_.size(); ++i) {
    const double age_s = lessons.map_ages_s[i];
    const double periods = std::ceil(kHeadroom * age_s * sensors_[i].heard->rate());
    if (periods <= most) continue;
    most = periods;
    why = formatted("%s was up to %.0f ms old", sensors_[i].heard->topic.c_str(), 1e3 * age_s);
  }
  if (most > 3.0) text_.set("collision_checker", "scan_timeout_periods", most, why);
  if (!is_patient) return;
  // A permission is valid for 2.5 periods, and a check may take 2.
  text_.set("collision_checker", "publish_rate_hz", kPatientRate, patience);
  text_.set("collision_checker", "check_time_max_periods", 2.0, patience);
}

void SetupDraft::setFloor(const std::optional<Floor>& floor) {
  const double lowest =
      floor ? floor->highest_m + 3.0 * floor->noise_m + kFloorMargin : bottom_m_ - kAreaStep;
  const std::string why = floor ? formatted("the floor lies at %.3f, with a noise of %.1f mm",
                                            floor->highest_m, 1e3 * floor->noise_m)
                                : "no floor was seen: a little below the robot's lowest part";
  for (const Sensor& sensor : sensors_) {
    text_.set(sectionOf(sensor, SensorConfig::kMapper), "height_min_m", roundedTo(lowest, 0.01),
              why);
  }
}

void SetupDraft::setGate(const std::vector<ArmController>& controllers) {
  const std::string ending = "_controller";
  std::string list;
  for (const ArmController& controller : controllers) {
    const std::string downstream = controller.name.substr(1);  // as all names here, relative
    const std::size_t length = downstream.size() - std::min(downstream.size(), ending.size());
    const bool ends = length > 0 && downstream.substr(length) == ending;
    const std::string name = ends ? downstream.substr(0, length) : downstream + "_gate";
    list +=
        formatted("%s{name: %s, downstream: %s, stop_duration_s: %.10g}", list.empty() ? "" : ", ",
                  name.c_str(), downstream.c_str(), controller.stop_duration_s);
  }
  text_.set("trajectory_gate", "controllers", "[" + list + "]",
            "those that run; send goals to NAME/follow_joint_trajectory");
  if (joints_late_) {
    text_.set("trajectory_gate", "joints_age_max_s", joints_late_->first, joints_late_->second);
  }
}

bool SetupDraft::learnModel(const OwnReturns& own) {
  const double padding_m = BodySampler::Config().filtered.expansion.padding_m;
  std::string exceptions, why, apart;
  double worst_m = 0.0;
  std::set<std::string> arms;  // what else there is stands on and beside things
  for (const std::size_t link : linksFrom(*model_, kArmJoints)) arms.insert(model_->links()[link]);
  std::vector<std::string> compared;
  for (const OwnReturns::OfLink& link : own.links()) {
    if (arms.count(link.link) == 0) continue;
    compared.push_back(link.link);
    if (link.reach_m <= padding_m) continue;
    const double needed_m = link.reach_m + 0.005;
    if (link.is_apart || needed_m > kPaddingRaisedTo) {
      worst_m = std::max(worst_m, link.is_apart ? link.median_m : link.reach_m);
      apart += formatted("%s%s (%.0f mm)", apart.empty() ? "" : ", ", link.link.c_str(),
                         1e3 * (link.is_apart ? link.median_m : link.reach_m));
      continue;
    }
    exceptions += formatted("%s{links: [%s], scale: 1.0, padding_m: %.3f}",
                            exceptions.empty() ? "" : ", ", link.link.c_str(), needed_m);
    why += formatted("%s%s %.0f mm",
                     why.empty() ? "its own returns lie outside of the model by: " : ", ",
                     link.link.c_str(), 1e3 * link.reach_m);
  }
  if (!arms.empty()) {
    text_.remark(
        formatted("Of %zu links of the arms %zu were seen well enough to compare them with "
                  "the model: ",
                  arms.size(), compared.size()) +
        yamlList(compared));
  }
  if (compared.empty() && !arms.empty()) {
    notes_.push_back(
        "no sensor saw enough of the arms to tell whether they are where the model is");
  }
  for (const Sensor& sensor : sensors_) {
    if (exceptions.empty() || !apart.empty()) break;
    text_.set(sectionOf(sensor, sensor.heard->is_cloud ? SensorConfig::kCloudAssembler
                                                       : SensorConfig::kScanAssembler),
              "self_filter_exceptions", "[" + exceptions + "]", why);
  }
  if (apart.empty()) return true;
  defects_.push_back(
      formatted("the model is off by up to %.0f mm: returns lie outside of %s; correct the shapes, "
                "the joints' zeros or the sensor's frame, or take away what stands so near",
                1e3 * worst_m, apart.c_str()));
  return false;
}

void SetupDraft::learn(const Lessons& lessons, bool is_patient) {
  for (std::size_t i = 0; i < sensors_.size(); ++i) {
    std::string what = whatOf(*sensors_[i].heard);
    const auto& share = lessons.robot_shares[i];
    if (model_ && share) what += formatted("; %.0f %% on the robot", 100.0 * *share);
    setTopic(sensors_[i], what);
  }
  for (std::size_t i = 0; i < sensors_.size(); ++i) {
    if (!lessons.tilt_periods_s[i]) continue;
    // Before a whole period is measured the window holds what came since the start.
    const double scans = 2.2 * *lessons.tilt_periods_s[i] * sensors_[i].heard->rate();
    if (scans <= 512.0) continue;
    text_.set(sectionOf(sensors_[i], SensorConfig::kMapper), "window_scans_max",
              256.0 * std::ceil(scans / 256.0),
              formatted("a tilt period is %.2f s", *lessons.tilt_periods_s[i]));
  }
  for (std::size_t i = 0; i < sensors_.size(); ++i) {
    if (lessons.points_in_area[i] > 0) continue;
    defects_.push_back(sensors_[i].heard->topic +
                       ": nothing that it saw lies in the area, nor on the floor below it: see to "
                       "where it looks, and to its frame");
  }
  setFloor(findFloor(lessons.points, bottom_m_));
  setTimes(lessons, is_patient);
  if (hands_.empty()) return;
  std::vector<std::string> seen;
  for (const std::string& link : hands_) {
    const auto visible = lessons.visible.find(link);
    if (visible != lessons.visible.end() && visible->second >= kVisibleMin) seen.push_back(link);
  }
  if (seen.empty()) {
    text_.remove("collision_checker", "occlusion_links");
    text_.set("collision_checker", "check_occlusion", "false",
              "no sensor saw the hands: those that would be watched are in evidence_links");
    notes_.push_back("no sensor sees " + yamlList(hands_) +
                     " well: whether they are hidden is not checked (check_occlusion)");
  } else {
    text_.set("collision_checker", "occlusion_links", yamlList(seen),
              formatted("seen well, of %zu that most joints move", hands_.size()));
  }
}

}  // namespace tccm
