#include "check/check_inputs.h"

#include <algorithm>
#include <utility>

#include "base/duration_text.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

std::string ageText(const std::string& what, Duration age) {
  return what + " " + durationText(age);
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

void append(const Cause& cause, std::vector<Cause>& causes) {
  if (cause.reason != Reason::kClear) causes.push_back(cause);
}

}  // namespace

void CheckInputs::Config::describe(ParameterTable& table) {
  joints.describe(table);
  table.add("joint_timeout_s", &joint_timeout_s, "s", {0.001, 10.0},
            "age of the joint heard of least recently");
  table.add("transform_timeout_s", &transform_timeout_s, "s", {0.001, 10.0},
            "age of the root's pose in the fixed frame, and of frames that exemptions are in");
  Limits::describe(table);
  table.add("transform_future_max_s", &transform_future_max_s, "s", {0.0, 10.0},
            "those poses may lead it by this: many publishers date ahead");
  agreement.describe(table);
  table.addList(
      "sensors", sensors,
      "each with a map of its own, in a namespace of its name; empty: one without a name");
}

void CheckInputs::Config::validate() const {
  for (auto sensor = sensors.begin(); sensor != sensors.end(); ++sensor) {
    if (sensor->name.empty()) throw ConfigError("sensors: one has no name");
    const bool again = std::any_of(std::next(sensor), sensors.end(),
                                   [&](const auto& other) { return other.name == sensor->name; });
    if (again) throw ConfigError("sensors: '" + sensor->name + "' is named twice");
  }
  const bool one_is_required = std::any_of(sensors.begin(), sensors.end(),
                                           [](const auto& sensor) { return sensor.required; });
  if (!sensors.empty() && !one_is_required) {
    throw ConfigError("sensors: one at least has to be required");
  }
}

CheckInputs::CheckInputs(std::shared_ptr<const RobotModel> model, const Config& config)
    : model_(std::move(model)),
      config_(validated(config)),
      joints_(*model_, config.joints),
      agreement_(model_, config.agreement),
      roots_(model_->roots().size()),
      T_fixed_roots_(model_->roots().size(), Pose::Identity()) {
  for (const SensorInput::Config& sensor : config_.sensors) sensors_.emplace_back(sensor);
  if (sensors_.empty()) sensors_.emplace_back(SensorInput::Config());
  outs_.resize(sensors_.size());
  sources_.resize(sensors_.size());
}

void CheckInputs::reconfigure(const Config& config) {
  config_ = validated(config);
  agreement_.reconfigure(config.agreement);
}

JointStates::Added CheckInputs::addJoints(Time now, Time stamp,
                                          const std::vector<std::string>& names,
                                          const std::vector<double>& positions,
                                          const std::vector<double>& velocities,
                                          const std::string& publisher) {
  if (stamp - now > fromSeconds(config_.future_max_s)) {
    ++future_joints_;
    future_joint_ = now;
    future_lead_ = stamp - now;
    return {0, names.size()};
  }
  agreement_.addJoints(stamp, names, positions);
  return joints_.add(stamp, names, positions, velocities, publisher);
}

void CheckInputs::setRootPose(std::size_t root, Time stamp, const Pose& T_fixed_root,
                              bool is_static) {
  if (!isRigid(T_fixed_root)) return;
  roots_[root] = RootPose{stamp, is_static};
  T_fixed_roots_[root] = T_fixed_root;
}

void CheckInputs::addScanReport(Time now, const ScanReport& report, std::size_t sensor) {
  sensors_[sensor].addScanReport(now, report);
}

void CheckInputs::setMap(Time now, std::shared_ptr<const CuboidMap> map, std::size_t sensor) {
  sensors_[sensor].setMap(now, std::move(map));
  maps_changed_ = true;
  // What a verdict says of several sensors' cuboids counts them as they were at that check.
  if (sensors_.size() == 1) unite(now);
}

bool CheckInputs::fits(std::size_t sensor) const {
  const auto first = std::find_if(sensors_.begin(), sensors_.end(),
                                  [](const SensorInput& input) { return input.map() != nullptr; });
  return !sensors_[sensor].map() || SensorMaps::fit(*first->map(), *sensors_[sensor].map());
}

void CheckInputs::unite(Time now) {
  for (std::size_t i = 0; i < sensors_.size(); ++i) {
    SensorMaps::Source& source = sources_[i];
    source.map = fits(i) ? sensors_[i].map() : nullptr;
    source.is_out = !outs_[i].empty();
    if (!source.is_out) source.seen = source.map;
    // It was told to forget all that it saw.
    const bool is_cleared = source.map && source.map->looks.empty();
    if (is_cleared && source.seen && !source.seen->looks.empty()) source.seen = nullptr;
  }
  maps_.unite(now, sources_, std::exchange(maps_changed_, false));
}

void CheckInputs::reset() {
  joints_.reset();
  agreement_.reset();
  for (SensorInput& sensor : sensors_) sensor.reset();
  std::fill(outs_.begin(), outs_.end(), std::string());
  std::fill(sources_.begin(), sources_.end(), SensorMaps::Source());
  maps_.clear();
  started_.reset();
  future_joint_.reset();
  std::fill(roots_.begin(), roots_.end(), std::nullopt);
}

bool CheckInputs::rootsKnown() const {
  return std::find(roots_.begin(), roots_.end(), std::nullopt) == roots_.end();
}

bool CheckInputs::rootsMove() const {
  return std::any_of(roots_.begin(), roots_.end(),
                     [](const auto& root) { return root && !root->is_static; });
}

bool CheckInputs::within(Time now, double seconds) const {
  return now - *started_ <= fromSeconds(seconds);
}

Cause CheckInputs::jointsCause(Time now) {
  if (!joints_.contradiction().empty()) return {Reason::kNoJoints, joints_.contradiction()};
  const JointSnapshot* joints = joints_.latest();
  const Duration timeout = fromSeconds(config_.joint_timeout_s);
  const bool fresh = joints && now - joints->oldest <= timeout;
  if (!fresh && future_joint_ && now - *future_joint_ <= timeout) {
    return {Reason::kFuture, ageText("joint states are stamped in the future, by", future_lead_)};
  }
  if (!joints) {
    if (within(now, config_.joint_timeout_s)) return {Reason::kInit, "waiting for joint states"};
    return {Reason::kNoJoints, neverPublished(joints_.missingJoints())};
  }
  const Duration lead = joints->newest - now;
  if (lead > fromSeconds(config_.future_max_s)) {  // the clock was set back a little
    return {Reason::kFuture, ageText("a joint state is stamped in the future, by", lead)};
  }
  if (fresh) return {};
  return {Reason::kNoJoints, silentJointText(now, *joints)};
}

std::string CheckInputs::silentJointText(Time now, const JointSnapshot& joints) const {
  if (joints.oldest == Time()) return "joint states are stamped 0: see who publishes them so";
  const Duration timeout = fromSeconds(config_.joint_timeout_s);
  if (now - joints.newest > timeout) {
    return ageText("no joint was heard of for", now - joints.newest) + ", at most " +
           durationText(timeout) + " (joint_timeout_s)";
  }
  const std::string& name = model_->variables()[joints.oldest_joint].name;
  return ageText("joint '" + name + "' was not heard of for", now - joints.oldest) + ", at most " +
         durationText(timeout) + " (joint_timeout_s)";
}

Cause CheckInputs::rootCause(Time now, std::size_t index) const {
  const std::optional<RootPose>& root = roots_[index];
  const std::string& link = model_->links()[model_->roots()[index]];
  if (!root) {
    if (within(now, config_.transform_timeout_s)) {
      return {Reason::kInit, "waiting for the pose of '" + link + "'"};
    }
    return {Reason::kNoTransform, "no transform from the robot's root '" + link +
                                      "' to fixed_frame '" + config_.fixed_frame + "'"};
  }
  const Duration age = now - root->stamp;
  if (root->is_static) return {};
  if (-age > fromSeconds(config_.transform_future_max_s)) {
    return {Reason::kFuture,
            ageText("the pose of '" + link + "' is stamped in the future, by", -age)};
  }
  if (age <= fromSeconds(config_.transform_timeout_s)) return {};
  return {Reason::kNoTransform,
          ageText("the pose of '" + link + "' in the fixed frame was not heard of for", age)};
}

void CheckInputs::appendRobotCauses(Time now, std::vector<Cause>& causes) {
  if (!started_) started_ = now;
  if (clock_stalls_) causes.emplace_back(Reason::kNoClock, "simulated time stands still");
  if (!joints_.outOfRange().empty()) {
    causes.emplace_back(Reason::kJointOutOfRange, joints_.outOfRange());
  }
  if (!joints_.twoPositions().empty()) {
    causes.emplace_back(Reason::kJointContradicted, joints_.twoPositions());
  }
  append(jointsCause(now), causes);
  for (std::size_t root = 0; root < roots_.size(); ++root) append(rootCause(now, root), causes);
}

void CheckInputs::appendSensorCauses(Time now, std::vector<Cause>& causes) {
  const bool joints_known = jointsCause(now).reason == Reason::kClear;
  for (std::size_t i = 0; i < sensors_.size(); ++i) {
    sensor_causes_.clear();
    sensors_[i].appendCauses({now, *started_, config_, joints_known}, sensor_causes_);
    if (!fits(i)) {
      sensor_causes_.emplace_back(Reason::kNoMap,
                                  "the area or cells of sensor '" + sensors_[i].name() +
                                      "' are not those of the others: set area_*, height_* and "
                                      "cell_size_m of all mappers alike");
    }
    if (sensors_[i].required()) {
      causes.insert(causes.end(), sensor_causes_.begin(), sensor_causes_.end());
    } else {
      outs_[i] = sensor_causes_.empty() ? "" : sensor_causes_.front().detail;
    }
  }
}

void CheckInputs::appendCauses(Time now, std::vector<Cause>& causes) {
  appendRobotCauses(now, causes);
  appendSensorCauses(now, causes);
  append(agreement_.cause(), causes);
  append(outside_, causes);
}

Cause CheckInputs::worst(Time now) {
  std::vector<Cause> causes;
  appendCauses(now, causes);
  if (maps_changed_ || !maps_.all()) unite(now);
  const auto worst = std::max_element(
      causes.begin(), causes.end(), [](const auto& a, const auto& b) { return b.isWorseThan(a); });
  return worst == causes.end() ? Cause() : *worst;
}

bool CheckInputs::placesRobot(Time now) {
  std::vector<Cause> causes;
  appendRobotCauses(now, causes);
  return causes.empty();
}

}  // namespace tccm
