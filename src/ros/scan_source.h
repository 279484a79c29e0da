#pragma once

#include <cstddef>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "monitor_config.h"
#include "robot/joint_states.h"
#include "ros/transform_history.h"
#include "tccm_monitor/laser_scan.h"
#include "tccm_monitor/pose.h"

namespace tccm {

/// Holds scans until transforms (and joint states, where a robot is filtered out) around all of
/// their beams are there, or it is clear that they will not come. Scans leave in the order they
/// came in; nothing waits.
class ScanSource {
 public:
  /// @param root_frames those of the robot that is filtered out, in its model's order; none where
  /// no robot is.
  ScanSource(const AssemblerConfig& config, const std::vector<std::string>& root_frames,
             const TransformHistory& transforms);

  /// A scan with all that is needed to place its beams.
  struct Ready {
    LaserScan scan;
    Time arrival;
    PosePath T_fixed_sensor;
    std::vector<PosePath> T_fixed_roots;
  };

  /// Called for each scan that is dropped, with its stamp and the reason.
  void onDrop(std::function<void(Time, const std::string&)> told) { told_ = std::move(told); }

  /// A scan that cannot be projected at all, or is stamped in the future, is dropped here.
  /// @return empty, or what is wrong with it.
  std::string add(LaserScan scan, const std::string& frame, Time arrival);
  void clear();

  /// The oldest scan that can be placed now. Those before it that cannot are dropped and counted.
  /// @param joints nothing where no robot is filtered out. @param now for how long a scan waited.
  [[nodiscard]] const Ready* next(const JointStates* joints, Time now);
  /// Drops what still waits.
  void drain();

  /// How many scans were dropped, by reason.
  [[nodiscard]] const std::map<std::string, std::size_t>& dropped() const { return dropped_; }
  [[nodiscard]] std::size_t droppedCount() const;
  /// For a scan that failed after it left.
  void countDrop(Time stamp, const std::string& reason);
  [[nodiscard]] std::size_t waiting() const { return waiting_.size(); }

 private:
  struct Waiting {
    LaserScan scan;
    std::string frame;
    Time arrival;
  };
  /// Fills ready_ from a scan. @return kFound, kNotYet where waiting may help, or why it cannot.
  [[nodiscard]] TransformHistory::Status place(Waiting& waiting, const JointStates* joints);

  std::string fixed_frame_;
  std::vector<std::string> root_frames_;
  std::size_t beams_max_;
  Duration step_;
  Duration wait_max_;
  Duration future_max_;
  const TransformHistory& transforms_;
  std::deque<Waiting> waiting_;
  Ready ready_;
  std::map<std::string, std::size_t> dropped_;
  std::function<void(Time, const std::string&)> told_;
};

}  // namespace tccm
