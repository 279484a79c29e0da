#pragma once

#include <sensor_msgs/JointState.h>
#include <tccm_monitor/AttachedObjects.h>
#include <tccm_monitor/ScanReport.h>

#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "nodelets/diagnosed_nodelet.h"
#include "nodelets/markers.h"
#include "nodelets/scan_tracer.h"
#include "ros/cloud_scan.h"
#include "ros/conversions.h"
#include "ros/scan_source.h"
#include "ros/server_config.h"
#include "tccm_monitor/config_error.h"

namespace tccm {

/// What the assemblers of scans and of clouds have in common: they wait for transforms and joint
/// states, filter the robot out, and report what became of each scan.
template <typename Config, typename Stage, typename Source>
class AssemblerNodelet : public DiagnosedNodelet {
 protected:
  /// @param what one of what comes in is called.
  explicit AssemblerNodelet(const std::string& what) : DiagnosedNodelet(what + "s"), one_(what) {}

  /// From what has come in to what goes out.
  virtual void publish(const typename Source::Ready& ready) = 0;

  /// Reads the configuration, and makes stage and source. @param stage_of of the configuration.
  template <typename StageOf>
  void setUpStage(StageOf&& stage_of) {
    config_ = configFrom<Config>(privateNode());
    tellDifferences(privateNode(), config_);
    config_.fixed_frame = withoutSlash(config_.fixed_frame);
    model_ = stage_of(config_).self_filter ? sharedRobotModel(node()) : nullptr;
    stage_ = std::make_unique<Stage>(stage_of(config_), model_);
    transforms_ = std::make_unique<TransformHistory>(fromSeconds(config_.transform_gap_max_s));
  }
  [[nodiscard]] std::vector<std::string> rootFrames() const {
    return model_ ? model_->rootFrames() : std::vector<std::string>();
  }
  /// Takes the source, and hears all but what is assembled.
  void hearInputs(std::unique_ptr<Source> source) {
    source_ = std::move(source);
    source_->onDrop([this](const ScanReport& report) { drop(report); });
    filtered_publisher_ = advertise<sensor_msgs::PointCloud2>(node(), "filtered_cloud", 2);
    report_publisher_ = advertise<tccm_monitor::ScanReport>(node(), "scan_report", 50);
    trace_.begin(node());
    if (model_) {
      marker_publisher_ =
          advertise<visualization_msgs::MarkerArray>(node(), "self_filter_markers", 2);
      marker_timer_ = timer(1.0 / config_.marker_rate_hz, [this] { publishMarkers(); });
    }
    inputs_ = hearTransforms(node(), *transforms_, [this](const auto&...) { process(); });
    if (!model_) return;
    inputs_.push_back(hear("joint_states", 200, &AssemblerNodelet::receiveJoints));
    inputs_.push_back(hear("attached_objects", 5, &AssemblerNodelet::receiveAttached));
  }

  /// Tells of a message that came in.
  void noteArrival(const std_msgs::Header& header) {
    ++received_;
    last_scan_ = ros::Time::now();
    arrived_report_.header = header;
    arrived_report_.outcome = tccm_monitor::ScanReport::WAITING;
    report(arrived_report_);
  }
  void process() {
    const Time now = toTime(ros::Time::now());
    transforms_->setNow(now);
    while (const auto* ready = source_->next(stage_->joints(), now)) {
      publish(*ready);
    }
  }

  /// When all that a scan needs was there.
  struct Moment {
    ros::Time time = ros::Time::now();
    ros::WallTime wall = ros::WallTime::now();
  };
  /// Tells of what was assembled. @param counts of its beams.
  void noteAssembled(const typename Source::Ready& ready, const BeamCounts& counts,
                     const Moment& since) {
    for (std::size_t i = 0; i < kBeamKinds; ++i) beams_[i] += counts[i];
    ++assembled_;
    fill(counts, assembled_report_);
    assembled_report_.header.stamp = toRos(firstTimeOf(ready.scan));
    assembled_report_.ready_wall = ros::Time(since.wall.sec, since.wall.nsec);
    assembled_report_.transform_wait_s =
        static_cast<float>(toSeconds(toTime(since.time) - ready.arrival));
    assembled_report_.self_link = stage_->selfLink();
    report(assembled_report_);
  }

  [[nodiscard]] bool isFilteredCloudHeard() const {
    return filtered_publisher_.getNumSubscribers() > 0;
  }
  void publishFilteredCloud(const ScanReturns& returns) {
    const auto message = filtered_clouds_.take();
    toPoints(returns, config_.fixed_frame, *message);
    filtered_publisher_.publish(sensor_msgs::PointCloud2::ConstPtr(message));
  }

  [[nodiscard]] const Config& config() const { return config_; }
  [[nodiscard]] Stage& stage() { return *stage_; }
  [[nodiscard]] Source& source() { return *source_; }
  [[nodiscard]] ScanTracer& trace() { return trace_; }
  [[nodiscard]] const TransformHistory& transforms() const { return *transforms_; }
  [[nodiscard]] Time lastArrival() const { return toTime(last_scan_); }
  void add(ros::Subscriber input) { inputs_.push_back(std::move(input)); }

 private:
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

  static void fill(const BeamCounts& counts, tccm_monitor::ScanReport& report) {
    std::size_t beams = 0;
    for (const std::size_t count : counts) beams += count;
    const auto at = [&counts](BeamKind kind) {
      return static_cast<float>(counts[static_cast<std::size_t>(kind)]);
    };
    const float removed = at(BeamKind::kMixedPixel) + at(BeamKind::kSelf) + at(BeamKind::kShadow);
    const float returns = at(BeamKind::kReturn) + removed;
    report.outcome = tccm_monitor::ScanReport::ASSEMBLED;
    report.measured_fraction = (returns + at(BeamKind::kThinned) + at(BeamKind::kNoReturn)) /
                               std::max(1.0F, static_cast<float>(beams));
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
    NODELET_WARN_THROTTLE(5.0, "A %s was dropped: %s. So far:%s.", one_.c_str(),
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
    marker_publisher_.publish(toMarkers(samples.back(), config_.fixed_frame));
  }

  void nowAndThen() override { process(); }

  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) override {
    using diagnostic_msgs::DiagnosticStatus;
    const double silence = (ros::Time::now() - last_scan_).toSec();
    if (received_ == 0) {
      status.summary(DiagnosticStatus::ERROR, "no " + one_ + " yet");
    } else if (silence > 1.0) {
      status.summaryf(DiagnosticStatus::ERROR, "no %s for %.1f s", one_.c_str(), silence);
    } else if (source_->droppedCount() > dropped_diagnosed_) {
      status.summary(DiagnosticStatus::WARN, one_ + "s were dropped lately");
    } else {
      status.summary(DiagnosticStatus::OK, one_ + "s are assembled");
    }
    dropped_diagnosed_ = source_->droppedCount();
    status.add(one_ + "s received", received_);
    status.add(one_ + "s assembled", assembled_);
    status.add(one_ + "s waiting", source_->waiting());
    for (const auto& [reason, count] : source_->dropped()) {
      status.add(one_ + "s dropped: " + reason, count);
    }
    status.add("joint states dropped: stamped in the future", future_joints_);
    if (!transforms_->defect().empty()) status.add("tf", transforms_->defect());
    const char* const kinds[kBeamKinds] = {"kept",        "no return", "too close", "unknown",
                                           "mixed pixel", "self",      "shadow",    "thinned"};
    for (std::size_t i = 0; i < kBeamKinds; ++i) {
      status.add(std::string("beams: ") + kinds[i], beams_[i]);
    }
  }

  std::string one_;
  Config config_;
  std::shared_ptr<const RobotModel> model_;
  std::unique_ptr<Stage> stage_;
  std::unique_ptr<TransformHistory> transforms_;
  std::unique_ptr<Source> source_;
  ScanTracer trace_;
  MessagePool<tccm_monitor::ScanReport> reports_;
  tccm_monitor::ScanReport arrived_report_, assembled_report_;  ///< reused
  std::size_t received_ = 0;
  std::size_t assembled_ = 0;
  std::size_t dropped_diagnosed_ = 0;
  std::size_t future_joints_ = 0;
  ros::Time last_scan_;
  BeamCounts beams_{};
  MessagePool<sensor_msgs::PointCloud2> filtered_clouds_;
  ros::Publisher report_publisher_, marker_publisher_, filtered_publisher_;
  std::vector<ros::Subscriber> inputs_;
  ros::WallTimer marker_timer_;
};

}  // namespace tccm
