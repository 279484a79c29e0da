#pragma once

#include <sensor_msgs/JointState.h>
#include <sensor_msgs/LaserScan.h>
#include <sensor_msgs/PointCloud2.h>
#include <tf2_msgs/TFMessage.h>
#include <trajectory_msgs/JointTrajectory.h>
#include <visualization_msgs/MarkerArray.h>

#include "simulation/simulator.h"

namespace tccm::simulation {

/// @param now where the trajectory starts if it has no stamp.
[[nodiscard]] ArmCommand toCommand(const trajectory_msgs::JointTrajectory& message, Time now);

/// In frame laser_link.
[[nodiscard]] sensor_msgs::LaserScan toMessage(const LaserScan& scan, double scan_period_s);

constexpr char kCameraFrame[] = "camera_depth_optical_frame";
constexpr char kLidarFrame[] = "os_sensor";
constexpr char kCameraTopic[] = "camera/depth/color/points";
constexpr char kLidarTopic[] = "ouster/points";

/// As realsense2_camera lays its clouds out, with ordered_pc.
[[nodiscard]] sensor_msgs::PointCloud2 cameraMessage(const Cloud& cloud);
/// As ouster_ros does: each point's time is in `t`; one that was not measured is at the origin.
[[nodiscard]] sensor_msgs::PointCloud2 lidarMessage(const Cloud& cloud);
/// Of the frames that the camera's and the lidar's clouds are in: those that there are. For
/// /tf_static.
[[nodiscard]] tf2_msgs::TFMessage mountMessage(const Simulator::Config& config);
/// Of one.
[[nodiscard]] tf2_msgs::TFMessage mountMessage(const Mount& mount, const std::string& frame,
                                               Time stamp);

/// All joints that move.
[[nodiscard]] sensor_msgs::JointState jointMessage(const RobotModel& model,
                                                   const RobotSample& sample);

/// One transform for each joint, fixed ones too.
[[nodiscard]] tf2_msgs::TFMessage transformMessage(const RobotModel& model,
                                                   const RobotSample& sample);

/// The scene as it is at an instant, transparent, in place of what was drawn before. @param frame
/// the fixed frame
[[nodiscard]] visualization_msgs::MarkerArray sceneMarkers(const World& world,
                                                           const std::string& frame, Time stamp);

}  // namespace tccm::simulation
