#include "robot/joint_states.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/line_of.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

constexpr double kFixedTolerance = 0.01;  // [rad, m]
constexpr double kMoving = 0.02;          // [rad/s, m/s]; less may be noise
constexpr double kSame = 0.01;            // [rad, m] between two positions that are one, rounded
constexpr double kSameMimic_rad = 0.05;
constexpr double kRounding = 1e-3;       // [rad, m] beyond a limit that drivers round to
constexpr double kCoarseStamp = 0.02;    // [s] that stamps may be rounded by
constexpr double kRelayLag = 0.2;        // [s] by which who relays joint states may be late
constexpr int kStepsToAndFro = 3;        // in turn; a jump that is taken back is none yet
constexpr double kStepBack = 1.0;        // [s] within which two histories are stepped between
constexpr double kJumpLasts = 0.05;      // [s] beyond the baseline that one jump looks like a speed
constexpr std::size_t kHistory = 6;      // samples without which there is no history
constexpr std::size_t kPublishers = 32;  // told apart
constexpr Duration kDoubt = std::chrono::seconds(2);  // that it lasts

}  // namespace

void JointStates::Config::describe(ParameterTable& table) {
  table.add("joint_gap_max_s", &gap_max_s, "s", {1e-3, 10.0},
            "joint positions are not interpolated across a longer gap");
  table.add("joint_velocity_baseline_s", &velocity_baseline_s, "s", {1e-3, 1.0},
            "positions so far apart are differentiated");
  table.add("limit_tolerance", &limit_tolerance, "rad, 0.1 m", {0.0, 10.0},
            "a joint further beyond its limits is a fault, one that is nearer is taken as it is; a "
            "tenth of the joint's range where that is more");
  table.add("joint_samples_max", &samples_max, "", {2.0, 1e5}, "positions kept of each joint");
}

JointStates::JointStates(const RobotModel& model, const Config& config)
    : config_(validated(config)),
      fixed_(model.fixedJoints()),
      rules_(rulesOf(model, config.limit_tolerance)),
      beyond_lower_(rules_.size(), false),
      beyond_upper_(rules_.size(), false),
      mimics_(mimicsOf(model)),
      contrary_(rules_.size(), 0.0) {
  for (std::size_t v = 0; v < rules_.size(); ++v) {
    index_[rules_[v].variable.name] = v;
    tracks_.emplace_back(config_.samples_max, model.turnsFreely(v));
  }
  snapshot_.positions.resize(rules_.size());
  snapshot_.velocities.resize(rules_.size());
  snapshot_.contrary_velocities.reserve(rules_.size());
}

void JointStates::reset() {
  for (JointTrack& track : tracks_) track.clear();
  last_message_.reset();
  contradicting_joint_.clear();
  contradiction_ = two_positions_ = out_of_range_ = {};
  limit_defect_.clear();
  beyond_lower_.assign(rules_.size(), false);
  beyond_upper_.assign(rules_.size(), false);
}

void JointStates::compareWithFixed(const std::string& name, double position, Time stamp) {
  const auto fixed = fixed_.find(name);
  if (fixed == fixed_.end()) return;
  if (!(std::abs(position - fixed->second) <= kFixedTolerance)) {
    contradicting_joint_ = name;
    contradiction_ = {lineOf("joint '%.100s' is published at %.3f, fixed_joints says %.3f",
                             name.c_str(), position, fixed->second),
                      stamp};
  } else if (contradicting_joint_ == name) {
    contradicting_joint_.clear();
    contradiction_.text.clear();
  }
}

std::uint8_t JointStates::numberOf(const std::string& publisher) {
  const auto found = std::find(publishers_.begin(), publishers_.end(), publisher);
  if (found == publishers_.end() && publishers_.size() == kPublishers) return 0;
  const auto number = static_cast<std::uint8_t>(found - publishers_.begin());
  if (found == publishers_.end()) publishers_.push_back(publisher);
  return number;
}

JointStates::Added JointStates::add(Time stamp, const std::vector<std::string>& names,
                                    const std::vector<double>& positions,
                                    const std::vector<double>& velocities,
                                    const std::string& publisher) {
  Added added;
  const Message message{stamp, names, positions, velocities, numberOf(publisher)};
  // Before any of it is looked at: what is wrong with one joint is not forgotten for another's
  // sake.
  if (beginsAnew(message)) reset();
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (!fixed_.empty() && i < positions.size()) {
      compareWithFixed(names[i], positions[i], stamp);
    }
    const auto found = index_.find(names[i]);
    if (found == index_.end()) continue;
    ++(addJoint(message, i, found->second) ? added.taken : added.refused);
  }
  last_message_ = last_message_ ? std::max(*last_message_, stamp) : stamp;
  if (!mimics_.empty()) lookForBrokenMimics(message);
  forgetOldDoubts();
  return added;
}

bool JointStates::beginsAnew(const Message& message) const {
  const Duration gap_max = fromSeconds(config_.gap_max_s);
  if (!last_message_ || *last_message_ - message.stamp <= gap_max) return false;
  return std::any_of(message.names.begin(), message.names.end(), [&](const std::string& name) {
    const auto found = index_.find(name);
    if (found == index_.end()) return false;
    const JointTrack& track = tracks_[found->second];
    return track.size() > 0 && track.newest(0).stamp - message.stamp > gap_max;
  });
}

bool JointStates::addJoint(const Message& message, std::size_t i, std::size_t joint) {
  JointTrack& track = tracks_[joint];
  const Time stamp = message.stamp;
  if (i >= message.positions.size() || !std::isfinite(message.positions[i])) return false;
  const double position = message.positions[i];
  const JointRule& rule = rules_[joint];
  if (std::abs(position) > kJointLargest || rule.beyond(position) > rule.limit_tolerance) {
    out_of_range_ = {rule.textOfPosition(position), stamp};
    return false;
  }
  if (track.size() > 0 && track.newest(0).stamp >= stamp) {
    lookForSecondPosition(message, i, joint);
    return false;
  }
  const double velocity = i < message.velocities.size() ? message.velocities[i]
                                                        : std::numeric_limits<double>::quiet_NaN();
  track.add({stamp, position, velocity, message.publisher});
  noteLimits(joint, position);
  lookForSpeed(joint);
  lookForTwoHistories(joint);
  return true;
}

void JointStates::noteLimits(std::size_t joint, double position) {
  const JointVariable& variable = rules_[joint].variable;
  const bool is_below = variable.lower && position < *variable.lower - kRounding;
  const bool is_above = variable.upper && position > *variable.upper + kRounding;
  if (is_below) beyond_lower_[joint] = true;
  if (is_above) beyond_upper_[joint] = true;
  if ((!is_below && !is_above) || !limit_defect_.empty()) return;
  limit_defect_ = lineOf(
      "joint '%.100s' is at %.4g %s, its limit is %.4g: the way ahead does not end there any more",
      variable.name.c_str(), position, rules_[joint].unit(),
      is_below ? *variable.lower : *variable.upper);
}

/// One jump of its position is no speed: encoders are set anew, simulations begin anew.
void JointStates::lookForSpeed(std::size_t joint) {
  JointTrack& track = tracks_[joint];
  const JointRule& rule = rules_[joint];
  const JointSample& newest = track.newest(0);
  if (std::abs(newest.velocity) > rule.speed_believed) {
    out_of_range_ = {rule.textOfSpeed("is said to move at", newest.velocity), newest.stamp};
  }
  const auto slope = track.differentiate(config_.velocity_baseline_s, config_.gap_max_s);
  const bool is_fast =
      slope.over_s >= config_.velocity_baseline_s && std::abs(slope.speed) > rule.speed_believed;
  if (!is_fast) return track.fast_since.reset();
  const bool goes_on = track.fast_since && track.fast_upwards == (slope.speed > 0.0);
  if (!goes_on) track.fast_since = newest.stamp;
  track.fast_upwards = slope.speed > 0.0;
  if (toSeconds(newest.stamp - *track.fast_since) < kJumpLasts + config_.velocity_baseline_s)
    return;
  out_of_range_ = {rule.textOfSpeed("changes its position by", slope.speed), newest.stamp};
}

std::string JointStates::placeText(std::size_t joint, const JointSample& sample) const {
  const std::string& publisher = publishers_[sample.publisher];
  const std::string by = publisher.empty() ? "" : " by " + publisher;
  return lineOf("at %.4g %s%.120s", sample.position, rules_[joint].unit(), by.c_str());
}

void JointStates::contradict(std::size_t joint, const JointSample& one, const JointSample& other,
                             Time stamp) {
  two_positions_ = {"joint '" + rules_[joint].variable.name + "' is " + placeText(joint, one) +
                        " and " + placeText(joint, other) + " at one time: let one node publish it",
                    stamp};
}

void JointStates::lookForSecondPosition(const Message& message, std::size_t i, std::size_t joint) {
  const JointTrack& track = tracks_[joint];
  const JointSample second{message.stamp, message.positions[i], 0.0, message.publisher};
  for (std::size_t k = 0; k < i && k < message.positions.size(); ++k) {
    if (message.names[k] != message.names[i]) continue;
    const JointSample first{message.stamp, message.positions[k], 0.0, message.publisher};
    if (std::abs(track.moved(first.position, second.position)) <= kSame) continue;
    return contradict(joint, first, second, message.stamp);
  }
  const JointSample* before = track.before(message.stamp);
  const auto known = track.at(message.stamp, config_.gap_max_s);
  if (!before || !known) return;
  const double reported = std::abs(before->velocity);
  const double speed = std::max(track.usualSpeed(), std::isnan(reported) ? 0.0 : reported);
  const double lag_s = before->stamp == message.stamp ? kCoarseStamp : kRelayLag;
  const double allowed = kSame + lag_s * std::min(speed, rules_[joint].speed_permitted);
  if (std::abs(track.moved(*known, second.position)) <= allowed) return;
  contradict(joint, {message.stamp, *known, 0.0, before->publisher}, second, message.stamp);
}

/// Two that publish a joint make it step to and fro. Who relays what another publishes is late, and
/// steps by what the joint moves meanwhile.
void JointStates::lookForTwoHistories(std::size_t joint) {
  JointTrack& track = tracks_[joint];
  if (track.size() < kHistory) return;
  const JointSample& from = track.newest(1);
  const JointSample& to = track.newest(0);
  const double permitted = rules_[joint].speed_permitted;
  const double dt = toSeconds(to.stamp - from.stamp);
  const double step = track.moved(from.position, to.position);
  if (std::abs(step) <= kSame + permitted * (dt + kCoarseStamp)) return;
  if (std::abs(step) <= kSame + permitted * dt + kRelayLag * track.usualSpeed()) return;
  const auto last = track.jump;
  track.jump = JointTrack::Jump{from, to, 1};
  if (!last || toSeconds(to.stamp - last->to.stamp) > kStepBack) return;
  const double step_before = track.moved(last->from.position, last->to.position);
  const bool is_back =
      step * step_before < 0.0 && std::abs(track.moved(last->from.position, to.position)) <
                                      0.5 * std::min(std::abs(step), std::abs(step_before));
  if (!is_back) return;
  track.jump->in_turn = last->in_turn + 1;
  if (track.jump->in_turn >= kStepsToAndFro) contradict(joint, from, to, to.stamp);
}

void JointStates::lookForBrokenMimics(const Message& message) {
  for (const MimicRule& mimic : mimics_) {
    const auto named = std::find(message.names.begin(), message.names.end(), mimic.name);
    const auto i = static_cast<std::size_t>(named - message.names.begin());
    const JointTrack& track = tracks_[mimic.variable];
    if (i >= message.positions.size() || !std::isfinite(message.positions[i])) continue;
    if (track.size() == 0) continue;
    const double position = message.positions[i];
    auto source = track.at(message.stamp, config_.gap_max_s);
    const double late_s = toSeconds(message.stamp - track.newest(0).stamp);
    if (!source && late_s > 0.0 && late_s <= config_.gap_max_s) source = track.newest(0).position;
    if (!source) continue;
    const double reported = std::abs(track.newest(0).velocity);
    const double speed = std::max(track.usualSpeed(), std::isnan(reported) ? 0.0 : reported);
    const double allowed = (mimic.slides ? kSame : kSameMimic_rad) +
                           kRelayLag * std::abs(mimic.multiplier) *
                               std::min(speed, rules_[mimic.variable].speed_permitted);
    if (std::abs(mimic.deviation(position, *source)) <= allowed) continue;
    two_positions_ = {
        lineOf("joint '%.100s' is published at %.4g, but as mimic of '%.100s' it is at %.4g %s: "
               "correct its driver or the URDF",
               mimic.name.c_str(), position, rules_[mimic.variable].variable.name.c_str(),
               mimic.multiplier * *source + mimic.offset, mimic.slides ? "m" : "rad"),
        message.stamp};
  }
}

void JointStates::forgetOldDoubts() {
  for (Doubt* doubt : {&contradiction_, &two_positions_, &out_of_range_}) {
    if (!doubt->text.empty() && *last_message_ - doubt->stamp > kDoubt) doubt->text.clear();
  }
}

std::vector<std::string> JointStates::missingJoints() const {
  std::vector<std::string> missing;
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    if (tracks_[i].size() == 0) missing.push_back(rules_[i].variable.name);
  }
  return missing;
}

void JointStates::lookForVelocityDefect(std::size_t joint) {
  const JointTrack& track = tracks_[joint];
  const JointSample& newest = track.newest(0);
  const auto tell = [&](const char* what) {
    velocity_defect_ = "joint '" + rules_[joint].variable.name + "' is published " + what;
  };
  if (!(std::abs(newest.velocity) <= kJointLargest)) return tell("without a velocity");
  // When a joint comes to rest its last velocity alone is 0.
  if (track.size() < 2 || newest.velocity != 0.0 || track.newest(1).velocity != 0.0) return;
  const JointSample& before = track.newest(1);
  const double way = std::abs(track.moved(before.position, newest.position));
  if (way > kMoving * toSeconds(newest.stamp - before.stamp)) {
    tell("with velocity 0 while it moves");
  }
}

void JointStates::findVelocity(std::size_t joint) {
  const JointTrack& track = tracks_[joint];
  // A wilder one is a fault, and would make a way ahead too long to be judged in time.
  const double most = rules_[joint].speed_believed;
  const auto slope = track.differentiate(config_.velocity_baseline_s, config_.gap_max_s);
  const double differentiated = std::clamp(slope.speed, -most, most);
  const bool is_reported = std::abs(track.newest(0).velocity) <= kJointLargest;
  const double reported = is_reported ? std::clamp(track.newest(0).velocity, -most, most) : 0.0;
  if (velocity_defect_.empty()) lookForVelocityDefect(joint);
  const bool more_reported = std::abs(reported) >= std::abs(differentiated);
  snapshot_.velocities[joint] = more_reported ? reported : differentiated;
  const double lesser = more_reported ? differentiated : reported;
  const bool is_contrary = reported * differentiated < 0.0 && std::abs(lesser) > kMoving &&
                           slope.over_s >= config_.velocity_baseline_s;
  contrary_[joint] = is_contrary ? lesser : snapshot_.velocities[joint];
  if (is_contrary) snapshot_.contrary_velocities.resize(rules_.size());
}

const JointSnapshot* JointStates::latest() {
  const auto isMissing = [](const JointTrack& track) { return track.size() == 0; };
  if (!last_message_ || std::any_of(tracks_.begin(), tracks_.end(), isMissing)) return nullptr;
  snapshot_.oldest = snapshot_.newest = *last_message_;
  snapshot_.oldest_joint = 0;
  snapshot_.contrary_velocities.clear();
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    if (tracks_[i].newest(0).stamp < snapshot_.oldest) snapshot_.oldest_joint = i;
    snapshot_.oldest = std::min(snapshot_.oldest, tracks_[i].newest(0).stamp);
    snapshot_.newest = std::max(snapshot_.newest, tracks_[i].newest(0).stamp);
    snapshot_.positions[i] = tracks_[i].newest(0).position;
    findVelocity(i);
  }
  if (!snapshot_.contrary_velocities.empty()) snapshot_.contrary_velocities = contrary_;
  snapshot_.beyond_lower = beyond_lower_;
  snapshot_.beyond_upper = beyond_upper_;
  return &snapshot_;
}

bool JointStates::at(Time stamp, std::vector<double>& positions) const {
  if (!contradiction_.text.empty() || !two_positions_.text.empty()) return false;
  positions.resize(tracks_.size());
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    const auto position = tracks_[i].at(stamp, config_.gap_max_s);
    if (!position) return false;
    positions[i] = *position;
  }
  return true;
}

std::optional<Time> JointStates::answersUntil() const {
  if (!missingJoints().empty() || !last_message_) return std::nullopt;
  Time until = tracks_.empty() ? *last_message_ : tracks_.front().newest(0).stamp;
  for (const JointTrack& track : tracks_) until = std::min(until, track.newest(0).stamp);
  return until;
}

}  // namespace tccm
