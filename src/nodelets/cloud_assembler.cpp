#include <pluginlib/class_list_macros.hpp>

#include "nodelets/assembler_nodelet.h"
#include "ros/cloud_reader.h"
#include "ros/cloud_scan.h"
#include "ros/cloud_source.h"

namespace tccm {

/// Nodelet: `cloud_in` of a camera or lidar, tf and `joint_states` in; one filtered `cloud_scan` a
/// cloud in the fixed frame out.
class CloudAssembler : public AssemblerNodelet<CloudAssemblerConfig, CloudStage, CloudSource> {
 public:
  CloudAssembler() : AssemblerNodelet("cloud") {}
  ~CloudAssembler() override { end(); }

 private:
  void setUp() override {
    setUpStage([](const CloudAssemblerConfig& config) { return config.cloud; });
    reader_.emplace(config().cloud.limits);
    cloud_publisher_ = advertise<tccm_monitor::CloudScan>(node(), "cloud_scan", 3);
    hearInputs(std::make_unique<CloudSource>(config(), rootFrames(), transforms()));
    add(hear("cloud_in", 3, &CloudAssembler::receiveCloud));
  }

  void receiveCloud(const sensor_msgs::PointCloud2::ConstPtr& message) {
    noteArrival(message->header);
    const SharedCloud cloud = clouds_.take();
    const std::string defect = reader_->read(*message, *cloud);
    cloud->stamp = toTime(message->header.stamp);
    source().add(cloud, message->header.frame_id, lastArrival(), defect);
    process();
  }

  void publish(const CloudSource::Ready& ready) override {
    const Moment since;
    trace().forget();
    trace().note("scan and transforms are there");
    const std::string dropped =
        stage().assemble(*ready.scan, ready.T_fixed_sensor, ready.T_fixed_roots);
    if (!dropped.empty()) return source().countDrop(ready.scan->stamp, dropped, "");
    trace().note("assembled");
    noteAssembled(ready, stage().counts(), since);
    const auto message = messages_.take();
    toMessage(stage().returns(), config().fixed_frame, *message);
    cloud_publisher_.publish(tccm_monitor::CloudScan::ConstPtr(message));
    trace().note("cloud_scan is published");
    trace().publish(message->header.stamp);
    if (isFilteredCloudHeard()) publishFilteredCloud(stage().returns());
  }

  std::optional<CloudReader> reader_;
  MessagePool<Cloud> clouds_;
  MessagePool<tccm_monitor::CloudScan> messages_;
  ros::Publisher cloud_publisher_;
};

}  // namespace tccm

PLUGINLIB_EXPORT_CLASS(tccm::CloudAssembler, nodelet::Nodelet)
