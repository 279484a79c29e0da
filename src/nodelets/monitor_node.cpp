/// Starts all nodelets: in this process, or in a nodelet manager that `~manager` names. The sensors
/// that `collision_checker/sensors` names have an assembler and a mapper each, in a namespace of
/// the sensor's name.

#include <nodelet/NodeletList.h>
#include <nodelet/NodeletLoad.h>
#include <nodelet/NodeletUnload.h>
#include <nodelet/loader.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>

#include <algorithm>
#include <csignal>
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

volatile std::sig_atomic_t end_requested = 0;

bool isToEnd() { return end_requested != 0 || !ros::ok(); }

/// For a while, what waits for this thread.
void spinFor(double seconds) {
  ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(seconds));
}

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
  requireOneAssembler(own.getNamespace(), own.hasParam(SensorConfig::kScanAssembler), has_clouds);
  return has_clouds ? SensorConfig::kCloudAssembler : SensorConfig::kScanAssembler;
}

bool isIn(const YAML::Node& map, const std::string& key) { return map && map.IsMap() && map[key]; }

/// Launch files cannot clear the namespaces of sensors that they do not know.
/// @param path of the file that was loaded. @throws ConfigError
void tellLeftovers(const std::string& sensor, const std::string& path) {
  const YAML::Node all = loadYamlFile(path);
  const YAML::Node file = isIn(all, sensor) ? all[sensor] : YAML::Node();
  std::string keys;
  for (const char* section :
       {SensorConfig::kScanAssembler, SensorConfig::kCloudAssembler, SensorConfig::kMapper}) {
    for (const auto& entry : parametersOf(ros::NodeHandle(sensor + "/" + section))) {
      const auto key = entry.first.as<std::string>();
      if (isIn(file, section) && isIn(file[section], key)) continue;
      keys += (keys.empty() ? "" : ", ") + std::string(section) + "/" + key;
    }
  }
  if (keys.empty()) return;
  ROS_WARN(
      "Of %s the parameter server has what is not in %s: %s. An earlier launch left it there, "
      "or it was set beside the file.",
      ros::names::resolve(sensor).c_str(), path.c_str(), keys.c_str());
}

/// @throws ConfigError
Nodelets nodeletsOf(Remappings& remappings) {
  const ros::NodeHandle checker("collision_checker");
  const auto config = configFrom<CheckerConfig>(checker);
  const std::string file = soundFile(checker);
  Nodelets nodelets;
  const auto addSensor = [&](const std::string& prefix, const std::string& assembler) {
    const bool has_clouds = assembler == SensorConfig::kCloudAssembler;
    nodelets.push_back({prefix + assembler, has_clouds ? "tccm_monitor/CloudAssembler"
                                                       : "tccm_monitor/TiltScanAssembler"});
    nodelets.push_back({prefix + SensorConfig::kMapper, "tccm_monitor/TccmMapper"});
  };
  for (const SensorInput::Config& sensor : config.checker.inputs.sensors) {
    remapInputs(sensor.name, remappings);
    if (!file.empty()) tellLeftovers(sensor.name, file);
    addSensor(sensor.name + "/", assemblerOf(sensor.name));
  }
  if (nodelets.empty()) addSensor("", SensorConfig::kScanAssembler);
  nodelets.push_back({"collision_checker", "tccm_monitor/CollisionChecker"});
  const std::string gate = MonitorConfig::kGateSection;
  XmlRpc::XmlRpcValue controllers;
  if (ros::param::get(gate + "/controllers", controllers) && controllers.valid() &&
      controllers.getType() == XmlRpc::XmlRpcValue::TypeArray && controllers.size() > 0) {
    nodelets.push_back({gate, "tccm_monitor/TrajectoryGate"});
  }
  return nodelets;
}

/// Nodelets in another process, which end with this one.
class Manager {
 public:
  explicit Manager(const std::string& name) : name_(ros::names::resolve(name)) {}
  Manager(const Manager&) = delete;
  Manager& operator=(const Manager&) = delete;
  ~Manager() {
    for (auto name = loaded_.rbegin(); name != loaded_.rend() && ros::ok(); ++name) unload(*name);
  }

  void awaitStart() const {
    while (!isToEnd() && !ros::service::waitForService(service("load_nodelet"), 1000)) {
      ROS_WARN_THROTTLE(5.0, "There is no nodelet manager %s yet.", name_.c_str());
    }
  }
  bool load(const std::string& name, const std::string& type, const Remappings& remappings) {
    if (holds(name)) {
      ROS_WARN("%s was left in %s by a monitor_node that is gone; it is loaded anew.", name.c_str(),
               name_.c_str());
      unload(name);
    }
    nodelet::NodeletLoad call;
    call.request.name = name;
    call.request.type = type;
    for (const auto& [from, to] : remappings) {
      call.request.remap_source_args.push_back(from);
      call.request.remap_target_args.push_back(to);
    }
    const bool is_loaded =
        ros::service::call(service("load_nodelet"), call) && call.response.success;
    if (is_loaded) loaded_.push_back(name);
    return is_loaded;
  }
  /// Until this process is to end. @return whether the manager is there still.
  [[nodiscard]] bool stay() const {
    constexpr int kMissesMax = 3;  // a busy master or manager may miss one
    for (int misses = 0; misses < kMissesMax;) {
      for (int i = 0; i < 10 && !isToEnd(); ++i) spinFor(0.1);
      if (isToEnd()) return true;
      misses = ros::service::exists(service("load_nodelet"), false) ? 0 : misses + 1;
    }
    if (ros::master::check()) {
      ROS_FATAL("The nodelet manager %s is gone, and the monitor with it.", name_.c_str());
    } else {
      ROS_FATAL(
          "The ROS master at %s is gone, and the monitor ends: nobody finds it any more. Start a "
          "master first that outlives the robot's launch file: roscore.",
          ros::master::getURI().c_str());
    }
    return false;
  }

 private:
  [[nodiscard]] std::string service(const char* name) const { return name_ + "/" + name; }
  [[nodiscard]] bool holds(const std::string& nodelet) const {
    nodelet::NodeletList call;
    if (!ros::service::call(service("list"), call)) return false;
    const std::vector<std::string>& all = call.response.nodelets;
    return std::find(all.begin(), all.end(), nodelet) != all.end();
  }
  void unload(const std::string& nodelet) const {
    nodelet::NodeletUnload call;
    call.request.name = nodelet;
    ros::service::call(service("unload_nodelet"), call);
  }

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
  while (!isToEnd()) spinFor(0.1);
  return 0;
}

}  // namespace
}  // namespace tccm

int main(int argc, char** argv) {
  // What is in a manager is unloaded while ROS still runs.
  ros::init(argc, argv, "tccm_monitor", ros::init_options::NoSigintHandler);
  for (const int signal : {SIGINT, SIGTERM}) {
    std::signal(signal, [](int /*signal*/) { tccm::end_requested = 1; });
  }
  return tccm::run();
}
