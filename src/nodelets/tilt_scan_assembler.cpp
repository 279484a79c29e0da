#include "nodelets/tilt_scan_assembler.h"

#include <visualization_msgs/MarkerArray.h>

#include <algorithm>
#include <pluginlib/class_list_macros.hpp>

#include "nodelets/markers.h"
#include "ros/conversions.h"
#include "ros/robot_description.h"
#include "ros/server_config.h"
#include "tccm_monitor/config_error.h"

namespace tccm {

void TiltScanAssembler::setUp() {
  ros::NodeHandle& node = getNodeHandle();
  config_ = configFrom<AssemblerConfig>(getPrivateNodeHandle());
  const auto model = config_.scan.self_filter ? sharedRobotModel(node) : nullptr;
  stage_ = std::make_unique<ScanStage>(config_.scan, model);
  cloud_publisher_ = node.advertise<sensor_msgs::PointCloud2>("scan_cloud", 10);
  report_publisher_ = node.advertise<tccm_monitor::ScanReport>("scan_report", 50);
  transforms_ = std::make_unique<TransformListener>(node, fromSeconds(config_.transform_gap_max_s),
                                                    [this] { process(); });
  source_ = std::make_unique<ScanSource>(
      config_, model ? model->rootLinks() : std::vector<std::string>(), transforms_->history());
  source_->onDrop([this](Time stamp, const std::string& reason) {
    const auto dropped = report(stamp, tccm_monitor::ScanReport::DROPPED);
    dropped->dropped = reason;
    report_publisher_.publish(tccm_monitor::ScanReport::ConstPtr(dropped));
  });
  const auto hints = ros::TransportHints().tcpNoDelay();
  if (model) {
    joints_subscriber_ =
        node.subscribe("joint_states", 200, &TiltScanAssembler::receiveJoints, this, hints);
    attached_subscriber_ =
        node.subscribe("attached_objects", 5, &TiltScanAssembler::receiveAttached, this);
    marker_publisher_ = node.advertise<visualization_msgs::MarkerArray>("self_filter_markers", 2);
    marker_timer_ = timer(1.0 / config_.marker_rate_hz, [this] { publishMarkers(); });
  }
  scan_subscriber_ = node.subscribe("scan", 20, &TiltScanAssembler::receiveScan, this, hints);
}

void TiltScanAssembler::receiveScan(const sensor_msgs::LaserScan::ConstPtr& message) {
  ++received_;
  last_scan_ = ros::Time::now();
  const auto arrived = report({}, tccm_monitor::ScanReport::WAITING);
  arrived->header = message->header;
  report_publisher_.publish(tccm_monitor::ScanReport::ConstPtr(arrived));
  const std::string defect =
      source_->add(fromMessage(*message), message->header.frame_id, toTime(last_scan_));
  if (!defect.empty()) NODELET_WARN_THROTTLE(5.0, "A scan was dropped: %s.", defect.c_str());
  process();
}

void TiltScanAssembler::receiveJoints(const sensor_msgs::JointState::ConstPtr& message) {
  const bool taken = stage_->addJoints(toTime(ros::Time::now()), toTime(message->header.stamp),
                                       message->name, message->position, message->velocity);
  if (taken) {
    process();
  } else {
    ++future_joints_;
  }
}

void TiltScanAssembler::receiveAttached(const tccm_monitor::AttachedObjects::ConstPtr& message) {
  std::vector<AttachedObject> objects;
  std::vector<std::string> defects;
  for (const auto& object : message->objects) {
    try {
      objects.push_back(fromMessage(object));
    } catch (const ConfigError& error) {
      defects.emplace_back(error.what());
    }
  }
  for (const std::string& defect : stage_->hold(objects)) defects.push_back(defect);
  for (const std::string& defect : defects) {
    NODELET_ERROR("An attached object is not filtered out: %s.", defect.c_str());
  }
}

void TiltScanAssembler::process() {
  if (!source_) return;
  while (const auto* ready = source_->next(stage_->joints(), toTime(ros::Time::now()))) {
    publish(*ready);
  }
  warnOfDrops();
}

void TiltScanAssembler::publish(const ScanSource::Ready& ready) {
  const ros::Time now = ros::Time::now();
  const ros::WallTime ready_wall = ros::WallTime::now();
  const std::string dropped =
      stage_->assemble(ready.scan, ready.T_fixed_sensor, ready.T_fixed_roots);
  if (!dropped.empty()) return source_->countDrop(ready.scan.stamp, dropped);
  const BeamCounts counts = stage_->scan().counts();
  for (std::size_t i = 0; i < kBeamKinds; ++i) beams_[i] += counts[i];
  ++assembled_;
  reportAssembled(ready, now, ready_wall, counts);
  const auto cloud = clouds_.take();
  toMessage(stage_->scan(), withoutSlash(config_.fixed_frame), *cloud);
  cloud_publisher_.publish(sensor_msgs::PointCloud2::ConstPtr(cloud));
}

boost::shared_ptr<tccm_monitor::ScanReport> TiltScanAssembler::report(Time stamp,
                                                                      std::uint8_t outcome) {
  const auto report = reports_.take();
  *report = tccm_monitor::ScanReport();
  report->header.stamp = toRos(stamp);
  report->outcome = outcome;
  return report;
}

void TiltScanAssembler::reportAssembled(const ScanSource::Ready& ready, const ros::Time& now,
                                        const ros::WallTime& ready_wall, const BeamCounts& counts) {
  const auto at = [&counts](BeamKind kind) {
    return static_cast<float>(counts[static_cast<std::size_t>(kind)]);
  };
  const float removed = at(BeamKind::kMixedPixel) + at(BeamKind::kSelf) + at(BeamKind::kShadow);
  const float returns = at(BeamKind::kReturn) + removed;
  const auto done = report(ready.scan.stamp, tccm_monitor::ScanReport::ASSEMBLED);
  done->ready_wall.sec = ready_wall.sec;
  done->ready_wall.nsec = ready_wall.nsec;
  done->transform_wait_s = static_cast<float>(toSeconds(toTime(now) - ready.arrival));
  done->measured_fraction = (returns + at(BeamKind::kNoReturn)) /
                            std::max(1.0F, static_cast<float>(ready.scan.ranges.size()));
  done->removed_fraction = returns > 0.0F ? removed / returns : 0.0F;
  report_publisher_.publish(tccm_monitor::ScanReport::ConstPtr(done));
}

void TiltScanAssembler::publishMarkers() {
  const auto& samples = stage_->body()->samples();
  if (marker_publisher_.getNumSubscribers() == 0 || samples.empty()) return;
  visualization_msgs::MarkerArray markers;
  toMarkers(samples.back(), withoutSlash(config_.fixed_frame), markers);
  marker_publisher_.publish(markers);
}

void TiltScanAssembler::warnOfDrops() {
  const std::size_t dropped = source_->droppedCount();
  if (dropped == dropped_last_) return;
  dropped_last_ = dropped;
  std::string reasons;
  for (const auto& entry : source_->dropped()) {
    reasons += " " + entry.first + " " + std::to_string(entry.second);
  }
  NODELET_WARN_THROTTLE(5.0, "Scans dropped so far:%s (fixed_frame '%s').", reasons.c_str(),
                        config_.fixed_frame.c_str());
}

void TiltScanAssembler::diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) {
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
  for (const auto& entry : source_->dropped()) {
    status.add("scans dropped: " + entry.first, entry.second);
  }
  status.add("joint states dropped: stamped in the future", future_joints_);
  const char* const kinds[kBeamKinds] = {"kept",        "no return", "too close", "unknown",
                                         "mixed pixel", "self",      "shadow"};
  for (std::size_t i = 0; i < kBeamKinds; ++i) {
    status.add(std::string("beams: ") + kinds[i], beams_[i]);
  }
}

}  // namespace tccm

PLUGINLIB_EXPORT_CLASS(tccm::TiltScanAssembler, nodelet::Nodelet)
