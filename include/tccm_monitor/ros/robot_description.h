#pragma once

#include <ros/node_handle.h>

#include <memory>
#include <string>

#include "tccm_monitor/robot/robot_model.h"

namespace tccm {

/// The URDF under robot_description, searched upwards from the node's namespace.
/// @throws ConfigError where there is none.
[[nodiscard]] std::string readRobotDescription(const ros::NodeHandle& node);

}  // namespace tccm
