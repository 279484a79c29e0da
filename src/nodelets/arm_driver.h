#pragma once

#include <control_msgs/FollowJointTrajectoryGoal.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "gate/gated_motion.h"
#include "gate/permission_gate.h"

namespace tccm {

/// Has an arm's own controller move it.
class ArmDriver {
 public:
  /// How the controller ended a motion by itself.
  struct End {
    bool is_reached = false;
    std::int32_t code = 0;  ///< of FollowJointTrajectoryResult
    std::string text = {};
  };

  ArmDriver() = default;
  ArmDriver(const ArmDriver&) = delete;
  ArmDriver& operator=(const ArmDriver&) = delete;
  virtual ~ArmDriver() = default;

  /// To be called now and then, also while nothing moves.
  virtual void keepInTouch(const Instant& /*now*/) {}
  /// Why it cannot move the arm, in one line; empty where it can.
  [[nodiscard]] virtual std::string objection(const Instant& now) = 0;
  /// @param goal whose tolerances the controller is to keep.
  virtual void begin(const GatedMotion& motion, const control_msgs::FollowJointTrajectoryGoal& goal,
                     const Instant& now) = 0;
  virtual void step(const GatedMotion& motion, const GatedMotion::Step& step,
                    const Instant& now) = 0;
  /// Nothing while the motion goes on.
  [[nodiscard]] virtual std::optional<End> end(const Instant& now) = 0;
  /// Stops the arm, whatever moves it, and forgets the motion. @param positions, velocities of its
  /// joints now; none: not known.
  virtual void hold(const std::vector<double>& positions, const std::vector<double>& velocities,
                    const Instant& now) = 0;
  /// They are known again: to be called after hold() without them, as long as the arm is held.
  virtual void stay(const std::vector<double>& /*positions*/,
                    const std::vector<double>& /*velocities*/) {}
};

}  // namespace tccm
