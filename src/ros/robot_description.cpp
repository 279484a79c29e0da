#include "ros/robot_description.h"

#include <ros/console.h>
#include <ros/param.h>

#include <map>
#include <mutex>

#include "ros/resources.h"
#include "ros/server_config.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

RobotResources resources() {
  RobotResources resources;
  resources.read = resourceReader("");
  resources.fit_cache_folder = fitCacheFolder();
  resources.progress = [](std::size_t done, std::size_t all) {
    if (done == 0) ROS_INFO("Reading %zu meshes; those never seen before are fitted now.", all);
  };
  return resources;
}

}  // namespace

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

std::shared_ptr<const RobotModel> sharedRobotModel(const ros::NodeHandle& node) {
  static std::mutex mutex;
  static std::map<std::string, std::weak_ptr<const RobotModel>> models;
  const auto config =
      configFrom<RobotModel::Config>(ros::NodeHandle(node, MonitorConfig::kRobotSection));
  const std::string urdf = readRobotDescription(node);
  const std::lock_guard<std::mutex> lock(mutex);
  std::weak_ptr<const RobotModel>& known = models[config.text() + urdf];
  if (auto model = known.lock()) return model;
  auto model = std::make_shared<const RobotModel>(urdf, config, resources());
  for (const std::string& remark : remarksOn(*model)) ROS_INFO("%s", remark.c_str());
  known = model;
  return model;
}

std::vector<std::string> remarksOn(const RobotModel& model) {
  std::vector<std::string> remarks;
  const auto& without = model.linksWithoutShape();
  if (!without.empty()) {
    std::string names;
    for (const std::string& link : without) names += (names.empty() ? "" : ", ") + link;
    remarks.push_back(std::to_string(without.size()) +
                      " links have no collision element and are not watched: " + names);
  }
  if (!model.cacheDefect().empty()) {
    remarks.push_back("Fits are not kept for the next start: " + model.cacheDefect());
  }
  return remarks;
}

}  // namespace tccm
