#include <algorithm>
#include <memory>
#include <vector>

#include "experiments/csv.h"
#include "experiments/experiment.h"
#include "experiments/occlusion_trial.h"
#include "experiments/parallel.h"
#include "simulation/robot/dual_arm.h"

namespace tccm::simulation {
namespace {

struct OcclusionOptions {
  OcclusionTrial::Config trial;
  std::size_t trials = 1000;
  double found_min = 0.99;
  double flagged_max = 0.01;
};

void declare(CLI::App& command, OcclusionOptions& options) {
  OcclusionTrial::Config& trial = options.trial;
  command.footer(
      "The arms stand in a random pose in a random scene. A pole, a human arm, a box or nothing\n"
      "comes between them and the laser, at any phase of the tilt. Of the links that the laser\n"
      "looks at, the one that it hides most of, by rays on the true shapes, is to be found within\n"
      "one tilt; where nothing comes, none whose silhouette is visible.\n"
      "Limits: --found-min of those hidden by more than --hidden-min; --flagged-max of the poses\n"
      "without an occluder.");
  command.option_defaults()->always_capture_default();
  command.add_option("--trials", options.trials)->check(CLI::Range(1, 1000000));
  command.add_option("--obstacle-speed", trial.obstacle_speed_mps,
                     "brought in from 0.4 m aside at [m/s]; 0: it appears at once");
  command.add_option("--noise-m", trial.noise_m, "standard deviation of a range");
  command.add_option("--clearance-m", trial.clearance_m, "between the robot and all else");
  command.add_option("--hidden-min", trial.hidden_min, "of a link's silhouette, by the occluder");
  command.add_option("--in-range-min", trial.in_range_min,
                     "share of a link's silhouette that the laser must look at");
  command.add_option("--silhouette-min-pixels", trial.silhouette_min_pixels);
  command.add_option("--found-min", options.found_min)->check(CLI::Range(0.0, 1.0));
  command.add_option("--flagged-max", options.flagged_max)->check(CLI::Range(0.0, 1.0));
}

std::string rowOf(const OcclusionTrial::Result& r) {
  const auto number = [](const std::optional<double>& n) { return n ? fixed(*n, 4) : ""; };
  std::string row = std::to_string(r.seed) + ',' + r.scene + ',' + r.obstacle + ',' +
                    fixed(r.tilt_phase, 4) + ',' + number(r.beam_s) + ',';
  row += r.link ? r.link->name + ',' + fixed(r.link->hidden, 4) + ',' + fixed(r.link->occluded, 4) +
                      ',' + number(r.link->found_s) + ','
                : ",,,,";
  return row + (r.false_flag ? r.false_flag->name + ',' + fixed(r.false_flag->occluded, 4) : ",") +
         '\n';
}

void add(const std::vector<OcclusionTrial::Result>& trials, const OcclusionOptions& options,
         Findings& findings) {
  std::size_t hidden = 0, found = 0, without = 0, flagged = 0;
  std::vector<double> delays_s;
  for (const OcclusionTrial::Result& trial : trials) {
    findings.rows += rowOf(trial);
    findings.simulated_s += trial.simulated_s;
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
  const auto delayAt = [&delays_s](double share) {
    if (delays_s.empty()) return 0.0;
    return delays_s[static_cast<std::size_t>(share * static_cast<double>(delays_s.size() - 1))];
  };
  const auto shareOf = [](std::size_t part, std::size_t whole) {
    return static_cast<double>(part) / static_cast<double>(std::max<std::size_t>(whole, 1));
  };
  findings.figures = {{"hiding", hidden},
                      {"found", found},
                      {"found_share", shareOf(found, hidden)},
                      {"without", without},
                      {"flagged", flagged},
                      {"flagged_share", shareOf(flagged, without)},
                      {"delay_s", {{"p50", delayAt(0.5)}, {"p99", delayAt(0.99)}}}};
  char line[250];
  std::snprintf(
      line, sizeof line,
      "hidden         %zu links by more than %.0f %%: %zu found within one tilt (%.2f %%), "
      "%.0f ms after the first beam on the occluder, p99 %.0f ms",
      hidden, 100.0 * options.trial.hidden_min, found, 100.0 * shareOf(found, hidden),
      1e3 * delayAt(0.5), 1e3 * delayAt(0.99));
  findings.lines.emplace_back(line);
  std::snprintf(line, sizeof line, "without        %zu poses: %zu flagged (%.2f %%)", without,
                flagged, 100.0 * shareOf(flagged, without));
  findings.lines.emplace_back(line);
  if (hidden > 0 && shareOf(found, hidden) < options.found_min) {
    findings.missed.emplace_back("found");
  }
  if (shareOf(flagged, without) > options.flagged_max) findings.missed.emplace_back("flagged");
}

Findings runOcclusion(OcclusionOptions options, const TrialOptions& common,
                      const Progress& progress) {
  const MonitorConfig settings = trialSettings(common);
  options.trial.monitor = settings.monitor();
  options.trial.validate();
  const auto model = std::make_shared<const RobotModel>(dualArmUrdf(), settings.robot);
  std::vector<OcclusionTrial::Result> trials(options.trials);
  const auto work = [&](std::size_t i) {
    trials[i] = OcclusionTrial(options.trial, model, seedOf(common, i)).run();
  };
  inParallel(trials.size(), common.jobs, work, progress);
  Findings findings;
  add(trials, options, findings);
  findings.settings = {
      {"trials", options.trials},
      {"obstacle_speed_mps", options.trial.obstacle_speed_mps},
      {"noise_m", options.trial.noise_m},
      {"clearance_m", options.trial.clearance_m},
      {"hidden_min", options.trial.hidden_min},
      {"in_range_min", options.trial.in_range_min},
      {"silhouette_min_pixels", options.trial.silhouette_min_pixels},
      {"occlusion_hidden_fraction", options.trial.monitor.checker.pose.occlusion.hidden_fraction}};
  findings.rows =
      "seed,scene,obstacle,tilt_phase,beam_s,link,hidden,occluded,found_s,flagged,flagged_"
      "occluded\n" +
      findings.rows;
  return findings;
}

}  // namespace

Experiment occlusionExperiment(CLI::App& app) {
  auto options = std::make_shared<OcclusionOptions>();
  CLI::App* command = app.add_subcommand(
      "occlusion", "something comes between laser and arms: is what it hides found?");
  declare(*command, *options);
  return {command, [options](const TrialOptions& common, const Progress& progress) {
            return runOcclusion(*options, common, progress);
          }};
}

}  // namespace tccm::simulation
