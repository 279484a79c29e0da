// Why and for how long the robot was stopped: the summary's list, and lines for people.
#include <algorithm>
#include <string>

#include "base/duration_text.h"
#include "program.h"
#include "report.h"
#include "report_figures.h"

namespace tccm {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kStopsShown = 20;
constexpr std::size_t kReasonsShown = 6;

/// "COLLISION of 'hand'".
std::string reasonText(const StopRun& run) {
  return name(run.reason) + (run.link.empty() ? "" : " of '" + run.link + "'");
}

}  // namespace

const StopRun& gravestOf(const Stop& stop) {
  return **std::max_element(
      stop.runs.begin(), stop.runs.end(),
      [](const StopRun* a, const StopRun* b) { return a->reason < b->reason; });
}

std::string inTurn(const Stop& stop) {
  std::vector<std::string> texts;
  for (const StopRun* run : stop.runs) {
    const std::string text = reasonText(*run);
    if (std::find(texts.begin(), texts.end(), text) == texts.end()) texts.push_back(text);
  }
  if (texts.size() < 2) return {};
  std::string line;
  for (std::size_t i = 0; i < std::min(texts.size(), kReasonsShown); ++i) {
    line += (i == 0 ? "" : ", ") + texts[i];
  }
  if (texts.size() > kReasonsShown) {
    line += formatted(" and %zu more", texts.size() - kReasonsShown);
  }
  return line;
}

namespace {

std::string lineOfStop(const Stop& stop, Time start) {
  const Time from = stop.runs.front()->from;
  const StopRun& gravest = gravestOf(stop);
  std::string line = formatted("at %.2f s (stamp %.2f) for %s: %s", toSeconds(from - start),
                               toSeconds(from.time_since_epoch()),
                               durationText(stop.length).c_str(), reasonText(gravest).c_str());
  if (!gravest.detail.empty()) line += ": " + gravest.detail;
  const std::string turns = inTurn(stop);
  return turns.empty() ? line : line + " (in turn: " + turns + ")";
}

}  // namespace

std::vector<Stop> stopsOf(const Totals& totals) {
  std::vector<Stop> stops;
  for (const StopRun& run : totals.stop_runs) {
    if (run.begins_stop) stops.emplace_back();
    stops.back().runs.push_back(&run);
    stops.back().length += run.to - run.from;
  }
  return stops;
}

Json stopSegmentsOf(const Totals& totals) {
  Json segments = Json::array();
  std::size_t stop = 0;
  for (const StopRun& run : totals.stop_runs) {
    stop += run.begins_stop ? 1 : 0;
    segments.push_back({{"stop", stop},
                        {"from_s", rounded(toSeconds(run.from - *totals.first_stamp))},
                        {"to_s", rounded(toSeconds(run.to - *totals.first_stamp))},
                        {"reason", name(run.reason)},
                        {"link", run.link},
                        {"detail", run.detail}});
  }
  return segments;
}

void printStops(const Totals& totals, std::ostream& out) {
  const std::vector<Stop> stops = stopsOf(totals);
  const std::size_t shown = std::min(stops.size(), kStopsShown);
  for (std::size_t i = 0; i < shown; ++i) {
    out << "stop     " << lineOfStop(stops[i], *totals.first_stamp) << '\n';
  }
  if (stops.size() > shown) {
    out << "stop     " << stops.size() - shown << " more: stop_segments in summary.json has all\n";
  }
}

}  // namespace tccm
