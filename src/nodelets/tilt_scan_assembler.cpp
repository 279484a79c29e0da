#include <pluginlib/class_list_macros.hpp>

#include "nodelets/assembler_nodelet.h"

namespace tccm {

/// Nodelet: `scan`, tf and `joint_states` in; one filtered `scan_cloud` a scan in the fixed frame
/// out.
class TiltScanAssembler : public AssemblerNodelet<AssemblerConfig, ScanStage, ScanSource> {
 public:
  TiltScanAssembler() : AssemblerNodelet("scan") {}
  ~TiltScanAssembler() override { end(); }

 private:
  void setUp() override {
    setUpStage([](const AssemblerConfig& config) { return config.scan; });
    cloud_publisher_ = advertise<sensor_msgs::PointCloud2>(node(), "scan_cloud", 10);
    hearInputs(std::make_unique<ScanSource>(config(), rootFrames(), transforms()));
    add(hear("scan", 20, &TiltScanAssembler::receiveScan));
  }

  void receiveScan(const sensor_msgs::LaserScan::ConstPtr& message) {
    noteArrival(message->header);
    fromMessage(*message, scan_);
    source().add(scan_, message->header.frame_id, lastArrival());
    process();
  }

  void publish(const ScanSource::Ready& ready) override {
    const Moment since;
    trace().forget();
    trace().note("scan and transforms are there");
    const std::string dropped =
        stage().assemble(*ready.scan, ready.T_fixed_sensor, ready.T_fixed_roots);
    if (!dropped.empty()) return source().countDrop(ready.scan->stamp, dropped, "");
    trace().note("assembled");
    noteAssembled(ready, stage().scan().counts(), since);
    const auto cloud = clouds_.take();
    toMessage(stage().scan(), config().fixed_frame, *cloud);
    cloud_publisher_.publish(sensor_msgs::PointCloud2::ConstPtr(cloud));
    trace().note("scan_cloud is published");
    trace().publish(cloud->header.stamp);
    if (!isFilteredCloudHeard()) return;
    takeReturns(stage().scan(), returns_);
    publishFilteredCloud(returns_);
  }

  MessagePool<sensor_msgs::PointCloud2> clouds_;
  LaserScan scan_;
  ScanReturns returns_;
  ros::Publisher cloud_publisher_;
};

}  // namespace tccm

PLUGINLIB_EXPORT_CLASS(tccm::TiltScanAssembler, nodelet::Nodelet)
