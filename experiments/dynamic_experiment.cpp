#include <algorithm>
#include <array>
#include <map>

#include "experiments/csv.h"
#include "experiments/dynamic_trial.h"
#include "experiments/experiment.h"
#include "experiments/options.h"
#include "experiments/result_members.h"

namespace tccm::simulation {
namespace {

constexpr About kAbout = {
    "dynamic", "which parts of the map are static, and which move",
    R"(The paper's Fig. 7: a sheet of paper is moved over the table, and in every other trial a
box is slid on it, while the arms are at rest. Which cuboids does the map take for static?
One comes from what stands where all its returns do, from what moves where most do.
Limits, for either scene: at least 95 % of those that stand are called static, and at most
5 % of those that move.)"};

constexpr double kRecallMin = 0.95;
constexpr double kMovingStaticMax = 0.05;
constexpr std::size_t kPhases = 4;
const std::array<const char*, 2> kScenes = {"paper", "box"};

struct DynamicOptions {
  DynamicTrial::Config trial;
  std::size_t trials = 100;
};

void declare(CLI::App& command, DynamicOptions& options) {
  command.add_option("--trials", options.trials, "of both scenes")->check(CLI::Range(2, 1000000));
  addNoise(command, options.trial.scanner.noise_m);
  command.add_option("--settle-s", options.trial.settle_s,
                     "from when it begins to move to the first map judged");
  command.add_option("--judge-s", options.trial.judge_s, "how long maps are judged");
  command.add_option("--every", options.trial.every, "scans between maps that are judged");
}

Json settingsOf(const DynamicOptions& options) {
  return {{"trials", options.trials},
          {"noise_m", options.trial.scanner.noise_m},
          {"static_windows", options.trial.static_windows},
          {"settle_s", options.trial.settle_s},
          {"judge_s", options.trial.judge_s},
          {"every", options.trial.every}};
}

Json toJson(const DynamicTally& tally) {
  return {{"standing", tally.standing},
          {"static_recall", tally.staticRecall()},
          {"static_precision", tally.staticPrecision()},
          {"moving", tally.moving},
          {"moving_called_static", tally.movingStatic()},
          {"of_both", tally.both},
          {"of_both_called_static", tally.both_static}};
}

std::string lineOf(const std::string& what, const DynamicTally& tally) {
  return formatted(
      "%-14s %8zu standing: %.2f %% static; %6zu moving: %.2f %% static; precision %.2f %%; %zu of "
      "both",
      what.c_str(), tally.standing, 100.0 * tally.staticRecall(), tally.moving,
      100.0 * tally.movingStatic(), 100.0 * tally.staticPrecision(), tally.both);
}

constexpr char kColumns[] =
    "seed,scene,tilt_phase,tilt_period_s,height_m,speed_mps,maps,standing,standing_static,moving,"
    "moving_static,of_both,static_recall,static_precision,moving_called_static";

std::string rowOf(const DynamicTrial::Result& trial) {
  const DynamicTally& tally = trial.tally;
  return csvRow(trial.seed, trial.scene, fixed(trial.phase, 4), fixed(trial.period_s, 4),
                fixed(trial.height_m, 4), fixed(trial.speed_mps, 3), trial.maps, tally.standing,
                tally.standing_static, tally.moving, tally.moving_static, tally.both,
                fixed(tally.staticRecall(), 4), fixed(tally.staticPrecision(), 4),
                fixed(tally.movingStatic(), 4));
}

/// The last map of the first trial of each scene, for the picture.
std::string cuboidRows(const std::vector<DynamicTrial::Result>& trials) {
  static const std::array<const char*, 4> kNames = {"standing", "moving", "both", "mixed"};
  std::string rows = "scene,x,y,bottom,top,source,static\n";
  for (const DynamicTrial::Result& trial : trials) {
    for (const DynamicTrial::JudgedCuboid& judged : trial.cuboids) {
      rows += csvRow(trial.scene, fixed(judged.x_m, 3), fixed(judged.y_m, 3),
                     fixed(judged.bottom_m, 3), fixed(judged.top_m, 3),
                     kNames[static_cast<std::size_t>(judged.source)], judged.called_static);
    }
  }
  return rows;
}

Findings findingsOf(const std::vector<DynamicTrial::Result>& trials,
                    const DynamicOptions& options) {
  Findings findings(settingsOf(options), kColumns);
  findings.files["cuboids.csv"] = cuboidRows(trials);
  std::map<std::string, DynamicTally> by_scene;
  std::map<std::string, std::array<DynamicTally, kPhases>> by_phase;
  for (const DynamicTrial::Result& trial : trials) {
    findings.add(rowOf(trial), trial.simulated_s);
    by_scene[trial.scene].add(trial.tally);
    const auto phase = static_cast<std::size_t>(trial.phase * static_cast<double>(kPhases));
    by_phase[trial.scene][std::min(phase, kPhases - 1)].add(trial.tally);
  }
  for (const auto& [scene, tally] : by_scene) {
    Json& figures = findings.figures[scene] = toJson(tally);
    findings.lines.push_back(lineOf(scene, tally));
    for (std::size_t i = 0; i < kPhases; ++i) {
      const DynamicTally& some = by_phase[scene][i];
      figures["by_phase"].push_back(toJson(some));
      findings.lines.push_back(lineOf(scene + " phase " + std::to_string(i + 1) + "/4", some));
    }
    if (tally.staticRecall() < kRecallMin) findings.missed.push_back(scene + " static_recall");
    if (tally.movingStatic() > kMovingStaticMax) {
      findings.missed.push_back(scene + " moving_called_static");
    }
  }
  return findings;
}

Findings runDynamic(DynamicOptions options, const TrialRun& run) {
  options.trial.static_windows = run.settings.mapper.static_windows;
  run.prepare(options.trial);
  const auto trials = run.results(options.trials, [&](std::size_t i, std::uint64_t seed) {
    DynamicTrial::Config config = options.trial;
    config.keep_cuboids = i < kScenes.size();
    return DynamicTrial(config, kScenes[i % kScenes.size()], run.model, seed).run();
  });
  return findingsOf(trials, options);
}

}  // namespace

Experiment dynamicExperiment(CLI::App& app) { return experiment(app, kAbout, declare, runDynamic); }

}  // namespace tccm::simulation
