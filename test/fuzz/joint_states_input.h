#pragma once

#include <array>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "fuzz/fuzzed_checker.h"

/// What the fuzz target of joint states and the test of its corpus do with an input: message after
/// message of some joints, among them NaN, wrong units, two positions at a time and stamps that
/// jump, and a check after each.
namespace tccm::test {

/// One message of joint states.
struct JointMessage {
  Time stamp;
  std::vector<std::string> names;
  std::vector<double> positions;
  std::vector<double> velocities;
  std::string publisher;
};

inline JointMessage fuzzedJoints(ByteReader& bytes, Time now) {
  JointMessage message;
  const std::uint8_t kind = bytes.byte();
  message.stamp = now;
  if (kind >= 0xc0U) message.stamp = now + bytes.step(-40, 0);
  message.names = {"slide", "turn"};
  if ((kind & 3U) == 3U) {
    message.names.clear();
    for (std::size_t i = bytes.count(4); i > 0; --i) {
      message.names.push_back(
          bytes.oneOf<const char*>({"slide", "turn", "follow", "nobody", "slide"}));
    }
  }
  for (std::size_t i = 0; i < message.names.size(); ++i) {
    message.positions.push_back(bytes.number(-0.5, 1.0));
    if ((kind & 4U) != 0) message.velocities.push_back(bytes.number(-1.0, 1.0));
  }
  if (bytes.seldom() && !message.positions.empty()) message.positions.pop_back();
  if ((kind & 8U) != 0) message.publisher = bytes.oneOf<const char*>({"/one", "/two"});
  return message;
}

/// What may be known of joints by the rules of docs/failures.md, in plain words: no more than was
/// said of each, and nothing while it is in doubt.
class JointWitness {
 public:
  JointWitness() : limits_{{{"slide", -0.5 - 0.15, 1.0 + 0.15, 5.0}, {"turn", -1e6, 1e6, 100.0}}} {}

  void hear(Time now, const JointMessage& message) {
    if (message.stamp - now > std::chrono::milliseconds(100)) return;  // future_max_s
    // Time may have begun anew: what was in doubt before is no more.
    if (newest_ && *newest_ - message.stamp > kGap) doubt_.reset();
    newest_ = newest_ ? std::max(*newest_, message.stamp) : message.stamp;
    if (doubt_ && *newest_ - *doubt_ > kDoubtLasts) doubt_.reset();
    for (std::size_t j = 0; j < limits_.size(); ++j) hear(message, j);
  }
  /// Whether the robot may be known to be somewhere.
  [[nodiscard]] bool mayBeKnown(Time now) const {
    if (doubt_) return false;
    for (const std::optional<Time>& heard : heard_) {
      if (!heard || now - *heard > kGap) return false;  // joint_timeout_s is as long
    }
    return true;
  }
  [[nodiscard]] bool wasSaid(std::size_t joint, double position) const {
    return said_[joint].count(position) > 0;
  }

 private:
  struct Limits {
    const char* name;
    double lowest, highest;  ///< beyond them is a fault
    double fastest;
  };
  static constexpr Duration kGap = std::chrono::milliseconds(100);
  static constexpr Duration kDoubtLasts = std::chrono::milliseconds(1999);

  void hear(const JointMessage& message, std::size_t j) {
    const Limits& limits = limits_[j];
    std::optional<double> first;
    for (std::size_t i = 0; i < std::min(message.names.size(), message.positions.size()); ++i) {
      const double position = message.positions[i];
      if (message.names[i] != limits.name || !std::isfinite(position)) continue;
      if (position < limits.lowest - 1e-9 || position > limits.highest + 1e-9) {
        doubt_ = message.stamp;
        continue;
      }
      said_[j].insert(position);
      heard_[j] = heard_[j] ? std::max(*heard_[j], message.stamp) : message.stamp;
      const double other = first.value_or(position);
      const double apart = j == 0 ? position - other : std::remainder(position - other, 2.0 * M_PI);
      if (std::abs(apart) > 0.01 + 1e-9) doubt_ = message.stamp;
      first = other;
    }
  }

  std::array<Limits, 2> limits_;
  std::array<std::optional<Time>, 2> heard_;  ///< the newest stamp that it was said with
  std::array<std::set<double>, 2> said_;
  std::optional<Time> newest_;
  std::optional<Time> doubt_;  ///< stamp of a message that no healthy robot sends
};

inline void requireSnapshot(const JointSnapshot& joints, const JointWitness& witness,
                            const RobotModel& model) {
  for (std::size_t j = 0; j < 2; ++j) {
    const std::size_t v = variableOf(model, j == 0 ? "slide" : "turn");
    promise(witness.wasSaid(j, joints.positions.at(v)), "a joint is where nobody said it was");
    promise(std::abs(joints.velocities.at(v)) <= (j == 0 ? 5.0 : 100.0), "a velocity is too large");
  }
  promise(joints.oldest <= joints.newest, "the oldest is newer than the newest");
}

inline void runJointStates(const std::string& input) {
  ByteReader bytes(input);
  const auto robot = fuzzedRobot();
  Checker checker(robot, fuzzedChecker());
  checker.setRootPose(0, Time(), Pose::Identity(), true);
  CuboidMap map = fuzzedMap();
  addCuboids(bytes, 3, map);
  JointWitness witness;
  Time now{std::chrono::seconds(100)};
  std::uint32_t serial = 1;
  for (int i = 0; i < 40 && !bytes.isEmpty(); ++i) {
    const Duration step = bytes.step(1, 30);
    now += std::clamp<Duration>(step, Duration(0), std::chrono::seconds(3));
    checker.setMap(now, seenAt(map, now, ++serial));
    const JointMessage message = fuzzedJoints(bytes, now);
    const AddedJoints added =
        checker.addJoints(now, message.stamp, message.names, message.positions, message.velocities,
                          message.publisher);
    promise(added.taken + added.refused <= message.names.size(), "joints are miscounted");
    witness.hear(now, message);
    const Verdict& verdict = checker.check(now);
    requireVerdict(verdict);
    promise(witness.mayBeKnown(now) || verdict.stop, "it goes though joints are not known");
    promise(witness.mayBeKnown(now) || !verdict.known, "it knows what nobody said");
    const JointSnapshot* joints = checker.inputs().joints();
    if (joints) requireSnapshot(*joints, witness, *robot);
    if (verdict.placed) requireContacts(verdict, *checker.map(), *robot, joints->positions);
  }
}

/// What joint states and the verdicts on them broke of their promises, or nothing.
inline std::string jointStatesDefect(const std::string& input) {
  return brokenPromise([&] { runJointStates(input); });
}

}  // namespace tccm::test
