// Why scans did not reach the map, and what to do about it.
#include <algorithm>
#include <map>
#include <string>

#include "program.h"
#include "report.h"

namespace tccm {
namespace {

constexpr std::size_t kNamesShown = 8;

/// "a, b, c and 5 more".
template <typename Names>
std::string listOf(const Names& names) {
  std::string list;
  std::size_t count = 0;
  for (const std::string& name : names) {
    if (++count <= kNamesShown) list += (count == 1 ? "'" : ", '") + name + "'";
  }
  if (count > kNamesShown) list += formatted(" and %zu more", count - kNamesShown);
  return list.empty() ? "none" : list;
}

/// @pre there are some
std::string commonestOf(const std::map<std::string, std::size_t>& counts) {
  return std::max_element(counts.begin(), counts.end(),
                          [](const auto& a, const auto& b) { return a.second < b.second; })
      ->first;
}

/// What to set, or to see to, where a sensor's scans or clouds are dropped.
class Advice {
 public:
  Advice(const Evaluation& evaluation, const MonitorConfig& settings, const SensorConfig& sensor)
      : evaluation_(evaluation),
        settings_(settings),
        sensor_(sensor),
        owner_((sensor.name.empty() ? "" : sensor.name + "/") + sensor.assemblerName() + "/"),
        topic_((sensor.name.empty() ? "topics/scan" : sensor.name + "/topic") + " (" +
               sensor.topic + ")") {}

  [[nodiscard]] std::string on(const std::string& reason) const {
    if (reason == "no_transform") {
      return "set " + owner_ + "fixed_frame ('" + evaluation_.fixedFrame() +
             "') to a frame that the sensor's hangs on by transforms with the scans' stamps; the "
             "bag's transforms name: " +
             listOf(evaluation_.frames());
    }
    if (reason == "transform_gap") {
      return "record every transform, or raise " + owner_ +
             formatted("transform_gap_max_s (%.3g)", sensor_.placing().transform_gap_max_s);
    }
    if (reason == "no_joint_states") return onJoints();
    if (reason == "frame_changed") return "set " + topic_ + " to a topic of one sensor alone";
    if (reason == "blind") {
      return "hardly anything was measured: set " + topic_ + " to another sensor, or raise " +
             unknownLimit();
    }
    if (reason == "malformed")
      return "mend the sensor's driver; of too many points raise " + sizeLimit();
    if (reason == "future_stamp") {
      return "compare the clocks of sensor and robot, or raise " + owner_ + "future_max_s";
    }
    return "set " + topic_ + " to scans whose stamps rise";
  }

 private:
  /// Where the joint states that the self filter needs are to be had.
  [[nodiscard]] std::string onJoints() const {
    std::string advice = "set topics/joint_states (" + settings_.topics.joint_states +
                         ") to the topic of all the robot's joints";
    if (evaluation_.hasRobot() && !evaluation_.missingJoints().empty()) {
      advice += " (never published: " + listOf(evaluation_.missingJoints()) + ")";
    }
    return advice + ", or " + owner_ + "self_filter to false";
  }
  [[nodiscard]] std::string unknownLimit() const {
    if (sensor_.cloud_assembler) {
      return owner_ + formatted("cloud_unknown_fraction_max (%.3g)",
                                sensor_.cloud_assembler->cloud.unknown_fraction_max);
    }
    return owner_ + formatted("scan_unknown_fraction_max (%.3g)",
                              sensor_.assembler.scan.assembler.scan_unknown_fraction_max);
  }
  [[nodiscard]] std::string sizeLimit() const {
    if (sensor_.cloud_assembler) {
      return owner_ +
             formatted("cloud_points_max (%zu)", sensor_.cloud_assembler->cloud.limits.points_max);
    }
    return owner_ +
           formatted("scan_beams_max (%zu)", sensor_.assembler.scan.assembler.scan_beams_max);
  }

  const Evaluation& evaluation_;
  const MonitorConfig& settings_;
  const SensorConfig& sensor_;
  std::string owner_;
  std::string topic_;
};

/// The sensor that most came of; none of its scans or clouds was mapped.
std::size_t worstOf(const Totals& totals) {
  const auto received = [](const ScanTotals& a, const ScanTotals& b) {
    return a.scans_received < b.scans_received;
  };
  return static_cast<std::size_t>(
      std::max_element(totals.sensors.begin(), totals.sensors.end(), received) -
      totals.sensors.begin());
}

}  // namespace

std::string dropText(const Evaluation& evaluation, const MonitorConfig& settings,
                     std::size_t sensor, const std::string& reason) {
  const auto& all_details = evaluation.totals().sensors[sensor].drop_details;
  const auto details = all_details.find(reason);
  const std::string detail =
      details == all_details.end() ? "" : ", " + commonestOf(details->second);
  return reason + detail + "; " +
         Advice(evaluation, settings, settings.sensors()[sensor]).on(reason);
}

std::string whyNothingMapped(const Evaluation& evaluation, const MonitorConfig& settings) {
  if (evaluation.totals().scans_dropped.empty()) return "no scan was mapped: none came";
  const std::size_t worst = worstOf(evaluation.totals());
  const ScanTotals& totals = evaluation.totals().sensors[worst];
  const SensorConfig sensor = settings.sensors()[worst];
  const std::string reason = commonestOf(totals.scans_dropped);
  return formatted("no %s was mapped, %zu of %zu were dropped: ",
                   sensor.cloud_assembler ? "cloud" : "scan", totals.scans_dropped.at(reason),
                   totals.scans_received) +
         dropText(evaluation, settings, worst, reason);
}

}  // namespace tccm
