#pragma once

#include <memory>

#include "check/situation.h"
#include "support/checked_robot.h"

namespace tccm::test {

/// Situations of a robot in which nothing was found, and nothing is commanded.
class MadeSituation {
 public:
  explicit MadeSituation(const std::shared_ptr<const RobotModel>& model)
      : check_(checked(model), 1.5), commanded_(model, {}) {}

  Situation at(Time now, const CuboidMap& map, const JointSnapshot& joints,
               double applied_scale = 1.0) {
    check_.place(joints.positions, {Pose::Identity()});
    return {now,       map,       joints,  commanded_, check_,       check_,
            findings_, findings_, braking, true,       applied_scale};
  }

  Braking braking;

 private:
  PoseCheck check_;
  CommandedTrajectories commanded_;
  PoseFindings findings_;
};

}  // namespace tccm::test
