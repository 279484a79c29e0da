#pragma once

#include <ros/duration.h>
#include <ros/time.h>
#include <sensor_msgs/LaserScan.h>
#include <sensor_msgs/PointCloud2.h>
#include <tccm_monitor/AttachedObject.h>
#include <tccm_monitor/CuboidMap.h>
#include <tccm_monitor/Primitive.h>
#include <tccm_monitor/ScanReport.h>
#include <trajectory_msgs/JointTrajectory.h>

#include <string>

#include "map/mapper.h"
#include "robot/joint_path.h"
#include "scan/assembled_scan.h"
#include "tccm_monitor/cuboid_map.h"
#include "tccm_monitor/laser_scan.h"
#include "tccm_monitor/robot_model.h"
#include "tccm_monitor/verdict.h"

namespace tccm {

[[nodiscard]] inline Time toTime(const ros::Time& time) {
  return Time(Duration(static_cast<Duration::rep>(time.toNSec())));
}
/// Saturates at what a ros::Time or Duration can hold: garbage must not throw in a callback.
[[nodiscard]] ros::Time toRos(Time time);
[[nodiscard]] ros::Duration toRos(Duration duration);

/// @param scan reused.
void fromMessage(const sensor_msgs::LaserScan& message, LaserScan& scan);

/// One point for each beam, in the order they were measured: x, y, z (NaN where the beam gave no
/// point for the map), vp_x, vp_y, vp_z (the sensor's origin at the beam's time), tilt [rad] and
/// kind (BeamKind). Reuses the message's memory. @param frame the fixed frame.
void toMessage(const AssembledScan& scan, const std::string& frame,
               sensor_msgs::PointCloud2& message);

/// @return empty, or what the cloud lacks. @param returns reused.
[[nodiscard]] std::string fromMessage(const sensor_msgs::PointCloud2& message,
                                      ScanReturns& returns);

/// Reuses the message's memory. col is left CLEAR.
void toMessage(const CuboidMap& map, const std::string& frame, tccm_monitor::CuboidMap& message);

/// What is occupied, as points x, y, z: in the middle of each cuboid's cell, from its lower to its
/// upper end, no further apart than a cell is wide. Reuses the message's memory.
void toPoints(const CuboidMap& map, const std::string& frame, sensor_msgs::PointCloud2& message);

/// @return empty, or why the message is no map. @param map reused.
[[nodiscard]] std::string fromMessage(const tccm_monitor::CuboidMap& message, CuboidMap& map);

/// @param report reused: nothing is allocated after a while.
void fromMessage(const tccm_monitor::ScanReport& message, ScanReport& report);

[[nodiscard]] JointTrajectory fromMessage(const trajectory_msgs::JointTrajectory& message);

/// @throws ConfigError naming owner where the shape is unknown or its pose no pose; its sizes are
/// not looked at.
[[nodiscard]] PlacedShape fromMessage(const tccm_monitor::Primitive& message,
                                      const std::string& owner);
[[nodiscard]] tccm_monitor::Primitive toMessage(const PlacedShape& primitive);
/// @throws ConfigError likewise.
[[nodiscard]] AttachedObject fromMessage(const tccm_monitor::AttachedObject& message);
/// The pose in the fixed frame. @throws ConfigError naming owner where it is none.
[[nodiscard]] Pose fromMessage(const geometry_msgs::Pose& message, const std::string& owner);

}  // namespace tccm
