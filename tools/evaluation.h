#pragma once

#include <sensor_msgs/JointState.h>
#include <sensor_msgs/LaserScan.h>
#include <sensor_msgs/PointCloud2.h>
#include <tf2_msgs/TFMessage.h>

#include <cstddef>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <variant>
#include <vector>

#include "monitor_config.h"
#include "recording.h"
#include "ros/cloud_reader.h"
#include "ros/cloud_source.h"
#include "ros/scan_source.h"
#include "ros/transform_history.h"

namespace tccm {

/// Consecutive checks that said stop for the same reason.
struct StopRun {
  Time from;  ///< the first of them
  Time to;    ///< the first check after them; the last of them at the end of the recording
  Reason reason = Reason::kInit;
  std::string link;          ///< the first concerned
  std::string detail;        ///< of the first of them, for people
  bool begins_stop = false;  ///< the check before, if any, did not say stop
};

/// Wall times [us], one value a scan or check.
struct Timings {
  std::vector<double> assemble;
  std::vector<double> integrate;
  std::vector<double> snapshot;
  std::vector<double> collision;  ///< of both ends of the way ahead, and of the way
  std::vector<double> clearance;
  std::vector<double> occlusion;
  std::vector<double> evidence;
  std::vector<double> scan_to_verdict;  ///< from a scan with its transforms to the check on its map
  std::vector<Time> verdict_at;         ///< when each of these checks was, by the recording
};

/// What the sensor did not see, and how old what it saw was.
struct SightTotals {
  std::size_t held_sum = 0;  ///< cuboids, over the maps after each scan
  std::size_t held_max = 0;
  std::size_t checks = 0;        ///< in which the robot was placed
  double unseen_sum = 0.0;       ///< of their unseen fractions
  std::size_t unseen_above = 0;  ///< those above unseen_fraction_max
  double governed_sum = 0.0;     ///< of the scales that the governed speed allowed
  double governed_min = 1.0;
  std::size_t ages = 0;    ///< checks in which anything of a watched way was seen
  double age_sum_s = 0.0;  ///< of the oldest evidence in each
  double age_max_s = 0.0;
};

/// What became of scans.
struct ScanTotals {
  std::size_t scans_received = 0;
  std::size_t scans_mapped = 0;
  std::map<std::string, std::size_t> scans_dropped;  ///< by reason; none is 0
  /// How often each detail was told, by reason; not of all reasons.
  std::map<std::string, std::map<std::string, std::size_t>> drop_details;

  BeamCounts beams{};  ///< of the mapped scans
  std::size_t points_mapped = 0;
  std::size_t points_out_of_area = 0;

  std::size_t cuboids_sum = 0;  ///< over the maps after each scan
  std::size_t cuboids_max = 0;
  std::size_t overflowed_maps = 0;
  std::size_t complete_maps = 0;
};

/// What became of a recording: of the scans of all sensors, of those of each, and of the checks.
/// All but the timings depend on the recording and settings alone.
struct Totals : ScanTotals {
  std::vector<ScanTotals> sensors;

  std::size_t checks = 0;
  std::size_t checks_unknown = 0;  ///< without a whole map or fresh input
  std::size_t collisions = 0;
  std::size_t occlusions = 0;
  std::size_t stops = 0;
  std::size_t slows = 0;  ///< permitted, but only slowly
  std::vector<StopRun> stop_runs;
  std::map<Reason, std::size_t> slow_reasons;  ///< checks by the reason that decided
  std::map<Reason, std::size_t> stop_reasons;
  SightTotals sight;

  std::size_t time_jumps = 0;
  std::optional<Time> first_stamp;
  std::optional<Time> last_stamp;
  Timings timings;
};

/// Drives the core with the messages of a recording. The clock is the newest stamp of scans and
/// joint states; stamps of transforms do not move it, as publishers of fixed transforms date them
/// ahead.
class Evaluation {
 public:
  /// Called after each scan that a sensor's map took and after each check; may be empty.
  struct Observer {
    std::function<void(const Monitor&, std::size_t sensor)> mapped;
    std::function<void(const Verdict&, const Checker&)> checked;
  };

  /// @param model nothing: the surroundings are mapped, and nothing is checked.
  /// @throws ConfigError
  Evaluation(const MonitorConfig& settings, std::shared_ptr<const RobotModel> model,
             Observer observer);

  /// @param publisher whose stamps rise, unless time jumps back.
  void add(const sensor_msgs::LaserScan& message, std::size_t sensor, const std::string& publisher);
  void add(const sensor_msgs::PointCloud2& message, std::size_t sensor,
           const std::string& publisher);
  void add(const sensor_msgs::JointState& message, const std::string& publisher);
  void add(const tf2_msgs::TFMessage& message, bool is_static);
  /// After the last message: scans that still wait are dropped.
  void finish();

  /// Complete after finish().
  [[nodiscard]] const Totals& totals() const { return totals_; }
  [[nodiscard]] const Monitor& monitor() const { return monitor_; }
  [[nodiscard]] bool hasRobot() const { return monitor_.hasRobot(); }
  /// @pre hasRobot()
  [[nodiscard]] const RobotModel& model() const { return *monitor_.checker().model(); }
  /// Joints that moves a monitored link and that nothing published. @pre hasRobot()
  [[nodiscard]] std::vector<std::string> missingJoints() const {
    return monitor_.checker().missingJoints();
  }
  [[nodiscard]] const std::string& fixedFrame() const { return fixed_frame_; }
  /// All that the recording's transforms name.
  [[nodiscard]] const std::set<std::string>& frames() const { return frames_; }

 private:
  void compareWithModel();
  void moveClock(Time stamp, const std::string& publisher);
  void resetAfterJump();
  /// Maps the scans whose transforms have come, and checks after each.
  void mapReady();
  void mapReady(std::size_t sensor);
  template <typename SourceOf>
  void mapReady(SourceOf& source, std::size_t sensor);
  using Source = std::variant<ScanSource, CloudSource>;  ///< of a laser, of a camera or lidar
  void openSource(const SensorConfig& sensor);
  /// A message of a sensor's came in.
  void noteArrival(const std_msgs::Header& header, std::size_t sensor,
                   const std::string& publisher);
  Monitor::ScanOutcome addTo(const ScanSource::Ready& ready, std::size_t sensor) {
    return monitor_.addScan(*now_, *ready.scan, ready.T_fixed_sensor, ready.T_fixed_roots, sensor);
  }
  Monitor::ScanOutcome addTo(const CloudSource::Ready& ready, std::size_t sensor) {
    return monitor_.addCloud(*now_, *ready.scan, ready.T_fixed_sensor, ready.T_fixed_roots, sensor);
  }
  /// Of the robot that is filtered out; nothing where none is.
  [[nodiscard]] const JointStates* filteredJoints(std::size_t sensor) const;
  /// Does it to what is counted of a sensor, and of all.
  template <typename Count>
  void countScans(std::size_t sensor, Count&& count) {
    count(static_cast<ScanTotals&>(totals_));
    count(totals_.sensors[sensor]);
  }
  void countDropped(std::size_t sensor, const std::string& reason, std::size_t scans);
  void count(const Monitor::ScanOutcome& outcome, std::size_t sensor);
  void check();
  void noteStop(const Verdict& verdict);
  void noteSight(const Verdict& verdict);

  Monitor monitor_;
  Observer observer_;
  std::string fixed_frame_;
  std::vector<std::string> root_frames_;  ///< none without a robot
  TransformHistory transforms_;
  std::set<std::string> frames_;
  std::deque<Source> sources_;                       ///< by sensor
  std::vector<std::optional<CloudReader>> readers_;  ///< of cameras and lidars
  LaserScan scan_;                                   ///< reused
  std::map<std::string, Time> newest_;               ///< by publisher
  std::optional<Time> now_;
  bool stopped_ = false;   ///< by the last check
  bool in_a_run_ = false;  ///< the last stop run may go on: time did not jump since
  Totals totals_;
};

/// Plays all of it, and finishes.
void play(const Recording& recording, Evaluation& evaluation,
          const std::function<void(double fraction)>& progress);

}  // namespace tccm
