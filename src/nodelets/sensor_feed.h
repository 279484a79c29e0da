#pragma once

#include <ros/ros.h>
#include <sensor_msgs/PointCloud2.h>
#include <tccm_monitor/CloudScan.h>
#include <tccm_monitor/ScanReport.h>

#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "nodelets/diagnosed_nodelet.h"
#include "ros/conversions.h"
#include "ros/handles.h"
#include "ros/published_map.h"
#include "ros/stops/stop_recorder.h"

namespace tccm {

/// What one sensor's assembler and mapper publish, as the checker hears it: `cuboid_map` and
/// `scan_report`, in a namespace of the sensor's name where it has one.
class SensorFeed {
 public:
  using Rate = std::unique_ptr<diagnostic_updater::TopicDiagnostic>;
  /// What is done with it.
  struct Takers {
    std::function<void(SensorFeed&)> map;  ///< a new one
    std::function<void(const SensorFeed&, const tccm_monitor::ScanReport&)> report;
  };

  /// @param watch (topic) -> Rate, of those that are told of in the diagnostics.
  SensorFeed(std::size_t sensor, const std::string& name, std::string fixed_frame, Takers takers,
             const std::function<Rate(const std::string&)>& watch)
      : sensor_(sensor),
        prefix_(name.empty() ? "" : name + "/"),
        fixed_frame_(std::move(fixed_frame)),
        takers_(std::move(takers)),
        scan_rate_(watch(prefix_ + "scan")),
        map_rate_(watch(prefix_ + "cuboid_map")) {}
  void begin(const ros::NodeHandle& node) {
    map_input_ = hear(node, prefix_ + "cuboid_map", 3, &SensorFeed::receiveMap, this);
    report_input_ = hear(node, prefix_ + "scan_report", 50, &SensorFeed::receiveReport, this);
  }

  /// What the sensor's mapper hears, for those who look at stops. @param recorder outlives this.
  void hearPoints(const ros::NodeHandle& node, StopRecorder& recorder) {
    recorder_ = &recorder;
    point_inputs_ = {hear(node, prefix_ + "scan_cloud", 5, &SensorFeed::receiveScan, this),
                     hear(node, prefix_ + "cloud_scan", 3, &SensorFeed::receiveCloud, this)};
  }

  /// Index into the configured sensors.
  [[nodiscard]] std::size_t sensor() const { return sensor_; }
  /// The newest; nothing before the first.
  [[nodiscard]] const PublishedMap::ConstPtr& published() const { return published_; }
  /// The newest report of a scan that was assembled.
  [[nodiscard]] const tccm_monitor::ScanReport& assembled() const { return assembled_; }

  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) const {
    status.add(prefix_ + "cuboid_maps dropped", maps_dropped_);
    if (!defect_.empty()) status.add("last " + prefix_ + "cuboid_map dropped", defect_);
    for (const auto& [reason, count] : scans_dropped_) {
      status.add(prefix_ + "scans dropped: " + reason, count);
    }
  }

 private:
  static constexpr std::size_t kDropReasonsMax = 20;  // the assembler has fewer; others may publish

  void receiveMap(const PublishedMap::ConstPtr& published) {
    defect_ = published->defect;
    if (defect_.empty() && bareName(published->frame) != fixed_frame_) {
      defect_ = "its frame is '" + published->frame + "', fixed_frame is '" + fixed_frame_ + "'";
    }
    if (!defect_.empty()) {
      ++maps_dropped_;
      ROS_ERROR_THROTTLE(5.0, "A %scuboid_map was dropped: %s.", prefix_.c_str(), defect_.c_str());
      return;
    }
    published_ = published;
    map_rate_->tick(toRos(published_->map->stamp));
    takers_.map(*this);
  }

  void receiveReport(const tccm_monitor::ScanReport::ConstPtr& message) {
    if (message->outcome == tccm_monitor::ScanReport::WAITING) {
      scan_rate_->tick(message->header.stamp);
    }
    if (message->outcome == tccm_monitor::ScanReport::DROPPED) countDrop(message->dropped);
    if (message->outcome == tccm_monitor::ScanReport::ASSEMBLED) assembled_ = *message;
    takers_.report(*this, *message);
  }

  void receiveScan(const sensor_msgs::PointCloud2::ConstPtr& message) {
    recorder_->points(toTime(ros::Time::now()), *message, sensor_);
  }
  void receiveCloud(const tccm_monitor::CloudScan::ConstPtr& message) {
    recorder_->points(toTime(ros::Time::now()), *message, sensor_);
  }

  void countDrop(const std::string& reason) {
    const bool known = scans_dropped_.count(reason) > 0 || scans_dropped_.size() < kDropReasonsMax;
    ++scans_dropped_[known ? reason : "other"];
  }

  std::size_t sensor_;
  std::string prefix_;
  std::string fixed_frame_;
  Takers takers_;
  Rate scan_rate_, map_rate_;
  PublishedMap::ConstPtr published_;
  tccm_monitor::ScanReport assembled_;
  std::size_t maps_dropped_ = 0;
  std::string defect_;
  std::map<std::string, std::size_t> scans_dropped_;
  ros::Subscriber map_input_, report_input_;
  StopRecorder* recorder_ = nullptr;
  std::vector<ros::Subscriber> point_inputs_;
};

}  // namespace tccm
