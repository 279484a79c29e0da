#include "findings.h"

#include <algorithm>
#include <set>

#include "ros/advice.h"
#include "tools/program.h"
#include "tools/report.h"

namespace tccm {
namespace {

constexpr double kStart = 2.0;  // [s] in which inputs may still be missing
constexpr double kDroppedShareMax = 0.05;

/// Of inputs that may come a little after the others at the start.
bool mayBeMissingAtStart(Reason reason) {
  return reason == Reason::kNoJoints || reason == Reason::kNoTransform ||
         reason == Reason::kNoMap || reason == Reason::kMapLate;
}

class Findings {
 public:
  Findings(const Evaluation& evaluation, const MonitorConfig& settings)
      : evaluation_(evaluation), settings_(settings) {}

  std::vector<std::string> all() {
    const auto& last = evaluation_.totals().last_stamp;
    const double heard_s = last ? secondsUntil(*last) : 0.0;
    if (heard_s < 2.0 * kStart) {
      add(formatted("only %.1f s were heard, too little to tell anything: listen for longer",
                    heard_s));
    }
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
      const bool at_start = mayBeMissingAtStart(run.reason) && secondsUntil(run.to) < kStart;
      const bool is_told_otherwise =
          (run.reason == Reason::kCheckLate && wasStoppedBy(Reason::kJointOutOfRange)) ||
          (run.reason == Reason::kNoMap && isMostlyDropped()) ||
          (run.reason == Reason::kNoJoints && !evaluation_.missingJoints().empty());
      if (at_start || is_told_otherwise || !told_.insert(run.reason).second) continue;
      add(std::string(name(run.reason)) + ": " + run.detail + remedyOf(run.reason));
    }
  }

  [[nodiscard]] bool wasStoppedBy(Reason reason) const {
    const std::vector<StopRun>& runs = evaluation_.totals().stop_runs;
    return std::any_of(runs.begin(), runs.end(),
                       [reason](const StopRun& run) { return run.reason == reason; });
  }

  /// From the beginning on.
  [[nodiscard]] double secondsUntil(Time stamp) const {
    const auto& first = evaluation_.totals().first_stamp;
    return first ? toSeconds(stamp - *first) : 0.0;
  }

  [[nodiscard]] std::string remedyOf(Reason reason) const {
    const std::string text = advice_.about(name(reason), "FAULT");
    return text.empty() ? "" : "; to do: " + text;
  }

  [[nodiscard]] bool isMostlyDropped() const {
    const Totals& totals = evaluation_.totals();
    return 2 * totals.scans_mapped < totals.scans_received;
  }

  const Evaluation& evaluation_;
  const MonitorConfig& settings_;
  Advice advice_ = Advice::ofThePage();
  std::vector<std::string> lines_;
  std::set<Reason> told_;
};

}  // namespace

std::vector<std::string> findingsOf(const Evaluation& evaluation, const MonitorConfig& settings) {
  return Findings(evaluation, settings).all();
}

}  // namespace tccm
