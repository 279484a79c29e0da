#include "nodelets/tilt_scan_assembler.h"

#include <visualization_msgs/MarkerArray.h>

#include <algorithm>
#include <pluginlib/class_list_macros.hpp>
#include <string>

#include "nodelets/markers.h"
#include "nodelets/refusal.h"
#include "ros/conversions.h"
#include "ros/robot_description.h"
#include "tccm_monitor/config_error.h"

namespace tccm {

void TiltScanAssembler::onInit() {
  startOrRefuse(getName(), [this] { setUp(); });
}

void TiltScanAssembler::setUp() {
  ros::NodeHandle& node = getNodeHandle();
  settings_ = readFromServer(getPrivateNodeHandle(), readAssemblerSettings);
  std::vector<std::string> root_frames;
  if (settings_.self_filter) {
    const auto model = sharedRobotModel(node);
    body_ = std::make_unique<BodySampler>(model, settings_.body);
    bare_model_ = model;
    root_frames = model->rootLinks();
  }
  assembler_ = std::make_unique<ScanAssembler>(settings_.assembler);
  cloud_publisher_ = node.advertise<sensor_msgs::PointCloud2>("scan_cloud", 10);
  report_publisher_ = node.advertise<tccm_monitor::ScanReport>("scan_report", 50);
  transforms_ = std::make_unique<TransformListener>(
      node, fromSeconds(settings_.transform_gap_max_s), [this] { process(); });
  source_ = std::make_unique<ScanSource>(settings_, root_frames, transforms_->history());
  source_->onDrop([this](Time stamp, const std::string& reason) { reportDrop(stamp, reason); });
  const auto hints = ros::TransportHints().tcpNoDelay();
  if (body_) {
    joints_subscriber_ =
        node.subscribe("joint_states", 200, &TiltScanAssembler::receiveJoints, this, hints);
    attached_subscriber_ =
        node.subscribe("attached_objects", 5, &TiltScanAssembler::receiveAttached, this);
    marker_publisher_ = node.advertise<visualization_msgs::MarkerArray>("self_filter_markers", 2);
    marker_timer_ = node.createWallTimer(ros::WallDuration(1.0 / settings_.marker_rate_hz),
                                         [this](const ros::WallTimerEvent&) { publishMarkers(); });
  }
  scan_subscriber_ = node.subscribe("scan", 20, &TiltScanAssembler::receiveScan, this, hints);
  diagnostics_ =
      std::make_unique<diagnostic_updater::Updater>(node, getPrivateNodeHandle(), getName());
  diagnostics_->setHardwareID("none");
  diagnostics_->add("scans", this, &TiltScanAssembler::diagnose);
  diagnostics_timer_ =
      node.createWallTimer(ros::WallDuration(0.5), [this](const ros::WallTimerEvent&) {
        process();
        diagnostics_->update();
      });
}

void TiltScanAssembler::receiveScan(const sensor_msgs::LaserScan::ConstPtr& message) {
  ++received_;
  last_scan_ = ros::Time::now();
  reportArrival(message->header);
  const std::string defect =
      source_->add(fromMessage(*message), message->header.frame_id, toTime(last_scan_));
  if (!defect.empty()) NODELET_WARN_THROTTLE(5.0, "A scan was dropped: %s.", defect.c_str());
  process();
}

void TiltScanAssembler::receiveJoints(const sensor_msgs::JointState::ConstPtr& message) {
  const Time stamp = toTime(message->header.stamp);
  if (stamp - toTime(ros::Time::now()) > fromSeconds(settings_.future_max_s)) {
    ++future_joints_;
    return;
  }
  body_->joints().add(stamp, message->name, message->position, message->velocity);
  process();
}

void TiltScanAssembler::receiveAttached(const tccm_monitor::AttachedObjects::ConstPtr& message) {
  std::vector<AttachedObject> objects;
  for (const auto& object : message->objects) {
    try {
      const AttachedObject held = fromMessage(object);
      static_cast<void>(bare_model_->holding({held}));
      objects.push_back(held);
    } catch (const ConfigError& error) {
      // The others are taken all the same: what was detached must not be filtered out any longer.
      NODELET_ERROR("An attached object is not filtered out: %s.", error.what());
    }
  }
  body_->setModel(std::make_shared<const RobotModel>(bare_model_->holding(objects)));
}

void TiltScanAssembler::process() {
  if (!source_) return;
  const JointStates* joints = body_ ? &body_->joints() : nullptr;
  while (const ScanSource::Ready* ready = source_->next(joints, toTime(ros::Time::now()))) {
    publish(*ready);
  }
  warnOfDrops();
}

void TiltScanAssembler::publish(const ScanSource::Ready& ready) {
  static const std::vector<BodySample> kNobody;
  const ros::Time now = ros::Time::now();
  const ros::WallTime ready_wall = ros::WallTime::now();
  if (body_) {
    const std::string unknown =
        body_->sample(ready.scan.stamp, ready.scan.lastBeamTime(), ready.T_fixed_roots);
    if (!unknown.empty()) return source_->countDrop(ready.scan.stamp, unknown);
  }
  const std::string dropped = assembler_->assemble(ready.scan, ready.T_fixed_sensor,
                                                   body_ ? body_->samples() : kNobody, assembled_);
  if (!dropped.empty()) return source_->countDrop(ready.scan.stamp, dropped);
  const BeamCounts counts = assembled_.counts();
  for (std::size_t i = 0; i < kBeamKinds; ++i) beams_[i] += counts[i];
  ++assembled_count_;
  reportAssembled(ready, now, ready_wall, counts);
  const auto cloud = clouds_.take();
  toMessage(assembled_, withoutSlash(settings_.fixed_frame), *cloud);
  cloud_publisher_.publish(sensor_msgs::PointCloud2::ConstPtr(cloud));
}

void TiltScanAssembler::reportArrival(const std_msgs::Header& header) {
  const auto report = reports_.take();
  *report = tccm_monitor::ScanReport();
  report->header = header;
  report->outcome = tccm_monitor::ScanReport::WAITING;
  report_publisher_.publish(tccm_monitor::ScanReport::ConstPtr(report));
}

void TiltScanAssembler::reportDrop(Time stamp, const std::string& reason) {
  const auto report = reports_.take();
  *report = tccm_monitor::ScanReport();
  report->header.stamp = toRos(stamp);
  report->outcome = tccm_monitor::ScanReport::DROPPED;
  report->dropped = reason;
  report_publisher_.publish(tccm_monitor::ScanReport::ConstPtr(report));
}

void TiltScanAssembler::reportAssembled(const ScanSource::Ready& ready, const ros::Time& now,
                                        const ros::WallTime& ready_wall, const BeamCounts& counts) {
  const auto at = [&counts](BeamKind kind) {
    return static_cast<float>(counts[static_cast<std::size_t>(kind)]);
  };
  const float removed = at(BeamKind::kMixedPixel) + at(BeamKind::kSelf) + at(BeamKind::kShadow);
  const float returns = at(BeamKind::kReturn) + removed;
  const auto report = reports_.take();
  *report = tccm_monitor::ScanReport();
  report->header.stamp = toRos(ready.scan.stamp);
  report->outcome = tccm_monitor::ScanReport::ASSEMBLED;
  report->ready_wall.sec = ready_wall.sec;
  report->ready_wall.nsec = ready_wall.nsec;
  report->transform_wait_s = static_cast<float>(toSeconds(toTime(now) - ready.arrival));
  report->measured_fraction = (returns + at(BeamKind::kNoReturn)) /
                              std::max(1.0F, static_cast<float>(ready.scan.ranges.size()));
  report->removed_fraction = returns > 0.0F ? removed / returns : 0.0F;
  report_publisher_.publish(tccm_monitor::ScanReport::ConstPtr(report));
}

void TiltScanAssembler::publishMarkers() {
  if (marker_publisher_.getNumSubscribers() == 0 || body_->samples().empty()) return;
  visualization_msgs::MarkerArray markers;
  toMarkers(body_->samples().back(), withoutSlash(settings_.fixed_frame), markers);
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
                        settings_.fixed_frame.c_str());
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
  status.add("scans assembled", assembled_count_);
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
