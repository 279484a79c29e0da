#include <algorithm>
#include <vector>

#include "experiments/csv.h"
#include "experiments/experiment.h"
#include "experiments/occlusion_trial.h"
#include "experiments/options.h"
#include "experiments/result_members.h"
#include "experiments/statistics.h"

namespace tccm::simulation {
namespace {

constexpr About kAbout = {
    "occlusion", "something comes between laser and arms: is what it hides found?",
    R"(The arms stand in a random pose in a random scene. A pole, a human arm, a box or nothing
comes between them and the laser, at any phase of the tilt. Of the links that the laser
looks at, the one that it hides most of, by rays on the true shapes, is to be found within
one tilt; where nothing comes, none whose silhouette is visible.
Limits: --found-min of those hidden by more than --hidden-min; --flagged-max of the poses
without an occluder.)"};

struct OcclusionOptions {
  OcclusionTrial::Config trial;
  std::size_t trials = 1000;
  double found_min = 0.99;
  double flagged_max = 0.01;
};

void declare(CLI::App& command, OcclusionOptions& options) {
  OcclusionTrial::Config& trial = options.trial;
  command.add_option("--trials", options.trials)->check(CLI::Range(1, 1000000));
  command.add_option("--obstacle-speed", trial.obstacle_speed_mps,
                     "brought in from 0.4 m aside at [m/s]; 0: it appears at once");
  addNoise(command, trial.noise_m);
  command.add_option("--clearance-m", trial.clearance_m, "between the robot and all else");
  command.add_option("--hidden-min", trial.hidden_min, "of a link's silhouette, by the occluder");
  addLinksThatCount(command, trial.counted);
  addShare(command, "--found-min", options.found_min);
  addShare(command, "--flagged-max", options.flagged_max);
}

Json settingsOf(const OcclusionOptions& options) {
  return {
      {"trials", options.trials},
      {"obstacle_speed_mps", options.trial.obstacle_speed_mps},
      {"noise_m", options.trial.noise_m},
      {"clearance_m", options.trial.clearance_m},
      {"hidden_min", options.trial.hidden_min},
      {"in_range_min", options.trial.counted.in_range_min},
      {"silhouette_min_pixels", options.trial.counted.silhouette_min_pixels},
      {"occlusion_hidden_fraction", options.trial.monitor.checker.pose.occlusion.hidden_fraction}};
}

constexpr char kColumns[] =
    "seed,scene,obstacle,tilt_phase,beam_s,link,hidden,occluded,found_s,flagged,"
    "flagged_occluded";

std::string rowOf(const OcclusionTrial::Result& r) {
  const std::string hidden = r.link
                                 ? csvCells(r.link->name, fixed(r.link->hidden, 4),
                                            fixed(r.link->occluded, 4), fixed(r.link->found_s, 4))
                                 : csvCells("", "", "", "");
  const std::string flagged = r.false_flag
                                  ? csvCells(r.false_flag->name, fixed(r.false_flag->occluded, 4))
                                  : csvCells("", "");
  return csvRow(r.seed, r.scene, r.obstacle, fixed(r.tilt_phase, 4), fixed(r.beam_s, 4), hidden,
                flagged);
}

Findings findingsOf(const std::vector<OcclusionTrial::Result>& trials,
                    const OcclusionOptions& options) {
  Findings findings(settingsOf(options), kColumns);
  std::size_t hidden = 0, found = 0, without = 0, flagged = 0;
  std::vector<double> delays_s;
  for (const OcclusionTrial::Result& trial : trials) {
    findings.add(rowOf(trial), trial.simulated_s);
    if (trial.obstacle == "none") {
      ++without;
      flagged += trial.false_flag ? 1 : 0;
    }
    if (!trial.link) continue;
    ++hidden;
    if (!trial.link->found_s) continue;
    ++found;
    if (trial.beam_s) delays_s.push_back(std::max(0.0, *trial.link->found_s - *trial.beam_s));
  }
  std::sort(delays_s.begin(), delays_s.end());
  const double found_share = share(found, hidden);
  const double flagged_share = share(flagged, without);
  const double median_s = quantile(delays_s, 0.5);
  const double late_s = quantile(delays_s, 0.99);
  findings.figures = {{"hiding", hidden},
                      {"found", found},
                      {"found_share", found_share},
                      {"without", without},
                      {"flagged", flagged},
                      {"flagged_share", flagged_share},
                      {"delay_s", {{"p50", median_s}, {"p99", late_s}}}};
  findings.lines = {
      formatted(
          "hidden         %zu links by more than %.0f %%: %zu found within one tilt (%.2f %%), "
          "%.0f ms after the first beam on the occluder, p99 %.0f ms",
          hidden, 100.0 * options.trial.hidden_min, found, 100.0 * found_share, 1e3 * median_s,
          1e3 * late_s),
      formatted("without        %zu poses: %zu flagged (%.2f %%)", without, flagged,
                100.0 * flagged_share)};
  if (hidden > 0 && found_share < options.found_min) findings.missed.emplace_back("found");
  if (flagged_share > options.flagged_max) findings.missed.emplace_back("flagged");
  return findings;
}

Findings runOcclusion(OcclusionOptions options, const TrialRun& run) {
  run.prepare(options.trial);
  return findingsOf(run.resultsOf<OcclusionTrial>(options.trials, options.trial), options);
}

}  // namespace

Experiment occlusionExperiment(CLI::App& app) {
  return experiment(app, kAbout, declare, runOcclusion);
}

}  // namespace tccm::simulation
