#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/duration_text.h"
#include "monitor_config.h"
#include "robot/joint_states.h"
#include "ros/message_pool.h"
#include "ros/transform_history.h"
#include "scan/assembled_scan.h"
#include "tccm_monitor/laser_scan.h"
#include "tccm_monitor/pose.h"
#include "tccm_monitor/verdict.h"

namespace tccm {

using SharedScan = boost::shared_ptr<const LaserScan>;
// What a source asks of what it holds.
[[nodiscard]] inline Time stampOf(const SharedScan& scan) { return scan->stamp; }
[[nodiscard]] inline Time firstTimeOf(const SharedScan& scan) { return scan->stamp; }
[[nodiscard]] inline Time lastTimeOf(const SharedScan& scan) { return scan->lastBeamTime(); }

/// Holds scans, or clouds, until transforms (and joint states, where a robot is filtered out)
/// around all of their beams are there, or it is clear that they will not come. Scans leave in the
/// order they came in; nothing waits. @tparam Scan is shared with whoever uses its memory again.
template <typename Scan>
class WaitingScans {
 public:
  struct Config {
    std::string fixed_frame;
    double future_max_s;
    double transform_sample_s;
    double transform_wait_max_s;
    std::size_t waiting_max = 100;  ///< more means that transforms never come
  };
  /// @param root_frames those of the robot that is filtered out, in its model's order; none where
  /// no robot is.
  WaitingScans(const Config& config, const std::vector<std::string>& root_frames,
               const TransformHistory& transforms)
      : config_(config), root_frames_(root_frames), transforms_(transforms) {
    config_.fixed_frame = withoutSlash(config.fixed_frame);
  }

  /// A scan with all that is needed to place its beams.
  struct Ready {
    Scan scan;
    Time arrival;
    PosePath T_fixed_sensor;
    std::vector<PosePath> T_fixed_roots;
  };

  /// Called for each scan that is dropped.
  void onDrop(std::function<void(const ScanReport&)> told) { told_ = std::move(told); }

  /// A scan that has a defect, is stamped in the future or has another frame than the one before
  /// is dropped here. @param defect why it cannot be used at all; empty where it can.
  void add(Scan scan, const std::string& frame, Time arrival, const std::string& defect) {
    const std::string_view from = bareName(frame);
    const bool is_new = frame_ != from;
    const std::string before = is_new ? std::exchange(frame_, std::string(from)) : std::string();
    const Time stamp = stampOf(scan);
    if (!defect.empty()) return countDrop(stamp, "malformed", defect);
    if (!before.empty()) {
      return countDrop(stamp, "frame_changed",
                       "a scan's frame is '" + frame_ + "', that of the scan before was '" +
                           before + "': let each sensor have a topic of its own");
    }
    if (stamp - arrival > fromSeconds(config_.future_max_s)) {
      return countDrop(stamp, "future_stamp", stampText(stamp, arrival));
    }
    if (waiting() == config_.waiting_max) {
      const Waiting& oldest = waiting_.front();
      countDrop(stampOf(oldest.scan), "no_transform", whyNotPlaced(oldest, arrival));
      popOldest();
    }
    if (waiting() == waiting_.size()) waiting_.emplace_back();
    Waiting& newest = waiting_[waiting_count_++];
    newest.scan = std::move(scan);
    newest.frame = from;
    newest.arrival = arrival;
  }
  void clear() {
    while (waiting() > 0) popOldest();
    frame_.clear();
  }

  /// The oldest scan that can be placed now. Those before it that cannot are dropped and counted.
  /// @param joints nothing where no robot is filtered out. @param now for how long a scan waited.
  [[nodiscard]] const Ready* next(const JointStates* joints, Time now) {
    const Duration wait_max = fromSeconds(config_.transform_wait_max_s);
    for (; waiting() > 0; popOldest()) {
      Waiting& scan = waiting_.front();
      if (now < scan.arrival) {  // time began anew
        countDrop(stampOf(scan.scan), "time_jump", "time jumped back while it waited");
        continue;
      }
      const Status status = place(scan, joints);
      if (status == Status::kNotYet && now - scan.arrival <= wait_max) return nullptr;
      if (status == Status::kFound) {
        ready_.scan = std::move(scan.scan);
        ready_.arrival = scan.arrival;
        popOldest();
        return &ready_;
      }
      const bool joints_missing = status == Status::kNotYet && !covers(joints, scan.scan);
      if (joints_missing) {
        countDrop(stampOf(scan.scan), "no_joint_states",
                  "no joint states around its beams came; " + stampText(stampOf(scan.scan), now));
      } else {
        countDrop(stampOf(scan.scan), TransformHistory::name(status), whyNotPlaced(scan, now));
      }
    }
    return nullptr;
  }
  /// Drops what still waits. @param joints as for next().
  void drain(const JointStates* joints) {
    for (; waiting() > 0; popOldest()) {
      const Waiting& scan = waiting_.front();
      if (!covers(joints, scan.scan)) {
        countDrop(stampOf(scan.scan), "no_joint_states",
                  "the recording ended before joint states around its beams came");
        continue;
      }
      const std::string unknown = unknownFrame(scan);
      countDrop(stampOf(scan.scan), "no_transform",
                unknown.empty() ? "the recording ended before its transforms came" : unknown);
    }
  }

  /// How many scans were dropped, by reason.
  [[nodiscard]] const std::map<std::string, std::size_t>& dropped() const { return dropped_; }
  [[nodiscard]] std::size_t droppedCount() const { return dropped_count_; }
  /// For a scan that failed after it left.
  void countDrop(Time stamp, const std::string& reason, const std::string& detail) {
    ++dropped_[reason];
    ++dropped_count_;
    if (told_) told_({stamp, ScanReport::Outcome::kDropped, reason, detail});
  }
  [[nodiscard]] std::size_t waiting() const { return waiting_count_; }

 private:
  using Status = TransformHistory::Status;
  struct Waiting {
    Scan scan;
    std::string frame;
    Time arrival;
  };

  /// Its memory is kept for a later one.
  void popOldest() {
    waiting_.front().scan.reset();
    const auto begin = waiting_.begin();
    std::rotate(begin, begin + 1, begin + static_cast<std::ptrdiff_t>(waiting_count_));
    --waiting_count_;
  }

  static bool covers(const JointStates* joints, const Scan& scan) {
    if (!joints) return true;
    const auto until = joints->answersUntil();
    return until && *until >= lastTimeOf(scan);
  }

  /// For people; empty where tf has both frames.
  [[nodiscard]] std::string unknownFrame(const Waiting& scan) const {
    for (const std::string& frame : {scan.frame, config_.fixed_frame}) {
      if (!transforms_.hasFrame(frame)) return "tf has no frame '" + frame + "'";
    }
    return {};
  }
  /// For people.
  [[nodiscard]] std::string whyNotPlaced(const Waiting& scan, Time now) const {
    std::string unknown = unknownFrame(scan);
    if (!unknown.empty()) return unknown;
    const std::string defect = transforms_.defect();
    return "tf cannot place its frame '" + scan.frame + "' in '" + config_.fixed_frame +
           "' at its time; " + stampText(stampOf(scan.scan), now) +
           (defect.empty() ? "" : "; " + defect);
  }

  /// Finds the poses of what is ready. @return kFound, kNotYet where waiting may help, or why it
  /// cannot.
  [[nodiscard]] Status place(const Waiting& scan, const JointStates* joints) {
    if (!covers(joints, scan.scan)) return Status::kNotYet;
    const auto placeFrame = [&](const std::string& frame, PosePath& path) {
      return transforms_.path(config_.fixed_frame, frame, firstTimeOf(scan.scan),
                              lastTimeOf(scan.scan), fromSeconds(config_.transform_sample_s), path);
    };
    ready_.T_fixed_roots.resize(root_frames_.size());
    for (std::size_t i = 0; joints && i < root_frames_.size(); ++i) {
      const Status status = placeFrame(root_frames_[i], ready_.T_fixed_roots[i]);
      if (status != Status::kFound) return status;
    }
    return placeFrame(scan.frame, ready_.T_fixed_sensor);
  }

  Config config_;
  std::vector<std::string> root_frames_;
  const TransformHistory& transforms_;
  std::vector<Waiting> waiting_;  ///< from the oldest on; those past the count wait no more
  std::size_t waiting_count_ = 0;
  Ready ready_;
  std::map<std::string, std::size_t> dropped_;
  std::size_t dropped_count_ = 0;
  std::function<void(const ScanReport&)> told_;
  std::string frame_;  ///< of the newest scan
};

/// Those of a laser.
class ScanSource : public WaitingScans<SharedScan> {
 public:
  ScanSource(const AssemblerConfig& config, const std::vector<std::string>& root_frames,
             const TransformHistory& transforms)
      : WaitingScans({config.fixed_frame, config.scan.future_max_s, config.transform_sample_s,
                      config.transform_wait_max_s},
                     root_frames, transforms),
        beams_max_(config.scan.assembler.scan_beams_max) {}

  /// A scan that cannot be projected at all, is stamped in the future or has another frame than the
  /// one before is dropped here.
  void add(const LaserScan& scan, const std::string& frame, Time arrival) {
    const std::string defect = defectOf(scan, beams_max_);
    const boost::shared_ptr<LaserScan> copy = scans_.take();
    if (defect.empty()) *copy = scan;
    copy->stamp = scan.stamp;  // of one that has a defect no more is asked, nor kept
    WaitingScans::add(copy, frame, arrival, defect);
  }

 private:
  MessagePool<LaserScan> scans_;
  std::size_t beams_max_;
};

}  // namespace tccm
