#include <algorithm>
#include <vector>

#include "experiments/csv.h"
#include "experiments/experiment.h"
#include "experiments/options.h"
#include "experiments/result_members.h"
#include "experiments/small_object_trial.h"
#include "tccm_monitor/config_error.h"

namespace tccm::simulation {
namespace {

constexpr About kAbout = {
    "small-objects", "a small box anywhere near: is it found within one tilt?",
    R"(A small box appears in the air, at each place of an even grid in turn that the tilting
laser can see, or the camera that is in its place, at a phase and an angle of its own. It is
found when a link of its size and place would be in contact.
Limit: all are found within one tilt, or one frame of the camera.)"};

struct SmallObjectOptions {
  SmallObjectTrial::Config trial;
  double within_m = 1.0;
  double step_m = 0.1;
  std::size_t phases = 2;
};

void declare(CLI::App& command, SmallObjectOptions& options) {
  command.add_option("--size-m", options.trial.size_m, "edge of the box");
  command.add_option("--within-m", options.within_m, "of the laser or camera");
  command.add_option("--step-m", options.step_m, "between places");
  command.add_option("--phases", options.phases, "trials at each place")
      ->check(CLI::Range(1, 1000));
  addNoise(command, options.trial.scanner.noise_m);
  command.add_option("--tilt-period", options.trial.tilt.period_s, "[s]")
      ->check(CLI::Range(0.2, 60.0));
}

Json settingsOf(const SmallObjectOptions& options) {
  return {{"size_m", options.trial.size_m},
          {"within_m", options.within_m},
          {"step_m", options.step_m},
          {"phases", options.phases},
          {"noise_m", options.trial.scanner.noise_m},
          {"tilt_period_s", options.trial.tilt.period_s}};
}

constexpr char kColumns[] = "seed,x,y,z,yaw_rad,tilt_phase,beam_s,found_s";

std::string rowOf(const SmallObjectTrial::Result& r) {
  return csvRow(r.seed, fixed(r.place.x(), 3), fixed(r.place.y(), 3), fixed(r.place.z(), 3),
                fixed(r.yaw_rad, 4), fixed(r.tilt_phase, 4), fixed(r.beam_s, 4),
                fixed(r.found_s, 4));
}

Findings findingsOf(const std::vector<SmallObjectTrial::Result>& trials,
                    const SmallObjectOptions& options) {
  Findings findings(settingsOf(options), kColumns);
  const SmallObjectTrial::Config& trial = options.trial;
  const double limit_s = trial.limit();
  std::size_t found = 0;
  double latest_s = 0.0, slowest_s = 0.0;
  for (const SmallObjectTrial::Result& result : trials) {
    findings.add(rowOf(result), result.simulated_s);
    if (!result.found_s || *result.found_s > limit_s) continue;
    ++found;
    latest_s = std::max(latest_s, *result.found_s);
    slowest_s = std::max(slowest_s, *result.found_s - *result.beam_s);
  }
  findings.figures = {{"places", trials.size() / options.phases},
                      {"trials", trials.size()},
                      {"found", found},
                      {"latest_s", latest_s},
                      {"slowest_after_beam_s", slowest_s}};
  findings.lines.push_back(
      formatted("found          %zu of %zu within one %s, at %zu places; at the latest after "
                "%.0f ms, %.0f ms after the first beam",
                found, trials.size(), trial.ofCamera() ? "frame" : "tilt",
                trials.size() / options.phases, 1e3 * latest_s, 1e3 * slowest_s));
  if (found < trials.size()) findings.missed.emplace_back("found");
  return findings;
}

Findings runSmallObjects(SmallObjectOptions options, const TrialRun& run) {
  run.prepare(options.trial);
  const std::vector<Vector3> places =
      smallObjectPlaces(options.trial, run.model, options.within_m, options.step_m);
  if (places.empty()) throw ConfigError("within_m, step_m: the sensor sees no place of the grid");
  const std::size_t count = options.phases * places.size();
  const auto trials = run.results(count, [&](std::size_t i, std::uint64_t seed) {
    return SmallObjectTrial(options.trial, run.model, places[i / options.phases], seed).run();
  });
  return findingsOf(trials, options);
}

}  // namespace

Experiment smallObjectExperiment(CLI::App& app) {
  return experiment(app, kAbout, declare, runSmallObjects);
}

}  // namespace tccm::simulation
