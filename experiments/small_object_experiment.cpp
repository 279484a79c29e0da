#include <algorithm>
#include <memory>
#include <vector>

#include "experiments/csv.h"
#include "experiments/experiment.h"
#include "experiments/parallel.h"
#include "experiments/small_object_trial.h"
#include "simulation/robot/dual_arm.h"
#include "tccm_monitor/config_error.h"

namespace tccm::simulation {
namespace {

struct SmallObjectOptions {
  SmallObjectTrial::Config trial;
  double within_m = 1.0;
  double step_m = 0.1;
  std::size_t phases = 2;
};

void declare(CLI::App& command, SmallObjectOptions& options) {
  command.footer(
      "A small box appears in the air, at each place of an even grid in turn that the tilting\n"
      "laser can see, at a phase and an angle of its own. It is found when a link of its size and\n"
      "place would be in contact.\n"
      "Limit: all are found within one tilt.");
  command.option_defaults()->always_capture_default();
  command.add_option("--size-m", options.trial.size_m, "edge of the box");
  command.add_option("--within-m", options.within_m, "of the laser");
  command.add_option("--step-m", options.step_m, "between places");
  command.add_option("--phases", options.phases, "trials at each place")
      ->check(CLI::Range(1, 1000));
  command.add_option("--noise-m", options.trial.scanner.noise_m, "standard deviation of a range");
  command.add_option("--tilt-period", options.trial.tilt.period_s, "[s]")
      ->check(CLI::Range(0.2, 60.0));
}

std::string rowOf(const SmallObjectTrial::Result& r) {
  const auto number = [](const std::optional<double>& n) { return n ? fixed(*n, 4) : ""; };
  return std::to_string(r.seed) + ',' + fixed(r.place.x(), 3) + ',' + fixed(r.place.y(), 3) + ',' +
         fixed(r.place.z(), 3) + ',' + fixed(r.yaw_rad, 4) + ',' + fixed(r.tilt_phase, 4) + ',' +
         number(r.beam_s) + ',' + number(r.found_s) + '\n';
}

void add(const std::vector<SmallObjectTrial::Result>& trials, const SmallObjectOptions& options,
         Findings& findings) {
  const SmallObjectTrial::Config& trial = options.trial;
  const double tilt_s = trial.tilt.period_s + trial.scanner.period_s;
  std::size_t found = 0;
  double latest_s = 0.0, slowest_s = 0.0;
  for (const SmallObjectTrial::Result& result : trials) {
    findings.rows += rowOf(result);
    findings.simulated_s += result.simulated_s;
    if (!result.found_s || *result.found_s > tilt_s) continue;
    ++found;
    latest_s = std::max(latest_s, *result.found_s);
    slowest_s = std::max(slowest_s, *result.found_s - *result.beam_s);
  }
  findings.figures = {{"places", trials.size() / options.phases},
                      {"trials", trials.size()},
                      {"found", found},
                      {"latest_s", latest_s},
                      {"slowest_after_beam_s", slowest_s}};
  char line[200];
  std::snprintf(line, sizeof line,
                "found          %zu of %zu within one tilt, at %zu places; at the latest after "
                "%.0f ms, %.0f ms after the first beam",
                found, trials.size(), trials.size() / options.phases, 1e3 * latest_s,
                1e3 * slowest_s);
  findings.lines.emplace_back(line);
  if (found < trials.size()) findings.missed.emplace_back("found");
}

Findings runSmallObjects(SmallObjectOptions options, const TrialOptions& common,
                         const Progress& progress) {
  const MonitorConfig settings = trialSettings(common);
  options.trial.monitor = settings.monitor();
  options.trial.validate();
  const auto model = std::make_shared<const RobotModel>(dualArmUrdf(), settings.robot);
  const std::vector<Vector3> places =
      smallObjectPlaces(options.trial, model, options.within_m, options.step_m);
  if (places.empty()) throw ConfigError("within_m, step_m: the laser sees no place of the grid");
  std::vector<SmallObjectTrial::Result> trials(options.phases * places.size());
  const auto work = [&](std::size_t i) {
    const Vector3& place = places[i / options.phases];
    trials[i] = SmallObjectTrial(options.trial, model, place, seedOf(common, i)).run();
  };
  inParallel(trials.size(), common.jobs, work, progress);
  Findings findings;
  add(trials, options, findings);
  findings.settings = {{"size_m", options.trial.size_m},
                       {"within_m", options.within_m},
                       {"step_m", options.step_m},
                       {"phases", options.phases},
                       {"noise_m", options.trial.scanner.noise_m},
                       {"tilt_period_s", options.trial.tilt.period_s}};
  findings.rows = "seed,x,y,z,yaw_rad,tilt_phase,beam_s,found_s\n" + findings.rows;
  return findings;
}

}  // namespace

Experiment smallObjectExperiment(CLI::App& app) {
  auto options = std::make_shared<SmallObjectOptions>();
  CLI::App* command = app.add_subcommand("small-objects",
                                         "a small box anywhere near: is it found within one tilt?");
  declare(*command, *options);
  return {command, [options](const TrialOptions& common, const Progress& progress) {
            return runSmallObjects(*options, common, progress);
          }};
}

}  // namespace tccm::simulation
