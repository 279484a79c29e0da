#include <sensor_msgs/JointState.h>
#include <tccm_monitor/AttachedObjects.h>
#include <tccm_monitor/ScanReport.h>

#include <algorithm>
#include <memory>
#include <pluginlib/class_list_macros.hpp>
#include <string>
#include <vector>

#include "nodelets/diagnosed_nodelet.h"
#include "nodelets/markers.h"
#include "ros/conversions.h"
#include "ros/scan_source.h"
#include "ros/server_config.h"
#include "tccm_monitor/config_error.h"

namespace tccm {

/// Nodelet: `scan`, tf and `joint_states` in; one filtered `scan_cloud` a scan in the fixed frame
/// out.
class TiltScanAssembler : public DiagnosedNodelet {
 public:
  TiltScanAssembler() : DiagnosedNodelet("scans") {}
  ~TiltScanAssembler() override { end(); }

 private:
  void setUp() override {
    config_ = configFrom<AssemblerConfig>(privateNode());
    tellDifferences(privateNode(), config_);
    const auto model = config_.scan.self_filter ? sharedRobotModel(node()) : nullptr;
    stage_ = std::make_unique<ScanStage>(config_.scan, model);
    transforms_ = std::make_unique<TransformHistory>(fromSeconds(config_.transform_gap_max_s));
    source_ = std::make_unique<ScanSource>(
        config_, model ? model->rootFrames() : std::vector<std::string>(), *transforms_);
    source_->onDrop([this](const ScanReport& report) { drop(report); });
    cloud_publisher_ = advertise<sensor_msgs::PointCloud2>(node(), "scan_cloud", 10);
    report_publisher_ = advertise<tccm_monitor::ScanReport>(node(), "scan_report", 50);
    if (model) {
      marker_publisher_ =
          advertise<visualization_msgs::MarkerArray>(node(), "self_filter_markers", 2);
      marker_timer_ = timer(1.0 / config_.marker_rate_hz, [this] { publishMarkers(); });
    }
    inputs_ = hearTransforms(node(), *transforms_, [this] { process(); });
    if (model) {
      inputs_.push_back(hear("joint_states", 200, &TiltScanAssembler::receiveJoints));
      inputs_.push_back(hear("attached_objects", 5, &TiltScanAssembler::receiveAttached));
    }
    inputs_.push_back(hear("scan", 20, &TiltScanAssembler::receiveScan));
  }

  void receiveScan(const sensor_msgs::LaserScan::ConstPtr& message) {
    ++received_;
    last_scan_ = ros::Time::now();
    tccm_monitor::ScanReport arrived;
    arrived.header = message->header;
    arrived.outcome = tccm_monitor::ScanReport::WAITING;
    report(arrived);
    source_->add(fromMessage(*message), message->header.frame_id, toTime(last_scan_));
    process();
  }

  void receiveJoints(const sensor_msgs::JointState::ConstPtr& message) {
    const bool taken = stage_->addJoints(toTime(ros::Time::now()), toTime(message->header.stamp),
                                         message->name, message->position, message->velocity);
    if (!taken) ++future_joints_;
    if (taken) process();
  }

  void receiveAttached(const tccm_monitor::AttachedObjects::ConstPtr& message) {
    const auto tell = [this](const std::string& defect) {
      NODELET_ERROR("An attached object is not filtered out: %s.", defect.c_str());
    };
    std::vector<AttachedObject> objects;
    for (const auto& object : message->objects) {
      try {
        objects.push_back(fromMessage(object));
      } catch (const ConfigError& error) {
        tell(error.what());
      }
    }
    for (const std::string& defect : stage_->hold(objects)) tell(defect);
  }

  void process() {
    while (const auto* ready = source_->next(stage_->joints(), toTime(ros::Time::now()))) {
      publish(*ready);
    }
  }

  void publish(const ScanSource::Ready& ready) {
    const ros::Time now = ros::Time::now();
    const ros::WallTime ready_wall = ros::WallTime::now();
    const std::string dropped =
        stage_->assemble(ready.scan, ready.T_fixed_sensor, ready.T_fixed_roots);
    if (!dropped.empty()) return source_->countDrop(ready.scan.stamp, dropped, "");
    const BeamCounts counts = stage_->scan().counts();
    for (std::size_t i = 0; i < kBeamKinds; ++i) beams_[i] += counts[i];
    ++assembled_;
    fill(counts, ready.scan.ranges.size(), assembled_report_);
    assembled_report_.header.stamp = toRos(ready.scan.stamp);
    assembled_report_.ready_wall = ros::Time(ready_wall.sec, ready_wall.nsec);
    assembled_report_.transform_wait_s = static_cast<float>(toSeconds(toTime(now) - ready.arrival));
    assembled_report_.self_link = stage_->selfLink();
    report(assembled_report_);
    const auto cloud = clouds_.take();
    toMessage(stage_->scan(), withoutSlash(config_.fixed_frame), *cloud);
    cloud_publisher_.publish(sensor_msgs::PointCloud2::ConstPtr(cloud));
  }

  static void fill(const BeamCounts& counts, std::size_t beams, tccm_monitor::ScanReport& report) {
    const auto at = [&counts](BeamKind kind) {
      return static_cast<float>(counts[static_cast<std::size_t>(kind)]);
    };
    const float removed = at(BeamKind::kMixedPixel) + at(BeamKind::kSelf) + at(BeamKind::kShadow);
    const float returns = at(BeamKind::kReturn) + removed;
    report.outcome = tccm_monitor::ScanReport::ASSEMBLED;
    report.measured_fraction =
        (returns + at(BeamKind::kNoReturn)) / std::max(1.0F, static_cast<float>(beams));
    report.removed_fraction = returns > 0.0F ? removed / returns : 0.0F;
  }

  void drop(const ScanReport& what) {
    tccm_monitor::ScanReport dropped;
    dropped.header.stamp = toRos(what.stamp);
    dropped.outcome = tccm_monitor::ScanReport::DROPPED;
    dropped.dropped = what.dropped;
    dropped.detail = what.detail;
    report(dropped);
    std::string counts;
    for (const auto& [why, count] : source_->dropped()) {
      counts += " " + why + " " + std::to_string(count);
    }
    NODELET_WARN_THROTTLE(5.0, "A scan was dropped: %s. So far:%s.",
                          (what.detail.empty() ? what.dropped : what.detail).c_str(),
                          counts.c_str());
  }

  void report(const tccm_monitor::ScanReport& report) {
    const auto message = reports_.take();
    *message = report;
    report_publisher_.publish(tccm_monitor::ScanReport::ConstPtr(message));
  }

  void publishMarkers() {
    const auto& samples = stage_->body()->samples();
    if (marker_publisher_.getNumSubscribers() == 0 || samples.empty()) return;
    marker_publisher_.publish(toMarkers(samples.back(), withoutSlash(config_.fixed_frame)));
  }

  void nowAndThen() override { process(); }

  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) override {
    using diagnostic_msgs::DiagnosticStatus;
    const double silence = (ros::Time::now() - last_scan_).toSec();
    if (received_ == 0) {
      status.summary(DiagnosticStatus::ERROR, "no scan yet");
    } else if (silence > 1.0) {
      status.summaryf(DiagnosticStatus::ERROR, "no scan for %.1f s", silence);
    } else if (source_->droppedCount() > dropped_diagnosed_) {
      status.summary(DiagnosticStatus::WARN, "scans were dropped lately");
    } else {
      status.summary(DiagnosticStatus::OK, "scans are assembled");
    }
    dropped_diagnosed_ = source_->droppedCount();
    status.add("scans received", received_);
    status.add("scans assembled", assembled_);
    status.add("scans waiting", source_->waiting());
    for (const auto& [reason, count] : source_->dropped()) {
      status.add("scans dropped: " + reason, count);
    }
    status.add("joint states dropped: stamped in the future", future_joints_);
    if (!transforms_->defect().empty()) status.add("tf", transforms_->defect());
    const char* const kinds[kBeamKinds] = {"kept",        "no return", "too close", "unknown",
                                           "mixed pixel", "self",      "shadow"};
    for (std::size_t i = 0; i < kBeamKinds; ++i) {
      status.add(std::string("beams: ") + kinds[i], beams_[i]);
    }
  }

  AssemblerConfig config_;
  std::unique_ptr<ScanStage> stage_;
  std::unique_ptr<TransformHistory> transforms_;
  std::unique_ptr<ScanSource> source_;
  MessagePool<tccm_monitor::ScanReport> reports_;
  tccm_monitor::ScanReport assembled_report_;  ///< reused
  MessagePool<sensor_msgs::PointCloud2> clouds_;
  std::size_t received_ = 0;
  std::size_t assembled_ = 0;
  std::size_t dropped_diagnosed_ = 0;
  std::size_t future_joints_ = 0;
  ros::Time last_scan_;
  BeamCounts beams_{};
  ros::Publisher cloud_publisher_, report_publisher_, marker_publisher_;
  std::vector<ros::Subscriber> inputs_;
  ros::WallTimer marker_timer_;
};

}  // namespace tccm

PLUGINLIB_EXPORT_CLASS(tccm::TiltScanAssembler, nodelet::Nodelet)
