#pragma once

#include <ros/console.h>
#include <ros/node_handle.h>
#include <yaml-cpp/yaml.h>

#include <memory>

#include "monitor_config.h"
#include "tccm_monitor/config_error.h"

namespace tccm {

/// Everything under a node handle's namespace on the parameter server.
[[nodiscard]] YAML::Node parametersOf(const ros::NodeHandle& node);

/// The file that the launch file loaded says the same to whoever reads it: a key given twice is
/// lost once it is on the parameter server. @return its path; empty where there is none that can be
/// read here. @throws ConfigError
std::string soundFile(const ros::NodeHandle& node);

/// The same error as the file has it, which tells its line, where it is there and says the same.
[[nodiscard]] ConfigError withLine(const ConfigError& error, const std::string& file);

/// A configuration as the parameter server has it; warns of keys that nothing reads.
/// @throws ConfigError
template <typename Config>
[[nodiscard]] Config configFrom(const ros::NodeHandle& node) {
  const std::string file = soundFile(node);
  try {
    Config config;
    for (const std::string& key : load(parametersOf(node), node.getNamespace(), config)) {
      ROS_WARN("%s/%s: there is no such parameter; it is ignored.", node.getNamespace().c_str(),
               key.c_str());
    }
    return config;
  } catch (const ConfigError& error) {
    throw withLine(error, file);
  }
}

/// Logs what of a configuration differs from the defaults.
template <typename Config>
void tellDifferences(const ros::NodeHandle& node, const Config& config) {
  const std::string differences = differencesFromDefaults(config);
  ROS_INFO("%s: %s%s", node.getNamespace().c_str(),
           differences.empty() ? "all as by default" : "not as by default (# default):",
           differences.c_str());
}

/// The URDF's text, searched upwards from the node's namespace. @throws ConfigError
[[nodiscard]] std::string robotDescription(const ros::NodeHandle& node);

/// What the parameter server has of `monitored_robot`, searched upwards likewise.
[[nodiscard]] YAML::Node robotParameters(const ros::NodeHandle& node);

/// The robot as all nodelets of this process see it: read once, from robot_description, searched
/// upwards from the node's namespace, and from `monitored_robot` in it. Logs what of the robot is
/// not watched, or taken otherwise than it stands, and fits that could not be kept. @throws
/// ConfigError
[[nodiscard]] std::shared_ptr<const RobotModel> sharedRobotModel(const ros::NodeHandle& node);

}  // namespace tccm
