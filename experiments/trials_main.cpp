#include <ros/init.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "experiments/experiment.h"
#include "tools/program.h"

namespace tccm::simulation {
namespace {

void declare(CLI::App& app, TrialOptions& options) {
  app.footer(
      "Every experiment runs on the monitor's own classes, in simulated time; the same seed gives\n"
      "the same results.csv. DIR gets results.json (settings, figures, limits missed), "
      "results.csv\n"
      "(a row a case), timing.json (how long it took) and pictures.\n"
      "Exit status: 0 done, 1 a limit was missed, 2 bad input; 130 after Ctrl-C with --scheduler.\n"
      "Example: trials hover --trials 300 --jobs 2 --out result");
  app.require_subcommand(1);
  app.fallthrough();
  app.add_option("--out", options.out, "folder for the results; made where it is not there")
      ->required();
  app.add_option("--seed", options.seed)->capture_default_str();
  app.add_option("--jobs", options.jobs, "threads")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  options.sensors.declare(app);
  app.add_flag("--no-pictures", options.no_pictures, "no PNG files");
  auto* scheduler = app.add_option("--scheduler", options.scheduler,
                                   "ADDRESS of a Dask scheduler, whose workers run the cases; not "
                                   "for dynamic, updates, goals and --ros");
  auto* part =
      app.add_option("--part", options.part,
                     "K/N: runs each Nth case from number K on, and writes for --join what "
                     "it found; for --scheduler");
  app.add_option("--join", options.join,
                 "folder with N such parts, in place of running: with the same options it writes "
                 "what one run had written")
      ->excludes(scheduler, part);
  part->excludes(scheduler);
  app.add_option("--config", options.config,
                 "YAML with the nodelets' parameters, as config/simulation.yaml; without it the "
                 "defaults, and what the simulated robot needs");
}

void write(const TrialOptions& options, const std::string& experiment, const Findings& findings) {
  const std::filesystem::path folder(options.out);
  nlohmann::ordered_json results = {{"experiment", experiment}, {"seed", options.seed}};
  results["settings"] = findings.settings;
  if (!options.sensors.choice().isLaserAlone()) {
    results["sensors"] = options.sensors.sensors;
    results["camera"] = options.sensors.camera;
    results["camera_width"] = options.sensors.camera_width;
    results["camera_mixed_share"] = options.sensors.camera_mixed_share;
  }
  results["figures"] = findings.figures;
  results["limits_missed"] = findings.missed;
  writeText((folder / "results.json").string(), results.dump(2) + '\n');
  writeText((folder / "results.csv").string(), findings.rows);
  for (const auto& [name, text] : findings.files) writeText((folder / name).string(), text);
}

/// Of joined parts nobody knows how long they took.
void writeJoinedTiming(const TrialOptions& options, const Findings& findings) {
  nlohmann::ordered_json timing = {{"simulated_s", findings.simulated_s}};
  if (!findings.timing.is_null()) timing.update(findings.timing);
  writeText((std::filesystem::path(options.out) / "timing.json").string(), timing.dump(2) + '\n');
}

/// How long it took is no result: it differs from run to run.
void writeTiming(const TrialOptions& options, const Findings& findings, double took_s) {
  const double times_real_time = findings.simulated_s / (took_s - findings.not_simulating_s);
  nlohmann::ordered_json timing = {{"jobs", options.jobs},
                                   {"simulated_s", findings.simulated_s},
                                   {"took_s", took_s},
                                   {"not_simulating_s", findings.not_simulating_s},
                                   {"times_real_time", times_real_time}};
  if (!findings.timing.is_null()) timing.update(findings.timing);
  writeText((std::filesystem::path(options.out) / "timing.json").string(), timing.dump(2) + '\n');
  if (timing.contains("processing_us")) {
    std::printf("processing     %.2f ms from a scan's beams to the verdict at p99\n",
                1e-3 * timing["processing_us"]["p99"].get<double>());
  }
  std::printf("took           %.1f s", took_s);
  if (findings.not_simulating_s > 0.0) {
    std::printf(" (%.1f s of them measured without simulating)", findings.not_simulating_s);
  }
  std::printf(", %.0f times as fast as real time, on %d thread%s\n", times_real_time, options.jobs,
              options.jobs > 1 ? "s" : "");
}

/// Has a cluster run the cases: where the results go and what is read is told apart from the rest.
int spread(const TrialOptions& options, const std::vector<std::string>& arguments) {
  std::vector<std::string> call = {"--scheduler", options.scheduler, "--out", options.out};
  if (!options.config.empty()) {
    call.insert(call.end(), {"--config", std::filesystem::absolute(options.config).string()});
  }
  call.emplace_back("--");
  const std::set<std::string> told = {"--scheduler", "--out", "--config", "--jobs"};
  for (std::size_t i = 1; i < arguments.size(); ++i) {
    const std::size_t equals = arguments[i].find('=');
    if (told.count(arguments[i].substr(0, equals)) == 0) {
      call.push_back(arguments[i]);
    } else if (equals == std::string::npos) {
      ++i;  // its value
    }
  }
  return runScript("spread_trials", call);
}

int run(const Experiment& experiment, TrialOptions& options) {
  makeFolder(options.out);
  options.experiment = experiment.command->get_name();
  const auto start = std::chrono::steady_clock::now();
  const Findings findings = experiment.run(TrialRun(options, progressBar()));
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
  write(options, options.experiment, findings);
  for (const std::string& line : findings.lines) std::printf("%s\n", line.c_str());
  for (const std::string& limit : findings.missed)
    std::printf("limit missed   %s\n", limit.c_str());
  if (options.join.empty()) {
    writeTiming(options, findings, took.count());
  } else {
    writeJoinedTiming(options, findings);
  }
  if (!options.no_pictures && runScript("draw_trials", {options.out}) != kDone) {
    throw InputError("the pictures in " + options.out + " could not be drawn");
  }
  return findings.missed.empty() ? kDone : kLimitMissed;
}

/// @pre one of them was asked for
const Experiment& chosen(const std::vector<Experiment>& experiments) {
  for (const Experiment& experiment : experiments) {
    if (experiment.command->parsed()) return experiment;
  }
  return experiments.front();
}

int runTrials(int argc, char** argv) {
  CLI::App app("Closed-loop experiments with a simulated robot that obeys the monitor.", "trials");
  TrialOptions options;
  declare(app, options);
  const std::vector<Experiment> experiments = {
      stoppingExperiment(app),    hoverExperiment(app),   visibilityExperiment(app),
      governedExperiment(app),    handsExperiment(app),   falseStopsExperiment(app),
      occlusionExperiment(app),   updatesExperiment(app), dynamicExperiment(app),
      smallObjectExperiment(app), goalsExperiment(app)};
  std::vector<std::string> arguments;  // roslaunch adds some of its own
  ros::removeROSArgs(argc, argv, arguments);
  return runProgram(app, arguments, [&] {
    if (!options.scheduler.empty()) return spread(options, arguments);
    try {
      return run(chosen(experiments), options);
    } catch (const PartDone&) {
      return kDone;
    }
  });
}

}  // namespace
}  // namespace tccm::simulation

int main(int argc, char** argv) {
  try {
    return tccm::simulation::runTrials(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "trials: %s\n", error.what());
    return 1;
  }
}
