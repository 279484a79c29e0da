#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "experiments/archive.h"
#include "experiments/parallel.h"
#include "experiments/sensor_options.h"
#include "monitor_config.h"
#include "tccm_monitor/robot_model.h"
#include "tools/program.h"

namespace tccm::simulation {

using Json = nlohmann::ordered_json;

/// What all experiments are told.
struct TrialOptions {
  std::uint64_t seed = 1;
  int jobs = 1;        ///< threads
  std::string config;  ///< path of a YAML file with the nodelets' parameters; may be empty
  std::string out;     ///< folder
  bool no_pictures = false;
  std::string
      scheduler;     ///< address of a Dask scheduler, whose workers run the cases; may be empty
  std::string part;  ///< K/N: of N programs that share the cases this is number K; may be empty
  std::string join;  ///< folder with what N such programs found; may be empty
  std::string experiment;  ///< its name
  SensorOptions sensors;
};

/// Thrown once a part of the cases has been run and written: there is nothing else to be found.
struct PartDone {};

/// Whether a trial's Config has a SensorChoice.
template <typename Config, typename = void>
struct TakesSensors : std::false_type {};
template <typename Config>
struct TakesSensors<Config, std::void_t<decltype(std::declval<Config>().sensors)>>
    : std::true_type {};

/// What the trials of a run have in common.
struct TrialRun {
  /// @throws ConfigError
  TrialRun(const TrialOptions& options, Progress progress);

  TrialOptions options;
  Progress progress;
  MonitorConfig settings;                   ///< as configured, but without what no verdict rests on
  SensorChoice sensors;                     ///< of which the settings know
  std::shared_ptr<const RobotModel> model;  ///< what the monitor takes the robot for

  /// Gives the trials the monitor as configured. @throws ConfigError
  template <typename Config>
  void prepare(Config& trial) const {
    prepare(trial, settings);
  }
  /// The same with settings of one's own. @throws InputError where the trials know the laser alone,
  /// and there are other sensors.
  template <typename Config>
  void prepare(Config& trial, const MonitorConfig& own) const {
    if constexpr (TakesSensors<Config>::value) {
      trial.sensors = sensors;
    } else {
      requireLaserAlone();
    }
    trial.monitor = own.monitor();
    trial.validate();
  }
  /// @throws InputError
  void requireLaserAlone() const;
  /// The seed of a trial: those of one run differ by one, those of different runs by more.
  [[nodiscard]] std::uint64_t seedOf(std::size_t trial) const;
  /// As inParallel() of parallel.h, on the threads asked for; or a part of it, or none, where what
  /// other programs found is joined. @param archived archives what work(i) found.
  /// @throws PartDone, InputError
  void forEach(std::size_t count, const std::function<void(std::size_t)>& work,
               const std::function<void(std::size_t, Archive&)>& archived) const;
  /// Of experiments whose cases cannot be shared. @throws InputError where they are to be.
  void requireWhole() const;
  /// What trial(i, seed) returns for each i below count.
  template <typename Trial>
  [[nodiscard]] auto results(std::size_t count, const Trial& trial) const {
    std::vector<decltype(trial(std::size_t{}, std::uint64_t{}))> results(count);
    forEach(
        count, [&](std::size_t i) { results[i] = trial(i, seedOf(i)); },
        [&](std::size_t i, Archive& archive) { archive(results[i]); });
    return results;
  }
  /// Of trials that differ by their seeds alone.
  template <typename Trial>
  [[nodiscard]] std::vector<typename Trial::Result> resultsOf(
      std::size_t count, const typename Trial::Config& config) const {
    return results(
        count, [&](std::size_t, std::uint64_t seed) { return Trial(config, model, seed).run(); });
  }
};

/// What an experiment found.
struct Findings {
  /// @param settings that differ from run to run. @param columns of its rows.
  Findings(Json settings, const std::string& columns)
      : settings(std::move(settings)), rows(columns + '\n') {}

  Json settings;
  Json figures;
  std::string rows;                          ///< CSV, the first line names the columns
  std::map<std::string, std::string> files;  ///< others, by name
  std::vector<std::string> lines;            ///< for people
  std::vector<std::string> missed;           ///< limits
  double simulated_s = 0.0;
  double not_simulating_s = 0.0;  ///< that it took to measure other things, after the simulation
  Json timing;                    ///< other than of the whole: not repeatable

  /// Of one trial.
  void add(const std::string& row, double row_simulated_s) {
    rows += row;
    simulated_s += row_simulated_s;
  }
  void addLines(const std::vector<std::string>& more) {
    lines.insert(lines.end(), more.begin(), more.end());
  }
};

/// One of the program's subcommands.
struct Experiment {
  CLI::App* command = nullptr;
  /// @throws ConfigError and InputError for what is asked for wrongly.
  std::function<Findings(const TrialRun&)> run;
};

/// What help says of an experiment.
struct About {
  const char* name;
  const char* description;  ///< in one line
  const char* footer;       ///< what is done, and which limits there are
};

/// @param declare adds the options. @param run is handed what they were on the command line.
template <typename Options>
[[nodiscard]] Experiment experiment(CLI::App& app, const About& about,
                                    void (*declare)(CLI::App&, Options&),
                                    Findings (*run)(Options, const TrialRun&),
                                    const Options& defaults = {}) {
  const auto options = std::make_shared<Options>(defaults);
  CLI::App* command = app.add_subcommand(about.name, about.description);
  command->footer(about.footer);
  command->option_defaults()->always_capture_default();
  declare(*command, *options);
  return {command, [options, run](const TrialRun& trials) { return run(*options, trials); }};
}

/// Each declares its subcommand with its options.
[[nodiscard]] Experiment stoppingExperiment(CLI::App& app);
[[nodiscard]] Experiment hoverExperiment(CLI::App& app);
[[nodiscard]] Experiment visibilityExperiment(CLI::App& app);
[[nodiscard]] Experiment handsExperiment(CLI::App& app);
[[nodiscard]] Experiment falseStopsExperiment(CLI::App& app);
[[nodiscard]] Experiment occlusionExperiment(CLI::App& app);
[[nodiscard]] Experiment smallObjectExperiment(CLI::App& app);
[[nodiscard]] Experiment updatesExperiment(CLI::App& app);
[[nodiscard]] Experiment governedExperiment(CLI::App& app);
[[nodiscard]] Experiment dynamicExperiment(CLI::App& app);
[[nodiscard]] Experiment goalsExperiment(CLI::App& app);

}  // namespace tccm::simulation
