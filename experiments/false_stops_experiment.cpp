#include <algorithm>
#include <array>
#include <map>
#include <string>
#include <vector>

#include "experiments/csv.h"
#include "experiments/draw.h"
#include "experiments/experiment.h"
#include "experiments/options.h"
#include "experiments/result_members.h"
#include "experiments/self_filter_trial.h"
#include "experiments/stretching.h"
#include "simulation/robot/dual_arm.h"
#include "simulation/wander.h"

namespace tccm::simulation {
namespace {

constexpr About kAbout = {
    "false-stops", "arms that move clear of everything: what stops them?",
    R"(An arm stretches over a table, or before a shelf with a drawer, as low as its clearance
and its reach allow; or both arms move at random (wander). They keep clear of everything,
also where they would be half a second later: a permission that goes for a contact goes
for nothing. The arms stop and slow down as they are told. Speeds and scenes take turns;
every motion has a path, to and fro, a phase of the tilt and a body of its own, each of
whose parts is displaced.
Limit: no false stop at a noise of up to 10 mm.)"};

struct FalseStopsOptions {
  SelfFilterTrial::Config trial;
  std::string motion = kStretching;
  std::size_t motions = 1000;
  std::vector<double> noises_m = {0.01};
  std::vector<double> speeds_mps = {0.1, 0.25, 0.4};
  std::vector<std::string> scenes = {"table"};
};

void declare(CLI::App& command, FalseStopsOptions& options) {
  Simulator::Config& simulator = options.trial.simulator;
  command.add_option("--motion", options.motion)->check(CLI::IsMember({kStretching, kWander}));
  command.add_option("--motions", options.motions, "at each noise")->check(CLI::Range(1, 1000000));
  command.add_option("--duration-s", options.trial.duration_s, "of a motion");
  addList(command, "--noises-m", options.noises_m, CLI::Range(0.0, 0.2),
          "standard deviations of a range");
  addList(command, "--speeds", options.speeds_mps, CLI::Range(0.01, 2.0),
          "of the faster palm [m/s]");
  addList(command, "--scenes", options.scenes, CLI::IsMember({"table", "shelf", "empty"}));
  command.add_option("--clearance-m", simulator.wander_clearance_m,
                     "that the arms keep from the scene");
  command.add_option("--body-error-m", simulator.body_error.size_m,
                     "by which each part of the robot is displaced");
  command.add_option("--joints-late-s", options.trial.joints_late_s,
                     "by which joint states are stamped too late");
  addMixedPixels(command, simulator.scanner);
}

Json settingsOf(const FalseStopsOptions& options) {
  return {{"motion", options.motion},
          {"motions", options.motions},
          {"duration_s", options.trial.duration_s},
          {"noises_m", options.noises_m},
          {"speeds_mps", options.speeds_mps},
          {"scenes", options.scenes},
          {"clearance_m", options.trial.simulator.wander_clearance_m},
          {"body_error_m", options.trial.simulator.body_error.size_m},
          {"joints_late_s", options.trial.joints_late_s},
          {"mixed_share", options.trial.simulator.scanner.mixed_share},
          {"mixed_persistence", options.trial.simulator.scanner.mixed_persistence}};
}

/// A motion and what came of it.
struct Motion {
  double noise_m;
  double speed_mps;
  std::string scene;
  std::uint64_t seed;
  SelfFilterTally tally;
};

std::vector<Motion> motionsOf(const FalseStopsOptions& options, const TrialRun& run) {
  std::vector<Motion> motions;
  for (const double noise_m : options.noises_m) {
    for (std::size_t i = 0; i < options.motions; ++i) {
      const double speed = options.speeds_mps[i % options.speeds_mps.size()];
      const std::size_t scene = i / options.speeds_mps.size() % options.scenes.size();
      motions.push_back({noise_m, speed, options.scenes[scene], run.seedOf(motions.size()), {}});
    }
  }
  return motions;
}

SelfFilterTrial::Config configOf(const FalseStopsOptions& options, const Motion& motion) {
  Draw draw(motion.seed);
  SelfFilterTrial::Config config = options.trial;
  Simulator::Config& simulator = config.simulator;
  simulator.seed = motion.seed;
  simulator.scene = motion.scene;
  simulator.scanner.noise_m = motion.noise_m;
  simulator.controller.speed_mps = motion.speed_mps;
  if (options.motion == kStretching) {
    simulator.path = stretchOver(dualArm(), scene(motion.scene),
                                 {motion.seed, motion.speed_mps, simulator.wander_clearance_m});
  }
  simulator.wander_length_m = 1.0;  // to and fro
  simulator.head.tilt.phase_rad = draw.between(0.0, 2.0 * M_PI);
  return config;
}

constexpr std::array<BeamSource, kBeamSources> kSources = {
    BeamSource::kOwn, BeamSource::kScene, BeamSource::kOwnMixed, BeamSource::kSceneMixed};
constexpr char kHeld[] = "held";

/// What most of the returns at a false stop came from; held where none is in the window any more.
std::string mainSource(const FalseContact& stop) {
  const auto most = std::max_element(stop.supporters.begin(), stop.supporters.end());
  return *most > 0 ? name(static_cast<BeamSource>(most - stop.supporters.begin())) : kHeld;
}

constexpr char kColumns[] =
    "seed,noise_m,speed_mps,scene,permitted_s,slowed_s,false_stops,first_s,link,source";

std::string rowOf(const Motion& motion) {
  const SelfFilterTally& tally = motion.tally;
  const auto firstStop = [&tally]() -> std::string {
    if (tally.stops.empty()) return csvCells("", "", "");
    const FalseContact& first = tally.stops.front();
    const double first_s = toSeconds(first.stamp - Simulator::Config().start);
    return csvCells(fixed(first_s, 3), first.link, mainSource(first));
  };
  return csvRow(motion.seed, fixed(motion.noise_m, 3), fixed(motion.speed_mps, 3), motion.scene,
                fixed(tally.permitted_s, 2), fixed(tally.slowed_s, 2), tally.stops.size(),
                firstStop());
}

/// Of the motions at one noise.
struct Tally {
  std::size_t motions = 0, with_stop = 0, stops = 0;
  double permitted_s = 0.0, slowed_s = 0.0;
  std::map<std::string, std::size_t> by_source;

  void add(const SelfFilterTally& motion) {
    ++motions;
    with_stop += motion.stops.empty() ? 0 : 1;
    stops += motion.stops.size();
    permitted_s += motion.permitted_s;
    slowed_s += motion.slowed_s;
    for (const FalseContact& stop : motion.stops) {
      ++by_source[mainSource(stop)];
    }
  }
};

Findings findingsOf(const std::vector<Motion>& motions, const FalseStopsOptions& options) {
  constexpr double kQuiet = 0.0101;  // [m] of noise up to which there may be none
  Findings findings(settingsOf(options), kColumns);
  for (std::size_t first = 0; first < motions.size(); first += options.motions) {
    Tally tally;
    for (std::size_t i = first; i < first + options.motions; ++i) {
      tally.add(motions[i].tally);
      findings.add(rowOf(motions[i]), options.trial.duration_s);
    }
    const double noise_m = motions[first].noise_m;
    const double hours = std::max(tally.permitted_s, 1e-9) / 3600.0;
    Json sources;
    for (const BeamSource source : kSources) sources[name(source)] = tally.by_source[name(source)];
    sources[kHeld] = tally.by_source[kHeld];
    findings.figures["by_noise"].push_back(
        {{"noise_m", noise_m},
         {"motions", tally.motions},
         {"motions_with_false_stop", tally.with_stop},
         {"false_stops", tally.stops},
         {"false_stops_per_hour", static_cast<double>(tally.stops) / hours},
         {"mostly_returns_of", sources},
         {"permitted_s", tally.permitted_s},
         {"slowed_for_contact_share", tally.slowed_s / std::max(tally.permitted_s, 1e-9)}});
    findings.lines.push_back(formatted(
        "%.0f mm of noise %zu motions: %zu false stops in %zu of them, %.1f an hour; slowed down "
        "for a contact %.2f %% of the time",
        1e3 * noise_m, tally.motions, tally.stops, tally.with_stop,
        static_cast<double>(tally.stops) / hours,
        100.0 * tally.slowed_s / std::max(tally.permitted_s, 1e-9)));
    if (noise_m < kQuiet && tally.stops > 0 && findings.missed.empty()) {
      findings.missed.emplace_back("false_stops");
    }
  }
  return findings;
}

Findings runFalseStops(FalseStopsOptions options, const TrialRun& run) {
  run.sensors.applyTo(options.trial.simulator);
  options.trial.monitor = run.settings.monitor();
  options.trial.validate();
  // A contact at the present pose would hold until somebody resets.
  options.trial.monitor.checker.permission.hold_until_reset = false;
  std::vector<Motion> motions = motionsOf(options, run);
  run.forEach(
      motions.size(),
      [&](std::size_t i) {
        motions[i].tally = SelfFilterTrial(configOf(options, motions[i]), run.model).run({});
      },
      [&](std::size_t i, Archive& archive) { archive(motions[i].tally); });
  return findingsOf(motions, options);
}

}  // namespace

Experiment falseStopsExperiment(CLI::App& app) {
  FalseStopsOptions options;
  Simulator::Config& simulator = options.trial.simulator;
  simulator.motion = kWander;
  simulator.wander_clearance_m = 0.08;
  simulator.body_error.size_m = 0.01;
  options.trial.joints_late_s = 0.02;
  options.trial.duration_s = 12.0;
  options.trial.obeys = true;
  return experiment(app, kAbout, declare, runFalseStops, options);
}

}  // namespace tccm::simulation
