#pragma once

#include <sensor_msgs/JointState.h>
#include <sensor_msgs/LaserScan.h>
#include <sensor_msgs/PointCloud2.h>
#include <tccm_monitor/AttachedObjects.h>
#include <tccm_monitor/ScanReport.h>

#include <memory>
#include <string>

#include "nodelets/diagnosed_nodelet.h"
#include "nodelets/message_pool.h"
#include "ros/scan_source.h"
#include "ros/transform_listener.h"

namespace tccm {

/// Nodelet: `scan`, tf and `joint_states` in; one filtered `scan_cloud` a scan in the fixed frame
/// out.
class TiltScanAssembler : public DiagnosedNodelet {
 public:
  TiltScanAssembler() : DiagnosedNodelet("scans") {}

 private:
  void setUp() override;
  void receiveScan(const sensor_msgs::LaserScan::ConstPtr& message);
  void receiveJoints(const sensor_msgs::JointState::ConstPtr& message);
  void receiveAttached(const tccm_monitor::AttachedObjects::ConstPtr& message);
  void process();
  void publish(const ScanSource::Ready& ready);
  /// A report with nothing but this in it.
  [[nodiscard]] boost::shared_ptr<tccm_monitor::ScanReport> report(Time stamp,
                                                                   std::uint8_t outcome);
  void reportAssembled(const ScanSource::Ready& ready, const ros::Time& now,
                       const ros::WallTime& ready_wall, const BeamCounts& counts);
  void publishMarkers();
  void warnOfDrops();
  void nowAndThen() override { process(); }
  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) override;

  AssemblerConfig config_;
  std::unique_ptr<ScanStage> stage_;
  std::unique_ptr<TransformListener> transforms_;
  std::unique_ptr<ScanSource> source_;
  MessagePool<sensor_msgs::PointCloud2> clouds_;
  MessagePool<tccm_monitor::ScanReport> reports_;
  ros::Publisher cloud_publisher_, report_publisher_, marker_publisher_;
  ros::Subscriber scan_subscriber_, joints_subscriber_, attached_subscriber_;
  ros::WallTimer marker_timer_;
  std::size_t received_ = 0;
  std::size_t assembled_ = 0;
  std::size_t dropped_last_ = 0;
  std::size_t dropped_diagnosed_ = 0;
  std::size_t future_joints_ = 0;
  ros::Time last_scan_;
  BeamCounts beams_{};
};

}  // namespace tccm
