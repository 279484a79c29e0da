#include "robot/joint_states.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

constexpr double kFixedTolerance = 0.01;  // [rad, m]
constexpr double kTurn = 2.0 * M_PI;
constexpr double kMoving = 0.02;  // [rad/s, m/s]; less may be noise
constexpr double kLargest = 1e6;  // [rad, m, 1/s]; beyond it is no joint's position or velocity

}  // namespace

void JointStates::Config::describe(ParameterTable& table) {
  table.add("joint_gap_max_s", &gap_max_s, "s", {1e-3, 10.0},
            "joint positions are not interpolated across a longer gap");
  table.add("joint_velocity_baseline_s", &velocity_baseline_s, "s", {1e-3, 1.0},
            "positions so far apart are differentiated");
  table.add("joint_samples_max", &samples_max, "", {2.0, 1e5}, "positions kept of each joint");
}

JointStates::JointStates(const RobotModel& model, const Config& config)
    : config_(validated(config)), fixed_(model.fixedJoints()) {
  for (const JointVariable& variable : model.variables()) {
    index_[variable.name] = names_.size();
    turns_freely_.push_back(model.turnsFreely(names_.size()));
    names_.push_back(variable.name);
  }
  tracks_.resize(names_.size());
  for (Track& track : tracks_) track.ring.resize(config_.samples_max);
  snapshot_.positions.resize(names_.size());
  snapshot_.velocities.resize(names_.size());
}

void JointStates::reset() {
  for (Track& track : tracks_) track.count = track.next = 0;
  last_message_.reset();
  contradicting_joint_.clear();
  contradiction_.clear();
}

void JointStates::compareWithFixed(const std::string& name, double position) {
  const auto fixed = fixed_.find(name);
  if (fixed == fixed_.end()) return;
  if (!(std::abs(position - fixed->second) <= kFixedTolerance)) {
    char text[200];
    std::snprintf(text, sizeof text, "joint '%.100s' is published at %.3f, fixed_joints says %.3f",
                  name.c_str(), position, fixed->second);
    contradicting_joint_ = name;
    contradiction_ = text;
  } else if (contradicting_joint_ == name) {
    contradicting_joint_.clear();
    contradiction_.clear();
  }
}

void JointStates::Track::add(const Sample& sample) {
  ring[next] = sample;
  next = (next + 1) % ring.size();
  count = std::min(count + 1, ring.size());
}

JointStates::Added JointStates::add(Time stamp, const std::vector<std::string>& names,
                                    const std::vector<double>& positions,
                                    const std::vector<double>& velocities) {
  Added added;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (!fixed_.empty() && i < positions.size()) compareWithFixed(names[i], positions[i]);
    const auto found = index_.find(names[i]);
    if (found == index_.end()) continue;
    Track& track = tracks_[found->second];
    if (track.count > 0 && track.newest(0).stamp - stamp > fromSeconds(config_.gap_max_s)) reset();
    const bool usable = i < positions.size() && std::abs(positions[i]) <= kLargest &&
                        (track.count == 0 || track.newest(0).stamp < stamp);
    if (!usable) {
      ++added.refused;
      continue;
    }
    const double velocity =
        i < velocities.size() ? velocities[i] : std::numeric_limits<double>::quiet_NaN();
    track.add({stamp, positions[i], velocity});
    ++added.taken;
  }
  last_message_ = last_message_ ? std::max(*last_message_, stamp) : stamp;
  return added;
}

std::vector<std::string> JointStates::missingJoints() const {
  std::vector<std::string> missing;
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    if (tracks_[i].count == 0) missing.push_back(names_[i]);
  }
  return missing;
}

double JointStates::moved(std::size_t joint, double from, double to) const {
  return turns_freely_[joint] ? std::remainder(to - from, kTurn) : to - from;
}

double JointStates::differentiate(std::size_t joint) const {
  const Track& track = tracks_[joint];
  const Sample& newest = track.newest(0);
  double differentiated = 0.0;
  for (std::size_t k = 1; k < track.count; ++k) {
    const double dt = toSeconds(newest.stamp - track.newest(k).stamp);
    if (dt > std::max(config_.gap_max_s, config_.velocity_baseline_s) && k > 1) break;
    differentiated = moved(joint, track.newest(k).position, newest.position) / dt;
    if (dt >= config_.velocity_baseline_s) break;
  }
  return differentiated;
}

void JointStates::lookForVelocityDefect(std::size_t joint) {
  const Track& track = tracks_[joint];
  const Sample& newest = track.newest(0);
  if (!(std::abs(newest.velocity) <= kLargest)) {
    velocity_defect_ = "joint '" + names_[joint] + "' is published without a velocity";
    return;
  }
  // When a joint comes to rest its last velocity alone is 0.
  if (track.count < 2 || newest.velocity != 0.0 || track.newest(1).velocity != 0.0) return;
  const Sample& before = track.newest(1);
  const double way = std::abs(moved(joint, before.position, newest.position));
  if (way > kMoving * toSeconds(newest.stamp - before.stamp)) {
    velocity_defect_ = "joint '" + names_[joint] + "' is published with velocity 0 while it moves";
  }
}

double JointStates::velocityOf(std::size_t joint) {
  const Track& track = tracks_[joint];
  const double differentiated = differentiate(joint);
  const bool is_reported = std::abs(track.newest(0).velocity) <= kLargest;
  const double reported = is_reported ? track.newest(0).velocity : 0.0;
  if (velocity_defect_.empty()) lookForVelocityDefect(joint);
  return std::abs(reported) >= std::abs(differentiated) ? reported : differentiated;
}

const JointSnapshot* JointStates::latest() {
  if (!missingJoints().empty() || !last_message_) return nullptr;
  snapshot_.oldest = snapshot_.newest = *last_message_;
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    snapshot_.oldest = std::min(snapshot_.oldest, tracks_[i].newest(0).stamp);
    snapshot_.newest = std::max(snapshot_.newest, tracks_[i].newest(0).stamp);
    snapshot_.positions[i] = tracks_[i].newest(0).position;
    snapshot_.velocities[i] = velocityOf(i);
  }
  return &snapshot_;
}

bool JointStates::interpolate(std::size_t joint, Time stamp, double& position) const {
  const Track& track = tracks_[joint];
  for (std::size_t k = 0; k < track.count; ++k) {
    const Sample& before = track.newest(k);
    if (before.stamp > stamp) continue;
    position = before.position;
    if (before.stamp == stamp) return true;
    if (k == 0) return false;
    const Sample& after = track.newest(k - 1);
    const double gap = toSeconds(after.stamp - before.stamp);
    const double u = toSeconds(stamp - before.stamp) / gap;
    position += u * moved(joint, before.position, after.position);
    return gap <= config_.gap_max_s;
  }
  return false;
}

bool JointStates::at(Time stamp, std::vector<double>& positions) const {
  if (!contradiction_.empty()) return false;
  positions.resize(tracks_.size());
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    if (!interpolate(i, stamp, positions[i])) return false;
  }
  return true;
}

std::optional<Time> JointStates::answersUntil() const {
  if (!missingJoints().empty() || !last_message_) return std::nullopt;
  Time until = tracks_.empty() ? *last_message_ : tracks_.front().newest(0).stamp;
  for (const Track& track : tracks_) until = std::min(until, track.newest(0).stamp);
  return until;
}

}  // namespace tccm
