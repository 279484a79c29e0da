#pragma once

#include "check/approach_check.h"
#include "check/check_inputs.h"
#include "check/contact_judge.h"
#include "check/evidence_check.h"
#include "check/exemptions.h"
#include "check/governed_speed.h"
#include "check/keep_out.h"
#include "check/permission.h"
#include "check/trajectory_check.h"
#include "tccm_monitor/checker.h"

namespace tccm {

struct Checker::Config {
  CheckedRobot::Config pose;
  CheckInputs::Config inputs;
  Braking braking;
  ContactJudge::Config way;
  EvidenceCheck::Config evidence;
  GovernedSpeed::Config governed_speed;
  ApproachCheck::Config approach;
  CommandedTrajectories::Config trajectories;
  TrajectoryCheck::Config trajectory;
  Permission::Config permission;
  Exemptions::Config exemptions;
  KeepOut::Config keep_out;
  double clearance_radius_m = 0.2;

  void describe(ParameterTable& table);
  /// @throws ConfigError
  void validate() const {
    pose.validate();
    inputs.validate();
    keep_out.validate();
  }
};

}  // namespace tccm
