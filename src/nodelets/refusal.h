#pragma once

#include <ros/console.h>
#include <ros/node_handle.h>

#include <exception>
#include <string>

#include "ros/parameters.h"

namespace tccm {

/// Runs a nodelet's set-up. What it throws is logged as one line and thrown on, so that the nodelet
/// manager does not load it and lives on.
template <typename SetUp>
void startOrRefuse(const std::string& nodelet, SetUp&& set_up) {
  try {
    set_up();
  } catch (const std::exception& error) {
    ROS_FATAL("%s refuses to start: %s", nodelet.c_str(), error.what());
    throw;
  }
}

/// Reads a nodelet's settings from its private namespace and warns of keys that nothing reads.
template <typename Settings>
Settings readFromServer(const ros::NodeHandle& private_node, Settings (*read)(Parameters&)) {
  Parameters parameters = Parameters::fromServer(private_node);
  Settings settings = read(parameters);
  for (const std::string& key : parameters.unknownKeys()) {
    ROS_WARN("%s/%s: there is no such parameter; it is ignored.", parameters.owner().c_str(),
             key.c_str());
  }
  return settings;
}

}  // namespace tccm
