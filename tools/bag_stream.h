#pragma once

#include <rosbag/bag.h>
#include <sensor_msgs/JointState.h>
#include <sensor_msgs/LaserScan.h>
#include <sensor_msgs/PointCloud2.h>
#include <tf2_msgs/TFMessage.h>

#include <functional>
#include <string>
#include <vector>

namespace tccm {

/// The messages of a bag that concern the monitor, in the order they were recorded, from files with
/// or without compression.
class BagStream {
 public:
  /// What a sensor publishes.
  struct Sensor {
    std::string topic;
    bool is_cloud = false;  ///< sensor_msgs/PointCloud2; else sensor_msgs/LaserScan
  };
  struct Topics {
    std::vector<Sensor> sensors;
    std::string joint_states;
    bool joint_states_needed = false;
  };
  /// What takes the messages. The publisher tells streams of stamps apart.
  struct Sink {
    std::function<void(const sensor_msgs::LaserScan&, std::size_t sensor,
                       const std::string& publisher)>
        scan;
    std::function<void(const sensor_msgs::PointCloud2&, std::size_t sensor,
                       const std::string& publisher)>
        cloud;
    std::function<void(const sensor_msgs::JointState&, const std::string& publisher)> joint_states;
    std::function<void(const tf2_msgs::TFMessage&, bool is_static)> transforms;
    std::function<void(double fraction)> progress;  ///< may be empty; from 0 to 1
  };

  /// @throws InputError where there is no such bag, or nothing on a topic that is needed.
  BagStream(const std::string& path, const Topics& topics);

  /// @throws InputError where the bag is damaged.
  void play(const Sink& sink) const;

 private:
  void pass(const rosbag::MessageInstance& message, const Sink& sink) const;
  /// @throws InputError where `topic` carries another type, or is needed and not there.
  void require(const std::string& topic, const std::string& role, const std::string& type,
               bool needed) const;
  [[nodiscard]] std::string listOf(const std::string& type) const;

  std::string path_;
  Topics topics_;
  rosbag::Bag bag_;
};

}  // namespace tccm
