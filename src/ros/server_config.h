#pragma once

#include <ros/console.h>
#include <ros/node_handle.h>
#include <yaml-cpp/yaml.h>

#include "monitor_config.h"

namespace tccm {

/// Everything under a node handle's namespace on the parameter server.
[[nodiscard]] YAML::Node parametersOf(const ros::NodeHandle& node);

/// A configuration as the parameter server has it; warns of keys that nothing reads.
/// @throws ConfigError
template <typename Config>
[[nodiscard]] Config configFrom(const ros::NodeHandle& node) {
  Config config;
  for (const std::string& key : load(parametersOf(node), node.getNamespace(), config)) {
    ROS_WARN("%s/%s: there is no such parameter; it is ignored.", node.getNamespace().c_str(),
             key.c_str());
  }
  return config;
}

}  // namespace tccm
