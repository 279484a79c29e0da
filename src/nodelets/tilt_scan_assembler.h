#pragma once

#include <diagnostic_updater/diagnostic_updater.h>
#include <nodelet/nodelet.h>
#include <ros/ros.h>
#include <sensor_msgs/JointState.h>
#include <sensor_msgs/LaserScan.h>
#include <sensor_msgs/PointCloud2.h>
#include <tccm_monitor/AttachedObjects.h>
#include <tccm_monitor/ScanReport.h>

#include <memory>

#include "nodelets/message_pool.h"
#include "ros/scan_source.h"
#include "ros/settings.h"
#include "ros/transform_listener.h"

namespace tccm {

/// Nodelet: `scan`, tf and `joint_states` in; one filtered `scan_cloud` a scan in the fixed frame
/// out. All its callbacks run one after the other.
class TiltScanAssembler : public nodelet::Nodelet {
 private:
  void onInit() override;
  void setUp();
  void receiveScan(const sensor_msgs::LaserScan::ConstPtr& message);
  void receiveJoints(const sensor_msgs::JointState::ConstPtr& message);
  void receiveAttached(const tccm_monitor::AttachedObjects::ConstPtr& message);
  void process();
  void publish(const ScanSource::Ready& ready);
  void reportArrival(const std_msgs::Header& header);
  void reportDrop(Time stamp, const std::string& reason);
  void reportAssembled(const ScanSource::Ready& ready, const ros::Time& now,
                       const ros::WallTime& ready_wall, const BeamCounts& counts);
  void publishMarkers();
  void warnOfDrops();
  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status);

  AssemblerSettings settings_;
  std::shared_ptr<const RobotModel> bare_model_;  ///< with empty hands
  std::unique_ptr<BodySampler> body_;
  std::unique_ptr<ScanAssembler> assembler_;
  std::unique_ptr<TransformListener> transforms_;
  std::unique_ptr<ScanSource> source_;
  AssembledScan assembled_;
  MessagePool<sensor_msgs::PointCloud2> clouds_;
  MessagePool<tccm_monitor::ScanReport> reports_;
  ros::Publisher cloud_publisher_;
  ros::Publisher report_publisher_;
  ros::Subscriber scan_subscriber_;
  ros::Subscriber joints_subscriber_;
  ros::Subscriber attached_subscriber_;
  ros::Publisher marker_publisher_;
  ros::WallTimer marker_timer_;
  ros::WallTimer diagnostics_timer_;
  std::unique_ptr<diagnostic_updater::Updater> diagnostics_;
  std::size_t received_ = 0;
  std::size_t assembled_count_ = 0;
  std::size_t dropped_last_ = 0;
  std::size_t dropped_diagnosed_ = 0;
  std::size_t future_joints_ = 0;
  ros::Time last_scan_;
  BeamCounts beams_{};
};

}  // namespace tccm
