#pragma once

#include <memory>

#include "check/situation.h"
#include "support/checked_robot.h"

namespace tccm::test {

/// Situations of a robot in which nothing was found, and nothing is commanded.
class MadeSituation {
 public:
  explicit MadeSituation(const std::shared_ptr<const RobotModel>& model)
      : check_(checked(model), 1.5),
        kinematics_(model),
        ways_(model->variables().size(), 0.5),
        commanded_(model, {}) {}

  Situation at(Time now, const CuboidMap& map, const JointSnapshot& joints,
               double applied_scale = 1.0) {
    const Posture& posture = kinematics_.update(joints.positions, {Pose::Identity()});
    return {now,    map,       joints,    posture, ways_, commanded_,   check_,
            check_, findings_, findings_, braking, true,  applied_scale};
  }

  Braking braking;

 private:
  PoseCheck check_;
  Kinematics kinematics_;
  Ways ways_;
  CommandedTrajectories commanded_;
  PoseFindings findings_;
};

}  // namespace tccm::test
