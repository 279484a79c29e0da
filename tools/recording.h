#pragma once

#include <sensor_msgs/JointState.h>
#include <sensor_msgs/LaserScan.h>
#include <sensor_msgs/PointCloud2.h>
#include <tf2_msgs/TFMessage.h>

#include <cstddef>
#include <functional>
#include <string>

namespace tccm {

/// Messages that were kept, in the order they came.
class Recording {
 public:
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
    std::function<void(double fraction)> progress;  ///< may be empty; from 0 to 1. May throw
  };

  Recording() = default;
  Recording(const Recording&) = delete;
  Recording& operator=(const Recording&) = delete;
  virtual ~Recording() = default;

  /// @throws InputError where it is damaged.
  virtual void play(const Sink& sink) const = 0;
};

}  // namespace tccm
