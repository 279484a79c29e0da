#pragma once

#include <rosbag/bag.h>

#include <string>
#include <vector>

#include "recording.h"

namespace tccm {

/// @throws InputError where the bag cannot be read.
void openBag(const std::string& path, rosbag::Bag& bag);
/// Whether a topic has the transforms that do not move.
[[nodiscard]] bool isStaticTransforms(const std::string& topic);

/// The messages of a bag that concern the monitor, in the order they were recorded, from files with
/// or without compression.
class BagStream : public Recording {
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
  /// @throws InputError where there is no such bag, or nothing on a topic that is needed.
  BagStream(const std::string& path, const Topics& topics);

  void play(const Sink& sink) const override;

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
