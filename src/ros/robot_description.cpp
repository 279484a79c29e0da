#include "tccm_monitor/ros/robot_description.h"

#include <ros/param.h>

#include "tccm_monitor/config_error.h"

namespace tccm {

std::string readRobotDescription(const ros::NodeHandle& node) {
  std::string key, urdf;
  // A nodelet's node handle has an empty namespace at the root, in which nothing is found.
  const std::string from = node.getNamespace().empty() ? "/" : node.getNamespace();
  if (!ros::param::search(from, "robot_description", key) || !node.getParam(key, urdf) ||
      urdf.empty()) {
    throw ConfigError("robot_description: it is not on the parameter server, or is no text");
  }
  return urdf;
}

}  // namespace tccm
