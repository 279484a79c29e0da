#pragma once

#include <ros/node_handle.h>

#include "gate/gate_config.h"
#include "gate/goal_rules.h"
#include "tccm_monitor/robot_model.h"

namespace tccm {

/// The rules of an arm's own controller, as it reads them from the parameter server.
/// @throws ConfigError also where the gate's configuration contradicts it: margins and docs reckon
/// with that.
[[nodiscard]] GoalRules::Config rulesOf(const ros::NodeHandle& node,
                                        const GateConfig::Controller& controller,
                                        const RobotModel& model);

}  // namespace tccm
