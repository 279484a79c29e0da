#include "ros/server_config.h"

#include <ros/param.h>

#include <fstream>
#include <map>
#include <mutex>

#include "config/yaml_file.h"
#include "ros/resources.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

YAML::Node toYaml(XmlRpc::XmlRpcValue& value) {
  YAML::Node node;
  switch (value.getType()) {
    case XmlRpc::XmlRpcValue::TypeBoolean:
      return YAML::Node(static_cast<bool>(value));
    case XmlRpc::XmlRpcValue::TypeInt:
      return YAML::Node(static_cast<int>(value));
    case XmlRpc::XmlRpcValue::TypeDouble:
      return YAML::Node(static_cast<double>(value));
    case XmlRpc::XmlRpcValue::TypeString:
      return YAML::Node(static_cast<std::string>(value));
    case XmlRpc::XmlRpcValue::TypeArray:
      node = YAML::Node(YAML::NodeType::Sequence);  // also where it is empty
      for (int i = 0; i < value.size(); ++i) node.push_back(toYaml(value[i]));
      return node;
    case XmlRpc::XmlRpcValue::TypeStruct:
      node = YAML::Node(YAML::NodeType::Map);
      for (auto& entry : value) node[entry.first] = toYaml(entry.second);
      return node;
    default:
      return node;
  }
}

void tellProgress(std::size_t done, std::size_t all) {
  if (done == 0) ROS_INFO("Reading %zu meshes; those never seen before are fitted now.", all);
}

void tellDefects(const RobotModel& model) {
  const std::vector<std::string>& without = model.linksWithoutShape();
  std::string names;
  for (const std::string& link : without) names += (names.empty() ? "" : ", ") + link;
  if (!without.empty()) {
    ROS_INFO("%zu links have no collision element and are not watched: %s", without.size(),
             names.c_str());
  }
  for (const std::string& warning : model.warnings()) {
    ROS_WARN("robot_description: %s.", warning.c_str());
  }
  if (!model.cacheDefect().empty()) {
    ROS_INFO("Fits are not kept for the next start: %s", model.cacheDefect().c_str());
  }
}

/// From the namespace upwards: a sensor's nodelets have one of their own.
std::string robotSection(const ros::NodeHandle& node) {
  std::string found;
  const std::string from = node.getNamespace().empty() ? "/" : node.getNamespace();
  if (ros::param::search(from, MonitorConfig::kRobotSection, found)) return found;
  return node.resolveName(MonitorConfig::kRobotSection);
}

}  // namespace

YAML::Node parametersOf(const ros::NodeHandle& node) {
  XmlRpc::XmlRpcValue value;
  return node.getParam(node.getNamespace(), value) ? toYaml(value) : YAML::Node();
}

std::string soundFile(const ros::NodeHandle& node) {
  std::string key, path;
  if (!ros::param::search(node.getNamespace(), "tccm_monitor_config", key)) return {};
  if (!ros::param::get(key, path)) throw ConfigError(key + ": it is no text; it names a file");
  if (!std::ifstream(path)) {
    ROS_WARN("%s: it cannot be read here, and not be searched for keys given twice.", path.c_str());
    return {};
  }
  static_cast<void>(loadYamlFile(path));
  return path;
}

std::string robotDescription(const ros::NodeHandle& node) {
  std::string key, urdf;
  // A nodelet's node handle has an empty namespace at the root, in which nothing is found.
  const std::string from = node.getNamespace().empty() ? "/" : node.getNamespace();
  if (!ros::param::search(from, "robot_description", key) || !node.getParam(key, urdf) ||
      urdf.empty()) {
    throw ConfigError("robot_description: it is not on the parameter server, or is no text");
  }
  return urdf;
}

ConfigError withLine(const ConfigError& error, const std::string& file) {
  if (file.empty()) return error;
  const std::string what = error.what();
  // Of "/left/collision_checker/horizon_s: soon ..." what is without the namespace.
  const std::size_t slash = what.rfind('/', what.find(": "));
  const std::string said = slash == std::string::npos ? what : what.substr(slash + 1);
  try {
    static_cast<void>(readMonitorConfig(file));
  } catch (const ConfigError& in_file) {
    const std::string found = in_file.what();
    if (found.find(said) != std::string::npos) return in_file;
  }
  return error;
}

YAML::Node robotParameters(const ros::NodeHandle& node) {
  return parametersOf(ros::NodeHandle(robotSection(node)));
}

std::shared_ptr<const RobotModel> sharedRobotModel(const ros::NodeHandle& node) {
  static std::mutex mutex;
  static std::map<std::string, std::weak_ptr<const RobotModel>> models;
  const ros::NodeHandle section(robotSection(node));
  const auto config = configFrom<RobotModel::Config>(section);
  const std::string urdf = robotDescription(node);
  const std::lock_guard<std::mutex> lock(mutex);
  std::weak_ptr<const RobotModel>& known = models[config.text() + urdf];
  if (auto model = known.lock()) return model;
  auto model = std::make_shared<const RobotModel>(
      urdf, config, RobotResources{resourceReader(""), fitCacheFolder(), tellProgress});
  tellDifferences(section, config);
  tellDefects(*model);
  known = model;
  return model;
}

}  // namespace tccm
