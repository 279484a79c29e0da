// What another configuration would have made of a recording.
#include "what_if.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <utility>

#include "program.h"
#include "report.h"
#include "report_figures.h"

namespace tccm {
namespace {

using Json = nlohmann::ordered_json;
using Kind = StopChange::Kind;

constexpr std::size_t kTrialsMax = 1000;

/// What came of one trial.
struct Run {
  std::string name;
  std::vector<ComparedStop> stops;
  double duration_s = 0.0;
  std::optional<double> stop_fraction, slow_fraction;
  std::optional<double> p50_us, p99_us;     ///< from scan to verdict
  std::optional<double> least_clearance_m;  ///< while motion was permitted
};

std::vector<ComparedStop> comparedStopsOf(const Totals& totals) {
  std::vector<ComparedStop> stops;
  for (const Stop& stop : stopsOf(totals)) {
    const StopRun& gravest = gravestOf(stop);
    const Time start = *totals.first_stamp;
    stops.push_back({rounded(toSeconds(stop.runs.front()->from - start)),
                     rounded(toSeconds(stop.runs.back()->to - start)), name(gravest.reason),
                     gravest.link, gravest.detail});
  }
  return stops;
}

std::optional<double> numberIn(const Json& json) {
  return json.is_null() ? std::nullopt : std::optional<double>(json.get<double>());
}

Json jsonOf(const std::optional<double>& number) { return number ? Json(*number) : Json(nullptr); }

void noteClearance(const Verdict& verdict, std::optional<double>& least_m) {
  if (verdict.stop) return;
  for (const LinkClearance& clearance : verdict.clearances) {
    if (!std::isfinite(clearance.distance_m)) continue;
    const double distance_m = rounded(clearance.distance_m);
    least_m = std::min(least_m.value_or(distance_m), distance_m);
  }
}

Run runOf(const WhatIf& what_if, const Trial& trial, const Progress& progress) {
  Run run;
  run.name = trial.name;
  Evaluation::Observer observer;
  observer.checked = [&run](const Verdict& verdict, const Checker&) {
    noteClearance(verdict, run.least_clearance_m);
  };
  Evaluation evaluation(trial.settings, what_if.model(trial.settings), observer);
  play(*what_if.open(trial.settings), evaluation, progress);
  const Totals& totals = evaluation.totals();
  // Of nothing seen there is no stop to compare, which does not mean that there would be none.
  if (totals.scans_mapped == 0) {
    throw InputError(trial.name + ": " + whyNothingMapped(evaluation, trial.settings));
  }
  run.stops = comparedStopsOf(totals);
  const Json summary = summaryOf(evaluation, trial.settings);
  run.stop_fraction = numberIn(summary.at("stop_fraction"));
  run.slow_fraction = numberIn(summary.at("slow_fraction"));
  const Json timing = timesOf(totals, false);
  const Json& took = timing.at("time_us").at("scan_to_verdict");
  run.p50_us = numberIn(took.at("p50"));
  run.p99_us = numberIn(took.at("p99"));
  if (totals.last_stamp)
    run.duration_s = rounded(toSeconds(*totals.last_stamp - *totals.first_stamp));
  return run;
}

std::vector<Run> runsOf(const WhatIf& what_if, const std::vector<Trial>& trials) {
  const Progress bar = progressBar();
  std::vector<Run> runs;
  for (const Trial& trial : trials) {
    const auto done = static_cast<double>(runs.size());
    const auto all = static_cast<double>(trials.size());
    runs.push_back(runOf(what_if, trial, [&](double fraction_done) {
      if (bar) bar((done + fraction_done) / all);
    }));
  }
  return runs;
}

const char* name(Kind kind) {
  switch (kind) {
    case Kind::kSame:
      return "same";
    case Kind::kMoved:
      return "moved";
    case Kind::kOther:
      return "other";
    case Kind::kGone:
      return "gone";
    default:
      return "come";
  }
}

Json jsonOf(const ComparedStop& stop) {
  return {{"from_s", stop.from_s},
          {"to_s", stop.to_s},
          {"reason", stop.reason},
          {"link", stop.link},
          {"detail", stop.detail}};
}

Json jsonOf(const StopChange& change) {
  Json json{{"change", name(change.kind)}};
  json["before"] = change.before ? jsonOf(*change.before) : Json(nullptr);
  json["after"] = change.after ? jsonOf(*change.after) : Json(nullptr);
  return json;
}

std::string textOf(const ComparedStop& stop) {
  return stop.reason + (stop.link.empty() ? "" : " of '" + stop.link + "'");
}

/// "0.120 s earlier".
std::string shiftText(double seconds, const char* more, const char* less) {
  if (std::abs(seconds) < 5e-4) return {};
  return formatted(", %.3f s %s", std::abs(seconds), seconds > 0.0 ? more : less);
}

std::string lineOf(const StopChange& change) {
  const ComparedStop& stop = change.before ? *change.before : *change.after;
  std::string line = formatted("%-8s at %.2f s for %.2f s: ", name(change.kind), stop.from_s,
                               stop.to_s - stop.from_s) +
                     textOf(stop);
  if (!change.before || !change.after) return line;
  if (change.kind == Kind::kOther) line += " -> " + textOf(*change.after);
  const double later_s = change.after->from_s - change.before->from_s;
  const double longer_s = change.after->to_s - change.before->to_s - later_s;
  return line + shiftText(later_s, "later", "earlier") + shiftText(longer_s, "longer", "shorter");
}

std::size_t countOf(const std::vector<StopChange>& changes, Kind kind) {
  return static_cast<std::size_t>(
      std::count_if(changes.begin(), changes.end(),
                    [kind](const StopChange& change) { return change.kind == kind; }));
}

Kind kindOf(const ComparedStop& before, const ComparedStop& after) {
  if (before.reason != after.reason || before.link != after.link) return Kind::kOther;
  const bool is_same =
      std::abs(before.from_s - after.from_s) < 1e-3 && std::abs(before.to_s - after.to_s) < 1e-3;
  return is_same ? Kind::kSame : Kind::kMoved;
}

struct Overlap {
  double shared_s = 0.0;
  std::size_t before = 0, after = 0;
};

/// All that there are, the longest first. As scripts/evaluations/baseline.py pairs them.
std::vector<Overlap> overlapsOf(const std::vector<ComparedStop>& before,
                                const std::vector<ComparedStop>& after) {
  std::vector<Overlap> overlaps;
  for (std::size_t i = 0; i < before.size(); ++i) {
    for (std::size_t j = 0; j < after.size(); ++j) {
      const double shared_s =
          std::min(before[i].to_s, after[j].to_s) - std::max(before[i].from_s, after[j].from_s);
      if (shared_s >= 0.0) overlaps.push_back({shared_s, i, j});
    }
  }
  std::stable_sort(overlaps.begin(), overlaps.end(),
                   [](const Overlap& a, const Overlap& b) { return a.shared_s > b.shared_s; });
  return overlaps;
}

/// Writes and draws it. @throws InputError
void conclude(const WhatIf& what_if, const std::string& file, const Json& json) {
  const auto path = (std::filesystem::path(what_if.out) / (file + ".json")).string();
  writeText(path, json.dump(2) + '\n');
  std::cout << "written  " << path << std::endl;
  const auto picture = (std::filesystem::path(what_if.out) / (file + ".png")).string();
  if (runScript("draw_what_if", {path, picture}) != kDone) {
    throw InputError("the picture " + picture + " could not be drawn");
  }
  std::cout << "written  " << picture << std::endl;
}

/// The section that has the key, where one alone does. @throws InputError
std::string sectionOf(const std::string& key) {
  std::vector<std::string> found;
  MonitorConfig().visitSections([&](const std::string& section, auto& config, const std::string&) {
    const ParameterTable table = tableOf(config);
    for (const ParameterTable::Row& row : table.rows()) {
      if (row.key == key) found.push_back(section);
    }
  });
  if (found.size() == 1) return found.front();
  std::string sections;
  for (const std::string& section : found)
    sections.append(" ").append(section).append("/").append(key);
  throw InputError("--sweep: " + (found.empty() ? "there is no parameter " + key
                                                : key + " may be any of" + sections));
}

/// @param path of names with slashes.
void setIn(YAML::Node node, const std::string& path, double value) {
  const std::size_t slash = path.find('/');
  if (slash == std::string::npos) {
    node[path] = value;
  } else {
    setIn(node[path.substr(0, slash)], path.substr(slash + 1), value);
  }
}

Json jsonOf(const Run& run) {
  Json stops = Json::array();
  for (const ComparedStop& stop : run.stops) stops.push_back(jsonOf(stop));
  return {{"name", run.name},
          {"duration_s", run.duration_s},
          {"stop_fraction", jsonOf(run.stop_fraction)},
          {"slow_fraction", jsonOf(run.slow_fraction)},
          {"least_clearance_m", jsonOf(run.least_clearance_m)},
          {"stops", stops}};
}

}  // namespace

std::vector<StopChange> compareStops(const std::vector<ComparedStop>& before,
                                     const std::vector<ComparedStop>& after) {
  std::vector<std::optional<std::size_t>> belongs_to(before.size());
  std::vector<bool> taken(after.size(), false);
  for (const Overlap& overlap : overlapsOf(before, after)) {
    if (belongs_to[overlap.before] || taken[overlap.after]) continue;
    belongs_to[overlap.before] = overlap.after;
    taken[overlap.after] = true;
  }
  std::vector<StopChange> changes;
  for (std::size_t i = 0; i < before.size(); ++i) {
    if (!belongs_to[i]) {
      changes.push_back({Kind::kGone, before[i], {}});
    } else {
      const ComparedStop& other = after[*belongs_to[i]];
      changes.push_back({kindOf(before[i], other), before[i], other});
    }
  }
  for (std::size_t i = 0; i < after.size(); ++i) {
    if (!taken[i]) changes.push_back({Kind::kCome, {}, after[i]});
  }
  const auto beginOf = [](const StopChange& change) {
    return change.before ? change.before->from_s : change.after->from_s;
  };
  std::stable_sort(changes.begin(), changes.end(),
                   [&](const auto& a, const auto& b) { return beginOf(a) < beginOf(b); });
  return changes;
}

std::vector<Trial> sweptTrials(const std::string& config, const std::string& sweep) {
  const std::size_t equals = sweep.find('=');
  double from = 0.0, to = 0.0, step = 0.0;
  char rest = 0;
  const bool is_read =
      equals != std::string::npos &&
      std::sscanf(sweep.c_str() + equals + 1, "%lf:%lf:%lf%c", &from, &to, &step, &rest) == 3;
  if (!is_read || !(step > 0.0) || !(to >= from) || !std::isfinite(to)) {
    throw InputError("--sweep: '" + sweep + "' is not key=from:to:step, with from up to to");
  }
  const double count = std::floor((to - from) / step + 1e-9) + 1.0;
  if (count > static_cast<double>(kTrialsMax)) {
    throw InputError(formatted("--sweep: %.0f values, at most %zu are allowed", count, kTrialsMax));
  }
  const std::string key = sweep.substr(0, equals);
  const std::string path = key.find('/') == std::string::npos ? sectionOf(key) + "/" + key : key;
  const std::string text = config.empty() ? "" : readText(config, "the configuration");
  std::vector<Trial> trials;
  for (int i = 0; i < static_cast<int>(count); ++i) {
    const double value = from + i * step;
    YAML::Node root = YAML::Load(text);
    setIn(root, path, value);
    const ScratchFile file("yaml");
    writeText(file.path(), YAML::Dump(root));
    trials.push_back({formatted("%.6g", value), readMonitorConfig(file.path())});
  }
  return trials;
}

int compareTrials(const WhatIf& what_if, const std::vector<Trial>& trials) {
  const std::vector<Run> runs = runsOf(what_if, trials);
  const std::vector<StopChange> changes = compareStops(runs[0].stops, runs[1].stops);
  Json json{{"kind", "comparison"}, {"runs", Json::array()}, {"changes", Json::array()}};
  for (const Run& run : runs) {
    json["runs"].push_back(jsonOf(run));
    std::cout << formatted("stops    %zu with %s\n", run.stops.size(), run.name.c_str());
  }
  for (const StopChange& change : changes) {
    json["changes"].push_back(jsonOf(change));
    if (change.kind != Kind::kSame) std::cout << lineOf(change) << '\n';
  }
  std::cout << formatted("%zu the same, %zu moved, %zu for another reason, %zu gone, %zu come\n",
                         countOf(changes, Kind::kSame), countOf(changes, Kind::kMoved),
                         countOf(changes, Kind::kOther), countOf(changes, Kind::kGone),
                         countOf(changes, Kind::kCome));
  conclude(what_if, "comparison", json);
  return kDone;
}

int sweepTrials(const WhatIf& what_if, const Trial& reference, const std::vector<Trial>& trials) {
  std::vector<Trial> all{reference};
  all.insert(all.end(), trials.begin(), trials.end());
  const std::vector<Run> runs = runsOf(what_if, all);
  Json json{{"kind", "sweep"}, {"reference", jsonOf(runs[0])}, {"runs", Json::array()}};
  Json timing = Json::array();
  std::cout << "value     stops  false  missed  stop time  least clearance\n";
  for (std::size_t i = 1; i < runs.size(); ++i) {
    const Run& run = runs[i];
    const std::vector<StopChange> changes = compareStops(runs[0].stops, run.stops);
    const std::size_t come = countOf(changes, Kind::kCome), gone = countOf(changes, Kind::kGone);
    Json row = jsonOf(run);
    row["false_stops"] = come;
    row["missed_stops"] = gone;
    json["runs"].push_back(row);
    const Json cost{
        {"name", run.name},
        {"scan_to_verdict", {{"p50", jsonOf(run.p50_us)}, {"p99", jsonOf(run.p99_us)}}}};
    timing.push_back(cost);
    const std::string share =
        run.stop_fraction ? formatted("%7.1f %%", 100.0 * *run.stop_fraction) : "        -";
    const std::string clearance =
        run.least_clearance_m ? formatted("%.3f m", *run.least_clearance_m) : "-";
    std::cout << formatted("%-9s %5zu  %5zu  %6zu  %s  %s\n", run.name.c_str(), run.stops.size(),
                           come, gone, share.c_str(), clearance.c_str());
  }
  writeText((std::filesystem::path(what_if.out) / "sweep_timing.json").string(),
            timing.dump(2) + '\n');
  conclude(what_if, "sweep", json);
  return kDone;
}

}  // namespace tccm
