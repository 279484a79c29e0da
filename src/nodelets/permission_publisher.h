#pragma once

#include <ros/ros.h>

#include <cstdint>
#include <string>

#include "tccm_monitor/verdict.h"

namespace tccm {

/// Publishes what a controller obeys: `motion_permission`, and the same as plain `stop`,
/// `collision`, `occlusion` and `speed_scale`. Nothing is latched.
class PermissionPublisher {
 public:
  /// @param valid_for of a permission, from when it is given.
  PermissionPublisher(ros::NodeHandle node, const std::string& fixed_frame,
                      ros::Duration valid_for);

  /// @param now as stamp; a permission is dated, whatever the verdict's age.
  void publish(const Verdict& verdict, const ros::Time& now);

 private:
  std::string frame_;
  ros::Duration valid_for_;
  std::uint32_t sequence_ = 0;
  ros::Publisher permission_, stop_, collision_, occlusion_, scale_;
};

}  // namespace tccm
