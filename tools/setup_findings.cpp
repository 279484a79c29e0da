#include "setup_findings.h"

#include <algorithm>
#include <set>

#include "program.h"
#include "report.h"

namespace tccm {
namespace {

constexpr double kStart = 2.0;  // [s] in which inputs may still be missing
constexpr double kDroppedShareMax = 0.05;

/// What helps, where the detail does not say so itself.
const char* remedyOf(Reason reason) {
  switch (reason) {
    case Reason::kBadTrajectory:
      return "; correct the controller, or what plans for it";
    case Reason::kMapOverflow:
      return "; raise window_returns_max, intervals_max or held_max";
    case Reason::kNoMap:
      return "; see whether scans come, and on which topic";
    case Reason::kMapLate:
      return "; compare the clocks of sensor and robot, or lower the machine's load";
    case Reason::kSweepIncomplete:
      return "; let the laser tilt steadily, all the way";
    case Reason::kBlind:
      return "; see what covers the sensor, and whether the robot's model is larger than the robot";
    case Reason::kNoJoints:
      return "; publish it, or put a joint that nobody publishes into fixed_joints";
    case Reason::kNoTransform:
      return "; see who publishes this transform, how often and with which stamps";
    case Reason::kFuture:
      return "; compare the machines' clocks";
    case Reason::kCheckLate:
      return "; lower the machine's load, or the rate of the joint states";
    case Reason::kNoClock:
      return "; let one node publish /clock, steadily";
    default:
      return "";
  }
}

class Findings {
 public:
  Findings(const Evaluation& evaluation, const MonitorConfig& settings, const Survey& survey)
      : evaluation_(evaluation), settings_(settings), survey_(survey) {}

  std::vector<std::string> all() {
    if (evaluation_.hasRobot()) {
      lookAtStops();
      lookForMissingJoints();
      lookAtLimits();
    }
    lookAtScans();
    if (evaluation_.totals().time_jumps > 0) {
      add(
          formatted("time jumped back %zu times: play a recording once, and see to the clocks of a "
                    "robot: what was known is forgotten at each",
                    evaluation_.totals().time_jumps));
    }
    return std::move(lines_);
  }

 private:
  void add(const std::string& line) {
    if (std::find(lines_.begin(), lines_.end(), line) == lines_.end()) lines_.push_back(line);
  }

  [[nodiscard]] bool told(Reason reason) const { return told_.count(reason) > 0; }
  /// Of what was told already.
  [[nodiscard]] bool isConsequence(const std::string& dropped) const {
    if (dropped == "frame_changed") return told(Reason::kFrameChanged);
    return dropped == "no_joint_states" &&
           (told(Reason::kJointOutOfRange) || told(Reason::kJointContradicted) ||
            told(Reason::kNoJoints));
  }

  void lookAtScans() {
    const std::vector<SensorConfig> sensors = settings_.sensors();
    for (std::size_t i = 0; i < sensors.size(); ++i) {
      const ScanTotals& totals = evaluation_.totals().sensors[i];
      if (totals.scans_received == 0) {
        add(sensors[i].topic + ": nothing came");
        continue;
      }
      for (const auto& [reason, count] : totals.scans_dropped) {
        const double share =
            static_cast<double>(count) / static_cast<double>(totals.scans_received);
        if (share <= kDroppedShareMax && reason != "frame_changed") continue;
        if (isConsequence(reason)) continue;
        add(formatted("%s: %zu of %zu were dropped: ", sensors[i].topic.c_str(), count,
                      totals.scans_received) +
            dropText(evaluation_, settings_, i, reason));
      }
      if (totals.scans_mapped > 0 && totals.complete_maps == 0 && !told(Reason::kFrameChanged)) {
        add(sensors[i].topic + ": the map never held a whole window: " + whyNeverWhole(i));
      }
    }
  }

  [[nodiscard]] std::string whyNeverWhole(std::size_t sensor) const {
    const Mapper& mapper = evaluation_.monitor().mapper(sensor);
    if (mapper.tiltTooFast()) return "the tilt seems to turn faster than any does";
    if (const auto period = mapper.tiltPeriod()) {
      return formatted(
          "a tilt period of %.2f s was measured; listen for two of them, or raise "
          "window_scans_max",
          toSeconds(*period));
    }
    return "no tilt was measured; listen for three of its periods";
  }

  void lookAtLimits() {
    if (told(Reason::kJointOutOfRange)) return;
    const std::string& limit = evaluation_.monitor().checker().inputs().jointStates().limitDefect();
    if (!limit.empty()) add(limit + "; correct the URDF's limits");
  }

  void lookForMissingJoints() {
    if (told(Reason::kJointOutOfRange) || told(Reason::kJointContradicted)) return;
    std::string missing;
    for (const std::string& joint : evaluation_.missingJoints()) {
      missing += (missing.empty() ? "" : ", ") + joint;
    }
    if (missing.empty()) return;
    told_.insert(Reason::kNoJoints);
    add("nobody publishes " + missing + remedyOf(Reason::kNoJoints));
  }

  void lookAtStops() {
    const Totals& totals = evaluation_.totals();
    for (const StopRun& run : totals.stop_runs) {
      if (levelOf(run.reason) != Level::kFault) continue;
      const bool at_start = totals.first_stamp && toSeconds(run.to - *totals.first_stamp) < kStart;
      const bool is_told_otherwise =
          (run.reason == Reason::kNoMap && isMostlyDropped()) ||
          (run.reason == Reason::kNoJoints && !evaluation_.missingJoints().empty());
      if (at_start || is_told_otherwise || !told_.insert(run.reason).second) continue;
      add(std::string(name(run.reason)) + ": " + run.detail + remedyOf(run.reason));
    }
  }

  [[nodiscard]] bool isMostlyDropped() const {
    const Totals& totals = evaluation_.totals();
    return 2 * totals.scans_mapped < totals.scans_received;
  }

  const Evaluation& evaluation_;
  const MonitorConfig& settings_;
  const Survey& survey_;
  std::vector<std::string> lines_;
  std::set<Reason> told_;
};

}  // namespace

std::vector<std::string> findingsOf(const Evaluation& evaluation, const MonitorConfig& settings,
                                    const Survey& survey) {
  return Findings(evaluation, settings, survey).all();
}

}  // namespace tccm
