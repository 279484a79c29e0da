#include "ros/stops/stop_topics.h"

#include <ros/message_traits.h>
#include <sensor_msgs/JointState.h>
#include <sensor_msgs/PointCloud2.h>
#include <std_msgs/String.h>
#include <tccm_monitor/CheckerCall.h>
#include <tccm_monitor/CheckerState.h>
#include <tccm_monitor/CloudScan.h>
#include <tccm_monitor/CuboidMap.h>
#include <tccm_monitor/CuboidMapChange.h>
#include <tccm_monitor/ScanReport.h>
#include <tf2_msgs/TFMessage.h>
#include <trajectory_msgs/JointTrajectory.h>

namespace tccm {
namespace {

template <typename Message>
StopTopic topic(const std::string& name) {
  using namespace ros::message_traits;
  return {name, DataType<Message>::value(), MD5Sum<Message>::value(), Definition<Message>::value()};
}

}  // namespace

std::vector<StopTopic> stopTopics(const std::vector<std::string>& sensors) {
  std::vector<StopTopic> topics{topic<std_msgs::String>("configuration"),
                                topic<std_msgs::String>("robot_description"),
                                topic<std_msgs::String>("primitives"),
                                topic<tccm_monitor::CheckerCall>("calls"),
                                topic<tccm_monitor::CheckerState>("state"),
                                topic<sensor_msgs::JointState>("/joint_states"),
                                topic<tf2_msgs::TFMessage>("/tf"),
                                topic<tf2_msgs::TFMessage>("/tf_static"),
                                topic<trajectory_msgs::JointTrajectory>("trajectory")};
  for (const std::string& sensor : sensors) {
    const std::string prefix = sensor.empty() ? "" : sensor + "/";
    topics.push_back(topic<tccm_monitor::ScanReport>(prefix + "scan_report"));
    topics.push_back(topic<tccm_monitor::CuboidMap>(prefix + "cuboid_map"));
    topics.push_back(topic<tccm_monitor::CuboidMapChange>(prefix + "cuboid_map_change"));
    topics.push_back(topic<sensor_msgs::PointCloud2>(prefix + "scan_cloud"));
    topics.push_back(topic<tccm_monitor::CloudScan>(prefix + "cloud_scan"));
  }
  return topics;
}

}  // namespace tccm
