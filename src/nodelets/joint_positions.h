#pragma once

#include <sensor_msgs/JointState.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "tccm_monitor/time.h"

namespace tccm {

/// Where the joints were when they were heard of last, by name. Bounded: only those that are asked
/// about are kept.
class JointPositions {
 public:
  struct Joint {
    double position = 0.0, velocity = 0.0;  ///< [rad or m], per second
    Time stamp;
    bool is_known = false;  ///< both
    bool was_heard = false;
    bool tells_velocity = false;  ///< else it is differentiated
  };

  /// @return where that joint is noted from now on; the place stays.
  [[nodiscard]] const Joint* watch(const std::string& name) { return &joints_[name]; }

  /// Values that are not finite, older than what is known, or stamped in the future say nothing:
  /// what is known grows old. A joint whose velocity nobody tells is known with its second
  /// position.
  void hear(const sensor_msgs::JointState& message, Time stamp, Time now) {
    if (stamp - now > kFutureMax) return;
    const std::size_t count = std::min(message.name.size(), message.position.size());
    for (std::size_t i = 0; i < count; ++i) {
      const auto found = joints_.find(message.name[i]);
      if (found == joints_.end() || !std::isfinite(message.position[i])) continue;
      Joint& joint = found->second;
      if (joint.was_heard && stamp <= joint.stamp) continue;
      joint.tells_velocity = i < message.velocity.size() && std::isfinite(message.velocity[i]);
      joint.is_known = joint.tells_velocity || joint.was_heard;
      if (joint.tells_velocity) {
        joint.velocity = message.velocity[i];
      } else if (joint.was_heard) {
        joint.velocity = (message.position[i] - joint.position) / toSeconds(stamp - joint.stamp);
      }
      joint.position = message.position[i];
      joint.stamp = stamp;
      joint.was_heard = true;
    }
  }

  /// Where joints are now, if they went on as they were going. @param age_max of what is known.
  /// @return whether that is known of all; else both are left empty.
  [[nodiscard]] static bool expect(const std::vector<const Joint*>& joints, Time now,
                                   double age_max_s, std::vector<double>& positions,
                                   std::vector<double>& velocities) {
    positions.clear();
    velocities.clear();
    for (const Joint* joint : joints) {
      const double age_s = toSeconds(now - joint->stamp);
      if (!joint->is_known || age_s > age_max_s) {
        positions.clear();
        velocities.clear();
        return false;
      }
      positions.push_back(joint->position + joint->velocity * std::max(age_s, 0.0));
      velocities.push_back(joint->velocity);
    }
    return true;
  }

  /// Time jumped back: nothing is known.
  void clear() {
    for (auto& [name, joint] : joints_) joint = Joint();
  }

 private:
  static constexpr Duration kFutureMax = std::chrono::milliseconds(50);

  std::map<std::string, Joint> joints_;
};

}  // namespace tccm
