#include "check/check_inputs.h"

#include <algorithm>

#include "base/duration_text.h"
#include "base/line_of.h"

namespace tccm {
namespace {

constexpr const char* kFrameChanged = "frame_changed";
constexpr Duration kFrameChangeLasts = std::chrono::seconds(2);

std::string ageText(const std::string& what, Duration age) {
  return what + " " + durationText(age);
}

/// What the sweep takes, for people: 0.02 s is no tilt.
std::string periodText(const CuboidMap& map) {
  if (map.look_period <= Duration::zero()) return "";
  return ", which takes " + durationText(map.look_period);
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

/// What a fault that keeps all scans out of the map is called.
Reason reasonOf(const std::string& dropped) {
  if (dropped == "blind") return Reason::kBlind;
  if (dropped == "future_stamp") return Reason::kFuture;
  if (dropped == "no_transform" || dropped == "transform_gap") return Reason::kNoTransform;
  return Reason::kNoMap;
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
            "age of the root's pose in the fixed frame");
  table.add("scan_timeout_periods", &scan_timeout_periods, "periods", {1.0, 100.0},
            "without a new map, in measured scan periods");
  table.add("map_age_max_s", &map_age_max_s, "s", {0.001, 10.0},
            "from the newest scan's stamp to the check");
  table.add(
      "self_filter_fraction_max", &self_filter_fraction_max, "", {0.1, 1.0},
      "share of the returns inside the area that may be taken for the robot, over a period of "
      "the tilt, where 50 a scan or more lie inside; above it the sensor is blind");
  table.add("future_max_s", &future_max_s, "s", {0.0, 10.0},
            "a scan or joint state may lead the check by this");
  table.add("transform_future_max_s", &transform_future_max_s, "s", {0.0, 10.0},
            "the root's pose may lead it by this: many publishers date ahead");
  agreement.describe(table);
}

CheckInputs::CheckInputs(std::shared_ptr<const RobotModel> model, const Config& config)
    : model_(std::move(model)),
      config_(validated(config)),
      joints_(*model_, config.joints),
      agreement_(model_, config.agreement),
      roots_(model_->roots().size()),
      T_fixed_roots_(model_->roots().size(), Pose::Identity()) {}

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

void CheckInputs::addScanReport(Time now, const ScanReport& report) {
  using Outcome = ScanReport::Outcome;
  if (report.outcome == Outcome::kWaiting) report_arrival_ = now;
  if (report.outcome == Outcome::kAssembled) assembled_ = now;
  if (report.outcome == Outcome::kWaiting) return;
  last_report_ = report;
  if (report.outcome == Outcome::kAssembled) self_link_ = report.self_link;
  if (report.dropped != kFrameChanged) return;
  frame_changed_ = now;
  frame_change_ = report.detail;
}

void CheckInputs::setMap(Time now, std::shared_ptr<const CuboidMap> map) {
  if (map_ && map->stamp > map_->stamp) {
    const double period = toSeconds(map->stamp - map_->stamp);
    // One pause must not teach it to be patient.
    scan_period_s_ =
        scan_period_s_ ? 0.9 * *scan_period_s_ +
                             0.1 * std::min(period, config_.scan_timeout_periods * *scan_period_s_)
                       : period;
  }
  // The same map again is no news of the sensor; what it was told to forget may be.
  const bool is_news = !map_ || map->stamp != map_->stamp || map->serial != map_->serial;
  map_ = std::move(map);
  if (is_news) map_arrival_ = now;
}

void CheckInputs::reset() {
  joints_.reset();
  agreement_.reset();
  map_.reset();
  scan_period_s_.reset();
  report_arrival_.reset();
  assembled_.reset();
  last_report_ = {};
  frame_changed_.reset();
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

Duration CheckInputs::silenceMax() const {
  if (!scan_period_s_) return fromSeconds(config_.map_age_max_s);
  return fromSeconds(
      std::min(config_.scan_timeout_periods * *scan_period_s_, config_.map_age_max_s));
}

bool CheckInputs::scansCome(Time now) const {
  return report_arrival_ && now - *report_arrival_ <= silenceMax();
}

Cause CheckInputs::silenceCause(Time now) const {
  if (report_arrival_ && !scansCome(now)) {
    return {Reason::kNoMap, ageText("no scan for", now - *report_arrival_)};
  }
  const Duration silence = now - (map_ ? map_arrival_ : *started_);
  if (!report_arrival_) return {Reason::kNoMap, ageText("no scan was mapped for", silence)};
  const std::string &dropped = last_report_.dropped, &detail = last_report_.detail;
  if (!dropped.empty()) {
    return {reasonOf(dropped), ageText("scans are dropped (" + dropped + ") for", silence) +
                                   (detail.empty() ? "" : ": " + detail)};
  }
  return {Reason::kNoMap, ageText("scans come, but none was mapped for", silence)};
}

Cause CheckInputs::mapCause(Time now) {
  if (!map_) {
    if (within(now, config_.map_age_max_s)) return {Reason::kInit, "waiting for the first scan"};
    return silenceCause(now);
  }
  const Duration age = now - map_->stamp, age_max = fromSeconds(config_.map_age_max_s);
  if (-age > fromSeconds(config_.future_max_s)) {
    return {Reason::kFuture, ageText("the newest scan is stamped in the future, by", -age)};
  }
  // Scans that wait for transforms may wait as long as these may be missing; blind ones may not.
  const std::string& dropped = last_report_.dropped;
  const bool lacks_transforms = dropped.empty() || reasonOf(dropped) == Reason::kNoTransform;
  const bool waits = scansCome(now) && lacks_transforms &&
                     !(assembled_ && *assembled_ - map_arrival_ > silenceMax());
  if (now - map_arrival_ > silenceMax() && !waits) return silenceCause(now);
  if (age > age_max) {
    // Scans may wait for joint states as well.
    if (waits && jointsCause(now).reason == Reason::kClear) {
      return {Reason::kNoTransform,
              ageText("scans wait for transforms; the newest in the map is older than", age_max)};
    }
    return {Reason::kMapLate, ageText("the newest scan in the map is older than", age_max)};
  }
  if (map_->overflowed) return {Reason::kMapOverflow, "points were left out of the map"};
  if (map_->tilt_stopped) {
    return {Reason::kSweepIncomplete, "the sensor's tilt stands still, or does not turn in time"};
  }
  if (!map_->complete) {
    return {Reason::kInit, "the map does not hold a whole sweep yet" + periodText(*map_)};
  }
  return {};
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

void CheckInputs::appendSensorCauses(Time now, std::vector<Cause>& causes) const {
  if (frame_changed_ && now - *frame_changed_ <= kFrameChangeLasts) {
    causes.emplace_back(Reason::kFrameChanged, frame_change_);
  }
  if (map_ && map_->self_share && *map_->self_share > config_.self_filter_fraction_max) {
    causes.emplace_back(
        Reason::kBlind,
        lineOf("the self filter takes %.0f %% of what lies inside the area, at most %.0f %% are "
               "believed (self_filter_fraction_max); most of it for '%.100s': see whether it is "
               "described too large",
               100.0 * *map_->self_share, 100.0 * config_.self_filter_fraction_max,
               self_link_.c_str()),
        self_link_);
  }
}

void CheckInputs::appendCauses(Time now, std::vector<Cause>& causes) {
  appendRobotCauses(now, causes);
  appendSensorCauses(now, causes);
  append(agreement_.cause(), causes);
  append(mapCause(now), causes);
  append(outside_, causes);
}

Cause CheckInputs::worst(Time now) {
  std::vector<Cause> causes;
  appendCauses(now, causes);
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
