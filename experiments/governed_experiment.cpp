#include <algorithm>
#include <cmath>
#include <optional>

#include "experiments/csv.h"
#include "experiments/experiment.h"
#include "experiments/governed_trial.h"
#include "experiments/look_schedule.h"
#include "experiments/markdown_table.h"
#include "experiments/options.h"
#include "experiments/place_speeds.h"
#include "experiments/reaching_about.h"
#include "experiments/result_members.h"
#include "experiments/statistics.h"
#include "simulation/wander.h"

namespace tccm::simulation {
namespace {

constexpr About kAbout = {
    "governed", "a speed at which the next look is in time",
    R"(Random motions under a governed speed, half of them of both arms (wander), half of the hand
from place to place (reach_about). For each wrist, palm and finger in motion, a hundred times
a second: had something appeared the distance ahead, when would the first beam have passed
it, and how far would the link have gone until it was judged and braked for? Then a table:
the speed allowed to a hand by the tilt at which the laser looks at it and by the tilt's
phase, beside the greatest constant speed that would be safe there.
Limits: no link goes further than the distance; where all of the hand is in the tilt's range
the governed speed is at least 1.1 times the constant one.)"};

constexpr double kDegree = M_PI / 180.0;

struct GovernedOptions {
  GovernedTrial::Config trial;
  std::size_t phases = 12;
  double minutes = 10.0;
  double look_angle_deg = 2.0;
  double tilt_step_deg = 5.0;
  std::string links = "hands";
  bool free = false;
};

void declare(CLI::App& command, GovernedOptions& options) {
  command.add_option("--minutes", options.minutes, "simulated time of motions")
      ->check(CLI::Range(0.0, 600.0));
  command.add_option("--distance-m", options.trial.distance_m,
                     "that things appear ahead: appear_distance_m");
  command.add_option("--speed", options.trial.speed_mps, "commanded, of the faster palm [m/s]");
  command
      .add_option("--look-angle-deg", options.look_angle_deg,
                  "a beam this near to a place looks at it")
      ->check(CLI::Range(0.1, 20.0));
  command.add_option("--tilt-step-deg", options.tilt_step_deg, "between places of the table")
      ->check(CLI::Range(0.5, 60.0));
  command.add_option("--phases", options.phases, "of the table")->check(CLI::Range(1, 1000));
  addBraking(command, options.trial.controller, "the faster palm");
  command
      .add_option("--links", options.links,
                  "that are monitored, and so governed: places ahead of elbows are mostly out of "
                  "the tilt's range, where no look is due")
      ->check(CLI::IsMember({"hands", "all"}));
  command.add_flag("--free", options.free, "the speed is not governed, for comparison")
      ->always_capture_default(false);
}

Json settingsOf(const GovernedOptions& options) {
  return {{"minutes", options.minutes},
          {"distance_m", options.trial.distance_m},
          {"governed", !options.free},
          {"links", options.links},
          {"speed_mps", options.trial.speed_mps},
          {"look_angle_deg", options.look_angle_deg},
          {"latency_s", options.trial.controller.latency_s},
          {"deceleration_mps2", options.trial.controller.acceleration_mps2}};
}

constexpr char kColumns[] =
    "seed,motion,cases,violations,reached,largest_share,link,wait_s,looked,way_m,permitted_s,"
    "slowed_s,"
    "standing_s";

std::string rowOf(const GovernedTrial::Result& r, double distance_m) {
  return csvRow(r.seed, r.motion, r.cases, r.violations, r.reached,
                fixed(r.worst.way_m / distance_m, 4), r.worst.link, fixed(r.worst.wait_s, 3),
                r.worst.looked, fixed(r.way_m, 3), fixed(r.permitted_s, 2), fixed(r.slowed_s, 2),
                fixed(r.standing_s, 2));
}

/// What is allowed at one place of the tilt's range.
struct Place {
  double tilt_deg = 0.0;  ///< of the hand's middle
  PlaceSpeeds::Result governed;
  /// Between looks at that part of the hand that waits longest; nothing where one is beyond the
  /// tilt's range.
  std::optional<double> longest_gap_s;
  /// The greatest speed at which the hand is safe at every phase: of that part.
  double constant_mps = 0.0;
  double middle_constant_mps = 0.0;  ///< of the hand's middle alone
};

struct Range {
  double least;
  double most;
};

Range tiltRange() {
  const TiltMotion tilt;
  return {tilt.mean_rad - tilt.amplitude_rad, tilt.mean_rad + tilt.amplitude_rad};
}

/// From a look to the brake: the rest of the scan, the next joint state, the controller.
Braking brakingOf(const GovernedOptions& options) {
  constexpr double kJudged = 0.02;  // [s]
  return {kJudged + options.trial.controller.latency_s, options.trial.controller.acceleration_mps2};
}

std::vector<Place> placesOf(const GovernedOptions& options) {
  const Range range = tiltRange();
  std::vector<Place> places;
  // In the middles of equal parts.
  for (double deg = range.least / kDegree + 0.5 * options.tilt_step_deg; deg < range.most / kDegree;
       deg += options.tilt_step_deg) {
    places.emplace_back();
    places.back().tilt_deg = deg;
  }
  return places;
}

/// How long a look at what the laser points to there may take to come.
std::optional<double> longestGap(const GovernedOptions& options, double tilt_rad) {
  LookSchedule::Config config;
  config.angle_rad = options.look_angle_deg * kDegree;
  const Range range = tiltRange();
  const bool is_inside =
      tilt_rad >= range.least + config.angle_rad && tilt_rad <= range.most - config.angle_rad;
  if (!is_inside) return std::nullopt;
  return LookSchedule(config, tilt_rad).longestGap();
}

void compareWithConstant(const GovernedOptions& options, Place& place) {
  const auto speedAt = [&options](double gap_s) {
    return safeSpeed(options.trial.distance_m, gap_s, brakingOf(options));
  };
  if (const auto gap = longestGap(options, place.tilt_deg * kDegree)) {
    place.middle_constant_mps = speedAt(*gap);
  }
  double longest = 0.0;
  for (const double tilt_rad : place.governed.part_tilts_rad) {
    const auto gap = longestGap(options, tilt_rad);
    if (!gap) return;
    longest = std::max(longest, *gap);
  }
  place.longest_gap_s = longest;
  place.constant_mps = speedAt(longest);
}

std::string csvOf(const std::vector<Place>& places) {
  std::string text =
      "tilt_deg,inside,longest_gap_s,constant_mps,middle_constant_mps,governed_mps,travelled_mps";
  for (std::size_t i = 0; i < places.front().governed.allowed_mps.size(); ++i) {
    text += ",phase_" + std::to_string(i) + "_mps";
  }
  text += '\n';
  for (const Place& place : places) {
    text += csvCells(fixed(place.tilt_deg, 1), place.longest_gap_s.has_value(),
                     fixed(place.longest_gap_s, 3), fixed(place.constant_mps, 4),
                     fixed(place.middle_constant_mps, 4), fixed(place.governed.mean_mps, 4),
                     fixed(place.governed.travelled_mps, 4));
    for (const double allowed : place.governed.allowed_mps) text += ',' + fixed(allowed, 4);
    text += '\n';
  }
  return text;
}

/// In mm/s.
MarkdownTable tableOf(const std::vector<Place>& places) {
  MarkdownTable table;
  for (const char* column : {"tilt", "constant", "governed"}) table.addColumn(column);
  const std::size_t phases = places.front().governed.allowed_mps.size();
  for (std::size_t i = 0; i < phases; ++i) table.addColumn(fixed(share(i, phases), 2));
  for (const Place& place : places) {
    std::vector<std::string> cells = {fixed(place.tilt_deg, 0), fixed(1e3 * place.constant_mps, 0),
                                      fixed(1e3 * place.governed.mean_mps, 0)};
    for (const double mps : place.governed.allowed_mps) cells.push_back(fixed(1e3 * mps, 0));
    table.addRow(cells);
  }
  return table;
}

/// Over places where all of the hand is looked at; beyond the tilt's range nothing may move.
void add(const std::vector<Place>& places, Findings& findings) {
  constexpr double kGain = 1.1;  // of the governed speed over the constant one
  double constant = 0.0;
  double middle_constant = 0.0;
  double governed = 0.0;
  std::size_t inside = 0;
  for (const Place& place : places) {
    findings.simulated_s += place.governed.simulated_s;
    findings.figures["places"].push_back({{"tilt_deg", place.tilt_deg},
                                          {"inside", place.longest_gap_s.has_value()},
                                          {"longest_gap_s", place.longest_gap_s.value_or(0.0)},
                                          {"constant_mps", place.constant_mps},
                                          {"middle_constant_mps", place.middle_constant_mps},
                                          {"governed_mps", place.governed.mean_mps},
                                          {"travelled_mps", place.governed.travelled_mps},
                                          {"by_phase_mps", place.governed.allowed_mps}});
    if (!place.longest_gap_s) continue;
    ++inside;
    constant += place.constant_mps;
    middle_constant += place.middle_constant_mps;
    governed += place.governed.mean_mps;
  }
  const auto count = static_cast<double>(std::max<std::size_t>(inside, 1));
  const double gain = constant > 0.0 ? governed / constant : 0.0;
  findings.figures["all_places"] = {{"inside", inside},
                                    {"constant_mps", constant / count},
                                    {"middle_constant_mps", middle_constant / count},
                                    {"governed_mps", governed / count},
                                    {"gain", gain}};
  findings.files["speeds.csv"] = csvOf(places);
  findings.addLines(tableOf(places).lines());
  findings.lines.push_back(formatted(
      "%zu places      where all of the hand is in the tilt's range: %.0f mm/s governed, on "
      "average, %.0f mm/s constant (%.0f for its middle alone): %.2f times as fast",
      inside, 1e3 * governed / count, 1e3 * constant / count, 1e3 * middle_constant / count, gain));
  if (!places.empty() && gain < kGain) findings.missed.emplace_back("gain");
}

void add(const std::vector<GovernedTrial::Result>& trials, double distance_m, Findings& findings) {
  GovernedTrial::Result all;
  for (const GovernedTrial::Result& trial : trials) {
    findings.add(rowOf(trial, distance_m), trial.simulated_s);
    all.cases += trial.cases;
    all.violations += trial.violations;
    all.reached += trial.reached;
    if (trial.worst.way_m > all.worst.way_m) all.worst = trial.worst;
    all.way_m += trial.way_m;
    all.permitted_s += trial.permitted_s;
    all.slowed_s += trial.slowed_s;
    all.standing_s += trial.standing_s;
  }
  const double permitted_s = std::max(all.permitted_s, 1e-9);
  findings.figures["motions"] = {{"cases", all.cases},
                                 {"violations", all.violations},
                                 {"reached", all.reached},
                                 {"largest_share_of_distance", all.worst.way_m / distance_m},
                                 {"at_link", all.worst.link},
                                 {"mean_mps", all.way_m / permitted_s},
                                 {"permitted_s", all.permitted_s},
                                 {"slowed_share", all.slowed_s / permitted_s},
                                 {"standing_share", all.standing_s / permitted_s}};
  findings.lines.push_back(
      formatted("motions        %zu cases: %zu go further than the distance, the worst %.2f of it; "
                "%zu come to the place; %.0f mm/s on average, standing %.0f %% of the time",
                all.cases, all.violations, all.worst.way_m / distance_m, all.reached,
                1e3 * all.way_m / permitted_s, 100.0 * all.standing_s / permitted_s));
  if (all.violations > 0) findings.missed.emplace_back("distance");
}

Findings runGoverned(GovernedOptions options, const TrialRun& run) {
  MonitorConfig settings = run.settings;
  settings.checker.checker.governed_speed.appear_distance_m =
      options.free ? 0.0 : options.trial.distance_m;
  GovernedTrial::Config& trial = options.trial;
  if (options.links == "hands") {
    const std::vector<std::string> hands = {"*_wrist_pitch_link", "*_wrist_roll_link",
                                            "*_palm_link", "*_finger_link"};
    settings.checker.checker.pose.collision_use.links = hands;
    settings.checker.checker.evidence.links = hands;
    trial.links.erase(trial.links.begin(), trial.links.begin() + 2);  // elbows
  }
  trial.oracle.angle_rad = options.look_angle_deg * kDegree;
  // In the empty scene a camera measures nothing in the area but the robot, which is no fault here.
  if (!run.sensors.isLaserAlone()) {
    settings.checker.checker.inputs.self_filter_fraction_max = 1.0;
  }
  run.prepare(trial, settings);
  std::vector<GovernedTrial::Result> trials(
      static_cast<std::size_t>(std::ceil(60.0 * options.minutes / trial.duration_s)));
  // The table is of the tilt.
  std::vector<Place> places = run.sensors.isLaserAlone() ? placesOf(options) : std::vector<Place>();
  PlaceSpeeds::Config speeds;
  speeds.monitor = trial.monitor;
  speeds.speed_mps = trial.speed_mps;
  speeds.phases = options.phases;
  speeds.controller = trial.controller;
  if (options.links == "hands") speeds.links = trial.links;
  const auto runCase = [&](std::size_t i) {
    if (i < trials.size()) {
      GovernedTrial::Config config = trial;
      config.motion = i % 2 == 0 ? kWander : kReachingAbout;
      trials[i] = GovernedTrial(config, run.model, run.seedOf(i)).run();
    } else {
      Place& place = places[i - trials.size()];
      place.governed =
          PlaceSpeeds(speeds, run.model, place.tilt_deg * kDegree, run.seedOf(i)).run();
    }
  };
  run.forEach(trials.size() + places.size(), runCase, [&](std::size_t i, Archive& archive) {
    if (i < trials.size()) {
      archive(trials[i]);
    } else {
      archive(places[i - trials.size()].governed);
    }
  });
  for (Place& place : places) compareWithConstant(options, place);
  Findings findings(settingsOf(options), kColumns);
  add(trials, trial.distance_m, findings);
  if (!places.empty()) add(places, findings);
  return findings;
}

}  // namespace

Experiment governedExperiment(CLI::App& app) {
  return experiment(app, kAbout, declare, runGoverned);
}

}  // namespace tccm::simulation
