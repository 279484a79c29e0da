#pragma once

#include <ros/time.h>
#include <sensor_msgs/JointState.h>
#include <sensor_msgs/LaserScan.h>
#include <tf2_msgs/TFMessage.h>
#include <trajectory_msgs/JointTrajectory.h>
#include <visualization_msgs/MarkerArray.h>

#include "simulation/simulator.h"

namespace tccm::simulation {

[[nodiscard]] ros::Time toRos(Time stamp);

/// @param now where the trajectory starts if it has no stamp.
[[nodiscard]] ArmCommand toCommand(const trajectory_msgs::JointTrajectory& message, Time now);

/// In frame laser_link.
[[nodiscard]] sensor_msgs::LaserScan toMessage(const LaserScan& scan, double scan_period_s);

/// All joints that move.
[[nodiscard]] sensor_msgs::JointState jointMessage(const RobotModel& model,
                                                   const RobotSample& sample);

/// One transform for each joint, fixed ones too.
[[nodiscard]] tf2_msgs::TFMessage transformMessage(const RobotModel& model,
                                                   const RobotSample& sample);

/// The scene as it is at an instant, transparent, in base_link.
[[nodiscard]] visualization_msgs::MarkerArray sceneMarkers(const World& world, Time stamp);

}  // namespace tccm::simulation
