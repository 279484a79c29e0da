#include "ros/scan_source.h"

#include <utility>

#include "scan/assembled_scan.h"

namespace tccm {
namespace {

constexpr std::size_t kWaitingMax = 100;  // scans; more means that transforms never come

using Status = TransformHistory::Status;

}  // namespace

ScanSource::ScanSource(const AssemblerConfig& config, const std::vector<std::string>& root_frames,
                       const TransformHistory& transforms)
    : fixed_frame_(withoutSlash(config.fixed_frame)),
      root_frames_(root_frames),
      beams_max_(config.scan.assembler.scan_beams_max),
      step_(fromSeconds(config.transform_sample_s)),
      wait_max_(fromSeconds(config.transform_wait_max_s)),
      future_max_(fromSeconds(config.scan.future_max_s)),
      transforms_(transforms) {
  ready_.T_fixed_roots.resize(root_frames_.size());
}

std::string ScanSource::add(LaserScan scan, const std::string& frame, Time arrival) {
  std::string defect = defectOf(scan, beams_max_);
  if (!defect.empty()) {
    countDrop(scan.stamp, "malformed");
    return defect;
  }
  if (scan.stamp - arrival > future_max_) {
    countDrop(scan.stamp, "future_stamp");
    return "it is stamped in the future";
  }
  if (waiting_.size() == kWaitingMax) {
    countDrop(waiting_.front().scan.stamp, "no_transform");
    waiting_.pop_front();
  }
  waiting_.push_back({std::move(scan), withoutSlash(frame), arrival});
  return defect;
}

void ScanSource::countDrop(Time stamp, const std::string& reason) {
  ++dropped_[reason];
  if (told_) told_(stamp, reason);
}

void ScanSource::clear() { waiting_.clear(); }

Status ScanSource::place(Waiting& waiting, const JointStates* joints) {
  const Time first = waiting.scan.stamp;
  const Time last = waiting.scan.lastBeamTime();
  if (joints) {
    const auto until = joints->answersUntil();
    if (!until || *until < last) return Status::kNotYet;
    for (std::size_t i = 0; i < root_frames_.size(); ++i) {
      const Status status = transforms_.path(fixed_frame_, root_frames_[i], first, last, step_,
                                             ready_.T_fixed_roots[i]);
      if (status != Status::kFound) return status;
    }
  }
  return transforms_.path(fixed_frame_, waiting.frame, first, last, step_, ready_.T_fixed_sensor);
}

const ScanSource::Ready* ScanSource::next(const JointStates* joints, Time now) {
  while (!waiting_.empty()) {
    if (now < waiting_.front().arrival) {  // time began anew
      countDrop(waiting_.front().scan.stamp, "time_jump");
      waiting_.pop_front();
      continue;
    }
    const Status status = place(waiting_.front(), joints);
    if (status == Status::kNotYet && now - waiting_.front().arrival <= wait_max_) return nullptr;
    Waiting scan = std::move(waiting_.front());
    waiting_.pop_front();
    if (status == Status::kFound) {
      ready_.scan = std::move(scan.scan);
      ready_.arrival = scan.arrival;
      return &ready_;
    }
    const bool joints_missing =
        joints && status == Status::kNotYet &&
        (!joints->answersUntil() || *joints->answersUntil() < scan.scan.lastBeamTime());
    countDrop(scan.scan.stamp, joints_missing ? "no_joint_states" : TransformHistory::name(status));
  }
  return nullptr;
}

std::size_t ScanSource::droppedCount() const {
  std::size_t count = 0;
  for (const auto& entry : dropped_) count += entry.second;
  return count;
}

void ScanSource::drain() {
  for (const Waiting& waiting : waiting_) countDrop(waiting.scan.stamp, "no_transform");
  waiting_.clear();
}

}  // namespace tccm
