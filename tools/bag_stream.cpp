#include "bag_stream.h"

#include <rosbag/exceptions.h>
#include <rosbag/view.h>

#include <filesystem>
#include <set>

#include "program.h"

namespace tccm {
namespace {

constexpr const char* kScanType = "sensor_msgs/LaserScan";
constexpr const char* kCloudType = "sensor_msgs/PointCloud2";
constexpr const char* kJointStateType = "sensor_msgs/JointState";
const std::vector<std::string> kMovingTransforms{"/tf", "tf"};
const std::vector<std::string> kStaticTransforms{"/tf_static", "tf_static"};

/// With and without the slash in front: recorders differ.
std::vector<std::string> spellings(const std::string& topic) {
  const std::size_t first = topic.find_first_not_of('/');
  if (first == std::string::npos) return {};
  const std::string bare = topic.substr(first);
  return {"/" + bare, bare};
}

bool isOneOf(const std::string& topic, const std::vector<std::string>& topics) {
  for (const std::string& candidate : topics) {
    if (candidate == topic) return true;
  }
  return false;
}

std::string publisherOf(const rosbag::MessageInstance& message) {
  return message.getTopic() + " " + message.getCallerId();
}

}  // namespace

void openBag(const std::string& path, rosbag::Bag& bag) {
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) throw InputError("no such bag: " + path);
  if (!std::filesystem::is_regular_file(path, ignored)) throw InputError(path + " is no file");
  try {
    bag.open(path, rosbag::bagmode::Read);
  } catch (const rosbag::BagUnindexedException&) {
    throw InputError(path + ": the bag has no index; `rosbag reindex` makes one");
  } catch (const std::exception& error) {
    throw InputError(path + " is no readable bag: " + error.what());
  }
}

bool isStaticTransforms(const std::string& topic) { return isOneOf(topic, kStaticTransforms); }

BagStream::BagStream(const std::string& path, const Topics& topics) : path_(path), topics_(topics) {
  openBag(path_, bag_);
  for (const Sensor& sensor : topics_.sensors) {
    require(sensor.topic, sensor.is_cloud ? "cloud topic" : "scan topic",
            sensor.is_cloud ? kCloudType : kScanType, true);
  }
  require(topics_.joint_states, "joint states topic", kJointStateType, topics_.joint_states_needed);
}

void BagStream::require(const std::string& topic, const std::string& role, const std::string& type,
                        bool needed) const {
  rosbag::View view(bag_, rosbag::TopicQuery(spellings(topic)));
  for (const rosbag::ConnectionInfo* connection : view.getConnections()) {
    if (connection->datatype != type) {
      throw InputError(role + " '" + topic + "' carries " + connection->datatype + ", not " + type);
    }
  }
  if (needed && view.size() == 0) {
    throw InputError("no messages on " + role + " '" + topic + "'; the bag has: " + listOf(type));
  }
}

std::string BagStream::listOf(const std::string& type) const {
  rosbag::View view(bag_);
  std::set<std::string> fitting;
  std::set<std::string> all;
  for (const rosbag::ConnectionInfo* connection : view.getConnections()) {
    all.insert(connection->topic + " (" + connection->datatype + ")");
    if (connection->datatype == type) fitting.insert(connection->topic);
  }
  std::string list;
  for (const std::string& entry : fitting.empty() ? all : fitting) {
    list += (list.empty() ? "" : ", ") + entry;
  }
  return list.empty() ? "nothing" : list;
}

void BagStream::play(const Sink& sink) const {
  std::vector<std::string> topics;
  const auto listen = [&](const std::vector<std::string>& names) {
    topics.insert(topics.end(), names.begin(), names.end());
  };
  for (const auto& names :
       {spellings(topics_.joint_states), kMovingTransforms, kStaticTransforms}) {
    listen(names);
  }
  for (const Sensor& sensor : topics_.sensors) listen(spellings(sensor.topic));
  try {
    rosbag::View view(bag_, rosbag::TopicQuery(topics));
    const double messages = view.size();
    std::size_t played = 0;
    for (const rosbag::MessageInstance& message : view) {
      if (sink.progress) sink.progress(static_cast<double>(played++) / messages);
      pass(message, sink);
    }
    if (sink.progress) sink.progress(1.0);
  } catch (const ros::Exception& error) {
    throw InputError(path_ + " is damaged: " + error.what());
  }
}

void BagStream::pass(const rosbag::MessageInstance& message, const Sink& sink) const {
  const std::string publisher = publisherOf(message);
  bool is_of_sensor = false;
  for (std::size_t i = 0; i < topics_.sensors.size(); ++i) {
    if (!isOneOf(message.getTopic(), spellings(topics_.sensors[i].topic))) continue;
    is_of_sensor = true;
    if (topics_.sensors[i].is_cloud) {
      const auto cloud = message.instantiate<sensor_msgs::PointCloud2>();
      if (cloud) sink.cloud(*cloud, i, publisher);
    } else {
      const auto scan = message.instantiate<sensor_msgs::LaserScan>();
      if (scan) sink.scan(*scan, i, publisher);
    }
  }
  if (is_of_sensor) return;
  if (isOneOf(message.getTopic(), spellings(topics_.joint_states))) {
    const auto joints = message.instantiate<sensor_msgs::JointState>();
    if (joints) sink.joint_states(*joints, publisher);
    return;
  }
  // tf/tfMessage is the same message under its older name.
  const auto transforms = message.instantiate<tf2_msgs::TFMessage>();
  if (transforms) sink.transforms(*transforms, isStaticTransforms(message.getTopic()));
}

}  // namespace tccm
