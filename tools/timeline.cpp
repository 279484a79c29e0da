#include "timeline.h"

#include <algorithm>
#include <optional>

#include "report_figures.h"
#include "ros/stop_cause.h"

namespace tccm {
namespace {

/// In quotes where CSV needs them.
std::string cell(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

std::string cell(std::optional<double> value) { return value ? formatted("%.6f", *value) : ""; }

void keepLeast(double value, std::optional<double>& least) {
  least = std::min(least.value_or(value), value);
}

/// Nothing where no link is as near as is looked for.
std::optional<double> leastClearance(const Verdict& verdict) {
  std::optional<double> least;
  for (const LinkClearance& link : verdict.clearances) {
    if (std::isfinite(link.distance_m)) keepLeast(link.distance_m, least);
  }
  return least;
}

std::optional<double> leastVisible(const Verdict& verdict) {
  std::optional<double> least;
  for (const LinkVisibility& link : verdict.now.links) keepLeast(link.visible_fraction, least);
  return least;
}

std::optional<double> mapAge(const Verdict& verdict, const Checker& checker) {
  std::optional<double> oldest_s;
  for (const SensorInput& sensor : checker.inputs().sensors()) {
    if (!sensor.map()) continue;
    const double age_s = toSeconds(verdict.stamp - sensor.map()->stamp);
    oldest_s = std::max(oldest_s.value_or(age_s), age_s);
  }
  return oldest_s;
}

std::optional<double> jointsAge(const Verdict& verdict) {
  if (verdict.joints_stamp == Time()) return std::nullopt;
  return toSeconds(verdict.stamp - verdict.joints_stamp);
}

}  // namespace

Timeline::Timeline(const std::string& path)
    : file_(path,
            "stamp,time_s,level,reason,link,clearance_m,visible,map_age_s,joints_age_s,"
            "speed_scale") {}

void Timeline::add(const Verdict& verdict, const Checker& checker, Time start) {
  const bool placed = verdict.placed;
  file_.line("%s,%.6f,%s,%s,%s,%s,%s,%s,%s,%.6f", stampText(verdict.stamp).c_str(),
             toSeconds(verdict.stamp - start), name(verdict.level), name(verdict.reason),
             cell(verdict.link).c_str(),
             cell(placed ? leastClearance(verdict) : std::nullopt).c_str(),
             cell(placed ? leastVisible(verdict) : std::nullopt).c_str(),
             cell(mapAge(verdict, checker)).c_str(), cell(jointsAge(verdict)).c_str(),
             verdict.speed_scale);
}

}  // namespace tccm
