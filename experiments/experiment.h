#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "monitor_config.h"
#include "tools/program.h"

namespace tccm::simulation {

/// What all experiments are told.
struct TrialOptions {
  std::uint64_t seed = 1;
  int jobs = 1;        ///< threads
  std::string config;  ///< path of a YAML file with the nodelets' parameters; may be empty
  std::string out;     ///< folder
  bool no_pictures = false;
};

/// What an experiment found.
struct Findings {
  nlohmann::ordered_json settings;  ///< that differ from run to run
  nlohmann::ordered_json figures;
  std::string rows;                          ///< CSV, the first line names the columns
  std::map<std::string, std::string> files;  ///< others, by name
  std::vector<std::string> lines;            ///< for people
  std::vector<std::string> missed;           ///< limits
  double simulated_s = 0.0;
  double not_simulating_s = 0.0;  ///< that it took to measure other things, after the simulation
  nlohmann::ordered_json timing;  ///< other than of the whole: not repeatable
};

/// One of the program's subcommands.
struct Experiment {
  CLI::App* command = nullptr;
  /// @throws ConfigError and InputError for what is asked for wrongly.
  std::function<Findings(const TrialOptions&, const Progress&)> run;
};

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

/// The seed of a trial: those of one run differ by one, those of different runs by more.
[[nodiscard]] std::uint64_t seedOf(const TrialOptions& options, std::size_t trial);

/// As configured, but without what no verdict rests on. @throws ConfigError
[[nodiscard]] MonitorConfig trialSettings(const TrialOptions& options);

}  // namespace tccm::simulation
