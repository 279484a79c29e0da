/// Starts all nodelets: in this process, or in a nodelet manager that `~manager` names. The sensors
/// that `collision_checker/sensors` names have an assembler and a mapper each, in a namespace of
/// the sensor's name.

#include <nodelet/NodeletLoad.h>
#include <nodelet/NodeletUnload.h>
#include <nodelet/loader.h>
#include <ros/ros.h>

#include <string>
#include <utility>
#include <vector>

#include "config/yaml_file.h"
#include "ros/server_config.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

using Nodelets = std::vector<std::pair<std::string, std::string>>;
using Remappings = nodelet::M_string;

/// Names that the nodelets of a sensor share with all others, though they have a namespace of their
/// own; and its scans or clouds.
void remapInputs(const std::string& sensor, Remappings& remappings) {
  const ros::NodeHandle all, own(sensor);
  for (const char* shared : {"joint_states", "attached_objects"}) {
    remappings[own.resolveName(shared, false)] = all.resolveName(shared);
  }
  std::string topic;
  if (own.getParam("topic", topic)) {
    for (const char* input : {"scan", "cloud_in"}) {
      remappings[own.resolveName(input, false)] = all.resolveName(topic);
    }
  }
}

/// A camera or lidar has clouds to be assembled, a laser has scans.
/// @throws ConfigError
std::string assemblerOf(const std::string& sensor) {
  const ros::NodeHandle own(sensor);
  const bool has_clouds = own.hasParam(SensorConfig::kCloudAssembler);
  if (has_clouds && own.hasParam(SensorConfig::kScanAssembler)) {
    throw ConfigError(own.getNamespace() +
                      ": it has tilt_scan_assembler and cloud_assembler; keep the one for what it "
                      "publishes, scans or clouds");
  }
  return has_clouds ? SensorConfig::kCloudAssembler : SensorConfig::kScanAssembler;
}

/// Launch files cannot clear the namespaces of sensors that they do not know.
void tellLeftovers(const std::string& sensor) {
  const ros::NodeHandle node;
  std::string path, keys;
  if (!node.getParam("tccm_monitor_config", path)) return;
  const YAML::Node file = loadYamlFile(path)[sensor];
  for (const char* section :
       {SensorConfig::kScanAssembler, SensorConfig::kCloudAssembler, SensorConfig::kMapper}) {
    for (const auto& entry : parametersOf(ros::NodeHandle(sensor + "/" + section))) {
      const auto key = entry.first.as<std::string>();
      if (file && file[section] && file[section][key]) continue;
      keys += (keys.empty() ? "" : ", ") + std::string(section) + "/" + key;
    }
  }
  if (keys.empty()) return;
  ROS_WARN(
      "Of %s the parameter server has what is not in %s: %s. An earlier launch left it there, "
      "or it was set beside the file.",
      node.resolveName(sensor).c_str(), path.c_str(), keys.c_str());
}

/// @throws ConfigError
Nodelets nodeletsOf(Remappings& remappings) {
  const auto config = configFrom<CheckerConfig>(ros::NodeHandle("collision_checker"));
  Nodelets nodelets;
  const auto addSensor = [&](const std::string& prefix, const std::string& assembler) {
    const bool has_clouds = assembler == SensorConfig::kCloudAssembler;
    nodelets.push_back({prefix + assembler, has_clouds ? "tccm_monitor/CloudAssembler"
                                                       : "tccm_monitor/TiltScanAssembler"});
    nodelets.push_back({prefix + SensorConfig::kMapper, "tccm_monitor/TccmMapper"});
  };
  for (const SensorInput::Config& sensor : config.checker.inputs.sensors) {
    remapInputs(sensor.name, remappings);
    tellLeftovers(sensor.name);
    addSensor(sensor.name + "/", assemblerOf(sensor.name));
  }
  if (nodelets.empty()) addSensor("", SensorConfig::kScanAssembler);
  nodelets.push_back({"collision_checker", "tccm_monitor/CollisionChecker"});
  return nodelets;
}

/// Nodelets in another process, which end with this one.
class Manager {
 public:
  explicit Manager(const std::string& name) : name_(ros::names::resolve(name)) {}
  Manager(const Manager&) = delete;
  Manager& operator=(const Manager&) = delete;
  ~Manager() {
    for (auto name = loaded_.rbegin(); name != loaded_.rend() && isThere(); ++name) {
      nodelet::NodeletUnload call;
      call.request.name = *name;
      ros::service::call(name_ + "/unload_nodelet", call);
    }
  }

  void awaitStart() const {
    while (ros::ok() && !ros::service::waitForService(service(), 5000)) {
      ROS_WARN("There is no nodelet manager %s yet.", name_.c_str());
    }
  }
  bool load(const std::string& name, const std::string& type, const Remappings& remappings) {
    nodelet::NodeletLoad call;
    call.request.name = name;
    call.request.type = type;
    for (const auto& [from, to] : remappings) {
      call.request.remap_source_args.push_back(from);
      call.request.remap_target_args.push_back(to);
    }
    const bool is_loaded = ros::service::call(service(), call) && call.response.success;
    if (is_loaded) loaded_.push_back(name);
    return is_loaded;
  }
  /// Until this process is to end. @return whether the manager is there still.
  [[nodiscard]] bool stay() const {
    constexpr int kMissesMax = 3;  // a busy master or manager may miss one
    int misses = 0;
    for (ros::WallDuration second(1.0); ros::ok() && misses < kMissesMax; second.sleep()) {
      ros::spinOnce();
      misses = isThere() ? 0 : misses + 1;
    }
    if (!ros::ok()) return true;
    ROS_FATAL("The nodelet manager %s is gone, and the monitor with it.", name_.c_str());
    return false;
  }

 private:
  [[nodiscard]] std::string service() const { return name_ + "/load_nodelet"; }
  [[nodiscard]] bool isThere() const { return ros::service::exists(service(), false); }

  std::string name_;
  std::vector<std::string> loaded_;
};

int run() {
  const ros::NodeHandle node;
  Remappings remappings = ros::names::getRemappings();
  Nodelets nodelets;
  try {
    nodelets = nodeletsOf(remappings);
  } catch (const ConfigError& error) {
    ROS_FATAL("%s refuses to start: %s", node.resolveName("collision_checker").c_str(),
              error.what());
    return 1;
  }
  std::string name;
  if (ros::param::get("~manager", name) && !name.empty()) {
    Manager manager(name);
    manager.awaitStart();
    // What else can be loaded is there, and says that something is missing.
    bool are_all = true;
    for (const auto& [nodelet, type] : nodelets) {
      are_all &= manager.load(node.resolveName(nodelet), type, remappings);
    }
    return manager.stay() && are_all ? 0 : 1;
  }
  nodelet::Loader loader(node);
  for (const auto& [nodelet, type] : nodelets) {
    if (!loader.load(node.resolveName(nodelet), type, remappings, {})) return 1;
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
