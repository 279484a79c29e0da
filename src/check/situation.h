#pragma once

#include <vector>

#include "check/braking.h"
#include "check/commanded_trajectories.h"
#include "check/pose_check.h"

namespace tccm {

/// What there is to judge at one instant. Every pose in it was computed once, for all judges.
struct Situation {
  Time now;
  const CuboidMap& map;
  const JointSnapshot& joints;
  const Posture& posture;            ///< where the robot is
  const Ways& ways;                  ///< where it goes until the horizon
  CommandedTrajectories& commanded;  ///< what those rest on
  const PoseCheck& check_here;       ///< at the present pose
  const PoseCheck& check_ahead;      ///< at the end of the way
  const PoseFindings& here;          ///< what they found
  const PoseFindings& ahead;
  const Braking& braking;
  bool known;            ///< the input is whole and fresh
  double applied_scale;  ///< of the permission that the robot obeys
};

/// What speaks against moving, from all judges.
using Causes = std::vector<Cause>;

}  // namespace tccm
