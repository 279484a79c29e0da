/// All nodelets in one process of their own, for those who avoid nodelet managers, and for several
/// sensors: those that `collision_checker/sensors` names have an assembler and a mapper each, in a
/// namespace of the sensor's name.

#include <nodelet/loader.h>
#include <ros/ros.h>

#include <string>
#include <utility>
#include <vector>

#include "ros/server_config.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

using Nodelets = std::vector<std::pair<std::string, std::string>>;

/// Names that the nodelets of a sensor share with all others, though they have a namespace of their
/// own; and its scans.
void remapInputs(const std::string& sensor, nodelet::M_string& remappings) {
  const ros::NodeHandle all, own(sensor);
  for (const char* shared : {"joint_states", "attached_objects"}) {
    remappings[own.resolveName(shared, false)] = all.resolveName(shared);
  }
  std::string topic;
  if (own.getParam("topic", topic)) {
    remappings[own.resolveName("scan", false)] = all.resolveName(topic);
  }
}

/// @throws ConfigError
Nodelets nodeletsOf(nodelet::M_string& remappings) {
  const auto config = configFrom<CheckerConfig>(ros::NodeHandle("collision_checker"));
  Nodelets nodelets;
  const auto addSensor = [&](const std::string& prefix) {
    nodelets.push_back({prefix + "tilt_scan_assembler", "tccm_monitor/TiltScanAssembler"});
    nodelets.push_back({prefix + "tccm_mapper", "tccm_monitor/TccmMapper"});
  };
  for (const SensorInput::Config& sensor : config.checker.inputs.sensors) {
    remapInputs(sensor.name, remappings);
    addSensor(sensor.name + "/");
  }
  if (nodelets.empty()) addSensor("");
  nodelets.push_back({"collision_checker", "tccm_monitor/CollisionChecker"});
  return nodelets;
}

int run() {
  const ros::NodeHandle node;
  nodelet::Loader loader(node);
  nodelet::M_string remappings = ros::names::getRemappings();
  try {
    for (const auto& [name, type] : nodeletsOf(remappings)) {
      if (!loader.load(node.resolveName(name), type, remappings, {})) return 1;
    }
  } catch (const ConfigError& error) {
    ROS_FATAL("%s refuses to start: %s", node.resolveName("collision_checker").c_str(),
              error.what());
    return 1;
  }
  ros::spin();
  return 0;
}

}  // namespace
}  // namespace tccm

int main(int argc, char** argv) {
  ros::init(argc, argv, "tccm_monitor");
  return tccm::run();
}
