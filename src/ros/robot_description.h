#pragma once

#include <ros/node_handle.h>

#include <memory>
#include <string>
#include <vector>

#include "tccm_monitor/robot_model.h"

namespace tccm {

/// The URDF under robot_description, searched upwards from the node's namespace.
/// @throws ConfigError where there is none.
[[nodiscard]] std::string readRobotDescription(const ros::NodeHandle& node);

/// The robot as all nodelets of this process see it: read once, from robot_description and from
/// `monitored_robot` in the node's namespace. Logs what of the robot is not watched.
/// @throws ConfigError
[[nodiscard]] std::shared_ptr<const RobotModel> sharedRobotModel(const ros::NodeHandle& node);

/// What a person should know of a model: links that are not watched, fits that could not be kept.
/// One line each.
[[nodiscard]] std::vector<std::string> remarksOn(const RobotModel& model);

}  // namespace tccm
