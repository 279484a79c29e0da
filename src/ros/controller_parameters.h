#pragma once

#include <yaml-cpp/yaml.h>

#include <string>

#include "gate/goal_rules.h"
#include "tccm_monitor/robot_model.h"

namespace tccm {

/// What an arm's JointTrajectoryController reads in its namespace: `joints`, `constraints`,
/// `allow_partial_joints_goal` and `stop_trajectory_duration`, with its defaults. What else is
/// there is not looked at.
struct ControllerParameters {
  GoalRules::Config rules;
  double stop_duration_s = 0.0;

  /// @param parameters as parametersOf() reads them. @param name of the controller, for errors.
  /// @throws ConfigError naming the key, also for a joint that the model has not.
  [[nodiscard]] static ControllerParameters from(const YAML::Node& parameters,
                                                 const std::string& name, const RobotModel& model);
};

}  // namespace tccm
