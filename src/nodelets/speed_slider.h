#pragma once

#include <ros/ros.h>

#include <condition_variable>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "ros/service_line.h"

namespace tccm {

/// What sets the speed of a whole arm as a share of what its controller is told, such as the speed
/// slider of a robot's driver: a topic or a service of one number.
class SpeedSlider {
 public:
  /// std_msgs/Float64, std_msgs/Float32 or ur_msgs/SetSpeedSliderFraction, which is a service.
  [[nodiscard]] static bool knows(const std::string& type);

  /// @param name of the topic or service. @pre knows(type)
  SpeedSlider(const ros::NodeHandle& node, const std::string& name, const std::string& type);
  SpeedSlider(const SpeedSlider&) = delete;
  SpeedSlider& operator=(const SpeedSlider&) = delete;
  ~SpeedSlider();

  /// Does not wait. @param fraction above 0 and up to 1.
  void set(double fraction);
  /// Whether the arm is known to be no faster than what was set last. @pre set() since forget()
  [[nodiscard]] bool isSet();
  /// Why it does not do as it is told, in one line; empty where it does, or may still.
  [[nodiscard]] std::string defect();
  /// Where it is is not known any more: others may move it, and what was asked may never be done.
  void forget();

 private:
  void run();
  /// @return why not; empty where it is done.
  [[nodiscard]] std::string call(double fraction);

  std::string type_;
  ros::Publisher topic_;
  std::optional<ServiceLine> service_;
  std::mutex mutex_;  ///< of what follows
  std::condition_variable news_;
  std::optional<double> wanted_;  ///< not yet asked for
  std::optional<double> set_;     ///< what was wanted last; nothing: not known
  bool is_calling_ = false, is_over_ = false;
  std::string defect_;
  std::thread thread_;  ///< calls the service; none for a topic
};

}  // namespace tccm
