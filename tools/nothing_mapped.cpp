// What is said of a recording of which no scan reached the map.
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

/// Where the joint states that the self filter needs are to be had.
std::string adviceOnJoints(const Evaluation& evaluation, const MonitorConfig& settings) {
  std::string advice = "set topics/joint_states (" + settings.topics.joint_states +
                       ") to the topic of all the robot's joints";
  if (evaluation.hasRobot() && !evaluation.missingJoints().empty()) {
    advice += " (never published: " + listOf(evaluation.missingJoints()) + ")";
  }
  return advice + ", or tilt_scan_assembler/self_filter to false";
}

/// What to set, or to see to, where scans are dropped for a reason.
std::string adviceOn(const std::string& reason, const Evaluation& evaluation,
                     const MonitorConfig& settings) {
  const AssemblerConfig& assembler = settings.assembler;
  if (reason == "no_transform") {
    return "set tilt_scan_assembler/fixed_frame ('" + evaluation.fixedFrame() +
           "') to a frame that the laser's hangs on by transforms with the scans' stamps; the "
           "bag's transforms name: " +
           listOf(evaluation.frames());
  }
  if (reason == "transform_gap") {
    return formatted(
        "record every transform, or raise tilt_scan_assembler/transform_gap_max_s "
        "(%.3g)",
        assembler.transform_gap_max_s);
  }
  if (reason == "no_joint_states") return adviceOnJoints(evaluation, settings);
  if (reason == "frame_changed") {
    return "set topics/scan (" + settings.topics.scan + ") to a topic of one laser alone";
  }
  if (reason == "blind") {
    return formatted(
        "hardly a beam measured anything: set topics/scan (%s) to another laser, or "
        "raise tilt_scan_assembler/scan_unknown_fraction_max (%.3g)",
        settings.topics.scan.c_str(), assembler.scan.assembler.scan_unknown_fraction_max);
  }
  if (reason == "malformed") {
    return formatted(
        "mend the laser's driver; of too many beams raise "
        "tilt_scan_assembler/scan_beams_max (%zu)",
        assembler.scan.assembler.scan_beams_max);
  }
  if (reason == "future_stamp") {
    return "compare the clocks of laser and robot, or raise tilt_scan_assembler/future_max_s";
  }
  return "set topics/scan (" + settings.topics.scan + ") to scans whose stamps rise";
}

}  // namespace

std::string whyNothingMapped(const Evaluation& evaluation, const MonitorConfig& settings) {
  const Totals& totals = evaluation.totals();
  if (totals.scans_dropped.empty()) return "no scan was mapped: none came";
  const std::string reason = commonestOf(totals.scans_dropped);
  const auto details = totals.drop_details.find(reason);
  const std::string detail =
      details == totals.drop_details.end() ? "" : ", " + commonestOf(details->second);
  return formatted("no scan was mapped, %zu of %zu were dropped: %s%s; ",
                   totals.scans_dropped.at(reason), totals.scans_received, reason.c_str(),
                   detail.c_str()) +
         adviceOn(reason, evaluation, settings);
}

}  // namespace tccm
