#pragma once

#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <sensor_msgs/JointState.h>
#include <sensor_msgs/LaserScan.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace tccm::test {

using Nanoseconds = std::int64_t;
using Positions = std::map<std::string, double>;  ///< of joints [rad or m]

/// What a bag says of a robot's joints, every message of which names them all, and of its scans.
class RecordedMotion {
 public:
  struct State {
    Nanoseconds stamp;
    Positions positions;
    Positions velocities;  ///< as reported [1/s]
  };

  RecordedMotion(const std::string& path, const std::string& joints_topic,
                 const std::string& scan_topic) {
    const rosbag::Bag bag(path);
    rosbag::View view(bag, rosbag::TopicQuery(std::vector<std::string>{joints_topic, scan_topic}));
    for (const rosbag::MessageInstance& message : view) {
      if (const auto joints = message.instantiate<sensor_msgs::JointState>()) add(*joints);
      if (const auto scan = message.instantiate<sensor_msgs::LaserScan>()) {
        scans_.push_back(static_cast<Nanoseconds>(scan->header.stamp.toNSec()));
      }
    }
  }

  [[nodiscard]] const std::vector<State>& states() const { return states_; }
  /// Stamps of the scans as they come.
  [[nodiscard]] const std::vector<Nanoseconds>& scans() const { return scans_; }

  /// The index of the state with that stamp.
  [[nodiscard]] std::optional<std::size_t> stateAt(Nanoseconds stamp) const {
    const auto found = firstFrom(stamp);
    if (found == states_.end() || found->stamp != stamp) return std::nullopt;
    return static_cast<std::size_t>(found - states_.begin());
  }

  /// A joint's position at any time, on the line between the states before and after.
  [[nodiscard]] double interpolated(const std::string& joint, Nanoseconds stamp) const {
    const auto after = firstFrom(stamp);
    if (after == states_.end()) return states_.back().positions.at(joint);
    if (after == states_.begin()) return after->positions.at(joint);
    const auto before = after - 1;
    const double share = static_cast<double>(stamp - before->stamp) /
                         static_cast<double>(after->stamp - before->stamp);
    return (1.0 - share) * before->positions.at(joint) + share * after->positions.at(joint);
  }

  /// The larger of the reported velocity and the way since the last state that is a baseline older.
  [[nodiscard]] double velocity(std::size_t state, const std::string& joint,
                                Nanoseconds baseline) const {
    const State& now = states_[state];
    const double reported = now.velocities.at(joint);
    std::size_t past = state;
    while (past > 0 && now.stamp - states_[past].stamp < baseline) --past;
    if (past == state) return reported;
    const double way = now.positions.at(joint) - states_[past].positions.at(joint);
    const double differentiated =
        way / (1e-9 * static_cast<double>(now.stamp - states_[past].stamp));
    return std::abs(reported) >= std::abs(differentiated) ? reported : differentiated;
  }

 private:
  void add(const sensor_msgs::JointState& message) {
    State state{static_cast<Nanoseconds>(message.header.stamp.toNSec()), {}, {}};
    for (std::size_t i = 0; i < message.name.size(); ++i) {
      state.positions[message.name[i]] = message.position[i];
      state.velocities[message.name[i]] = message.velocity[i];
    }
    states_.push_back(std::move(state));
  }

  [[nodiscard]] std::vector<State>::const_iterator firstFrom(Nanoseconds stamp) const {
    return std::lower_bound(states_.begin(), states_.end(), stamp,
                            [](const State& state, Nanoseconds t) { return state.stamp < t; });
  }

  std::vector<State> states_;
  std::vector<Nanoseconds> scans_;
};

/// The oldest scan in the window, one for each scan: the window holds so many tilt periods once one
/// has been measured, and before that every scan. A period lies between two turning points of the
/// same kind; the tilt has turned once it has come back by the hysteresis; where it was first seen
/// is no turning point.
inline std::vector<std::size_t> oldestScans(const RecordedMotion& motion, const std::string& joint,
                                            double tilt_periods, double hysteresis_rad) {
  const std::vector<Nanoseconds>& scans = motion.scans();
  std::map<int, Nanoseconds> turned;  // by its kind: up or down
  std::vector<std::size_t> oldest;
  Nanoseconds period = 0, extreme_stamp = scans.front();
  double extreme = motion.interpolated(joint, scans.front());
  int direction = 0;
  for (const Nanoseconds stamp : scans) {
    const double tilt = motion.interpolated(joint, stamp);
    const double on = tilt - extreme;
    if (std::abs(on) > hysteresis_rad && direction * on <= 0.0) {
      if (direction != 0 && turned.count(direction) > 0) {
        period = std::max(period, extreme_stamp - turned[direction]);
      }
      if (direction != 0) turned[direction] = extreme_stamp;
      direction = on > 0.0 ? 1 : -1;
    }
    if (direction * on >= 0.0 && direction != 0) {
      extreme = tilt;
      extreme_stamp = stamp;
    }
    std::size_t first = oldest.empty() ? 0 : oldest.back();
    const double window = tilt_periods * static_cast<double>(period);
    while (period > 0 && static_cast<double>(stamp - scans[first]) > window) ++first;
    oldest.push_back(first);
  }
  return oldest;
}

}  // namespace tccm::test
