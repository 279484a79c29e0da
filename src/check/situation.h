#pragma once

#include <algorithm>
#include <vector>

#include "check/commanded_trajectories.h"
#include "check/halting.h"
#include "check/pose_check.h"
#include "check/surroundings.h"

namespace tccm {

/// How late a robot obeys and how it comes to rest: one for all who reckon with it.
struct Braking {
  double deceleration_mps2 = 2.0;
  double stop_duration_s = 0.0;
  double reaction_time_s = 0.02;
  double margin_max_m = 0.1;
  double latency_s = 0.0;  ///< of verdicts, as measured; no parameter

  void describe(ParameterTable& table);

  [[nodiscard]] BrakingWay way() const { return {deceleration_mps2, stop_duration_s}; }
  /// After which a verdict on joint states of that age has an effect.
  [[nodiscard]] double delay(double joints_age_s) const {
    return reaction_time_s + std::max(0.0, latency_s + joints_age_s);
  }
};

/// What there is to judge at one instant. Every pose in it was computed once, for all judges.
struct Situation {
  Time now;
  Surroundings around;
  const JointSnapshot& joints;
  CommandedTrajectories& commanded;  ///< has found where the robot goes until the horizon
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
