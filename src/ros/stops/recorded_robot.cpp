#include "ros/stops/recorded_robot.h"

#include <rosbag/view.h>
#include <std_msgs/String.h>
#include <yaml-cpp/yaml.h>

#include <stdexcept>
#include <vector>

#include "fit/primitives_file.h"
#include "robot/link_primitives.h"
#include "ros/stops/stop_topics.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

constexpr const char* kPrimitivesUri = "stop:primitives";

/// A message that the bag begins with.
std::string textOn(const rosbag::Bag& bag, StopTopicId id) {
  const std::string topic = stopTopics({}).at(topicIndex(id)).name;
  rosbag::View view(bag, rosbag::TopicQuery(topic));
  for (const rosbag::MessageInstance& message : view) {
    if (const auto text = message.instantiate<std_msgs::String>()) return text->data;
  }
  throw std::runtime_error("it is no bag of a stop, as it has no " + topic);
}

}  // namespace

StopWriter::Preamble RecordedRobot::preambleOf(const std::string& checker_yaml,
                                               const std::string& robot_yaml,
                                               const std::string& urdf, const RobotModel& model) {
  YAML::Node configuration;
  configuration["collision_checker"] = YAML::Load(checker_yaml);
  configuration[MonitorConfig::kRobotSection] = YAML::Load(robot_yaml);
  return {YAML::Dump(configuration), urdf, writePrimitives(primitivesOf(model), model.name())};
}

RecordedRobot RecordedRobot::from(const rosbag::Bag& bag) {
  const YAML::Node configuration = YAML::Load(textOn(bag, StopTopicId::kConfiguration));
  const std::string urdf = textOn(bag, StopTopicId::kRobotDescription);
  const std::string primitives = textOn(bag, StopTopicId::kPrimitives);
  RecordedRobot robot;
  static_cast<void>(load(configuration["collision_checker"], "collision_checker", robot.checker));
  RobotModel::Config config;
  static_cast<void>(
      load(configuration[MonitorConfig::kRobotSection], MonitorConfig::kRobotSection, config));
  config.primitives_file = kPrimitivesUri;
  RobotResources resources;
  resources.read = [&primitives](const std::string& uri) {
    if (uri == kPrimitivesUri) return std::string(primitives);
    throw ConfigError(uri + ": primitives stand for it, and are not there");
  };
  robot.model = std::make_shared<const RobotModel>(urdf, config, resources);
  return robot;
}

bool RecordedRobot::isOf(const std::string& topic) {
  static const std::vector<StopTopic> topics = stopTopics({});
  for (const StopTopicId id :
       {StopTopicId::kConfiguration, StopTopicId::kRobotDescription, StopTopicId::kPrimitives}) {
    if (topics[topicIndex(id)].name == topic) return true;
  }
  return false;
}

}  // namespace tccm
