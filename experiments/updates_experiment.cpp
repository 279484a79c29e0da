#include <algorithm>
#include <array>
#include <chrono>
#include <deque>
#include <limits>
#include <memory>
#include <vector>

#include "experiments/csv.h"
#include "experiments/experiment.h"
#include "experiments/markdown_table.h"
#include "experiments/options.h"
#include "experiments/statistics.h"
#include "map/integration_map.h"
#include "simulation/monitored_simulation.h"
#include "support/literal_map.h"

namespace tccm::simulation {
namespace {

constexpr About kAbout = {
    "updates", "what an update of the map takes, and how light the map is",
    R"(The paper's Fig. 9: what one scan's update of the map takes, by replacement and by adding
all part maps anew, over the number of part maps; the same scans of a tilt over a table,
places of the returns found in either. Means over all scans, of each one's median, stand in
timing.json. Then the cuboids of a whole sweep of each scene, and their bytes.
Limits: with 200 part maps replacement takes at most 1.3 times as long as with 5; with 40
it is at least 30 times as fast as adding.)"};

using Points = std::vector<Vector3>;
using Clock = std::chrono::steady_clock;

constexpr std::size_t kScans = 225;  // of 28 ms: four tilts
constexpr std::size_t kTilt = 56;    // scans

struct UpdatesOptions {
  std::vector<std::size_t> windows = {5, 10, 20, 40, 80, 120, 160, 200};
  std::size_t steps = 3 * kScans;
  std::size_t additions = kTilt;
  std::vector<std::string> scenes = {"table", "shelf"};
};

void declare(CLI::App& command, UpdatesOptions& options) {
  addList(command, "--windows", options.windows, CLI::Range(1, 500), "part maps, rising");
  command.add_option("--steps", options.steps, "timed of each by replacement")
      ->check(CLI::Range(1, 1000000));
  command.add_option("--additions", options.additions, "timed of each by adding")
      ->check(CLI::Range(1, 100000));
}

/// What tilts over a scene bring, and the map of a whole one.
struct Sweep {
  std::vector<Points> scans;
  std::size_t cuboids = 0;
  std::size_t held = 0;     ///< of the cuboids
  std::size_t returns = 0;  ///< in the map's window: in the others
};

Sweep sweepOf(const std::string& scene, const TrialRun& run, std::size_t scans) {
  constexpr double kWhole = 5.0;  // [s] after which the map holds a tilt
  Simulator::Config config;
  config.scene = scene;
  config.seed = run.options.seed;
  MonitoredSimulation simulation(config, run.settings.monitor(), run.model);
  simulation.simulator().setStop(true);  // the arms stay where they begin
  Sweep sweep;
  const Time start = simulation.simulator().now();
  simulation.onScan([&](const SimulatedScan&) {
    if (simulation.simulator().now() < start + fromSeconds(kWhole)) return;
    if (sweep.scans.empty()) {
      const CuboidMap& map = *simulation.monitor().map();
      sweep.cuboids = map.cuboids.size();
      for (const Cuboid& cuboid : map.cuboids) {
        sweep.held += cuboid.held ? 1 : 0;
        sweep.returns += cuboid.held ? 0 : cuboid.points;
      }
    }
    Points points;
    for (const Beam& beam : simulation.monitor().assembled().beams) {
      if (beam.kind == BeamKind::kReturn) points.push_back(beam.p_fixed);
    }
    sweep.scans.push_back(std::move(points));
  });
  while (sweep.scans.size() < scans) simulation.step();
  return sweep;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

template <typename Step>
double microseconds(Step&& step) {
  const auto start = Clock::now();
  step();
  return std::chrono::duration<double, std::micro>(Clock::now() - start).count();
}

/// Of steps that take the same scans in turn: some see much of the map's area, some nothing.
class StepTimes {
 public:
  template <typename Step>
  void measure(std::size_t scan, Step&& step) {
    by_scan_[scan % kScans].push_back(microseconds(step));
  }
  /// The mean over the scans of each one's median [us].
  [[nodiscard]] double typical() const {
    double sum = 0.0;
    std::size_t scans = 0;
    for (const std::vector<double>& times : by_scan_) {
      if (times.empty()) continue;
      sum += median(times);
      ++scans;
    }
    return scans > 0 ? sum / static_cast<double>(scans) : 0.0;
  }

 private:
  std::array<std::vector<double>, kScans> by_scan_;
};

/// A window of so many part maps that goes on by replacement.
class Replacement {
 public:
  Replacement(const Sweep& sweep, const IntegrationMap::Config& config, std::size_t window)
      : scans_(sweep.scans), window_(window), map_(std::make_unique<IntegrationMap>(config)) {
    for (std::size_t i = 0; i < window_ + scans_.size(); ++i) step();
  }
  /// What else the machine does comes and goes: the best of several calls counts.
  void measure(std::size_t steps) {
    StepTimes times;
    for (std::size_t i = 0; i < steps; ++i) times.measure(i, [&] { step(); });
    best_us_ = std::min(best_us_, times.typical());
  }
  [[nodiscard]] double best() const { return best_us_; }  ///< [us]

 private:
  void step() {
    map_->add(Time(Duration(map_->serial())), scans_[map_->serial() % scans_.size()]);
    if (map_->scans() > window_) map_->expireOldest();
  }

  const std::vector<Points>& scans_;
  std::size_t window_;
  std::unique_ptr<IntegrationMap> map_;
  double best_us_ = std::numeric_limits<double>::infinity();
};

/// Section III.C.1.
double addition(const Sweep& sweep, const IntegrationMap::Config& config, std::size_t window,
                std::size_t steps) {
  const Grid grid(config.grid);
  const int thickness = grid.heightOf(config.thickness_m);
  std::deque<test::LiteralPartMap> part_maps;
  std::uint32_t next = 0;
  std::size_t columns = 0;
  const auto keep = [&] {
    std::vector<MappedReturn> returns;
    for (const Vector3& p_fixed : sweep.scans[next % sweep.scans.size()]) {
      if (const auto place = grid.place(p_fixed)) returns.push_back({place->cell, place->height});
    }
    part_maps.push_back(test::literalPartMap(returns, thickness, next));
    ++next;
    if (part_maps.size() > window) part_maps.pop_front();
  };
  const auto step = [&] {
    keep();
    columns += test::additionOfAll(part_maps, grid.cells()).size();
  };
  while (part_maps.size() < window) keep();
  StepTimes times;
  for (std::size_t i = 0; i < steps; ++i) times.measure(i, step);
  return columns > 0 ? times.typical() : 0.0;
}

void add(const std::string& scene, const Sweep& sweep, Findings& findings) {
  const std::size_t bytes = sweep.cuboids * sizeof(Cuboid);
  findings.add(csvRow(scene, sweep.cuboids, sweep.held, sweep.returns, bytes),
               0.028 * static_cast<double>(sweep.scans.size()) + 5.0);
  findings.figures["scenes"].push_back({{"scene", scene},
                                        {"cuboids", sweep.cuboids},
                                        {"held", sweep.held},
                                        {"returns", sweep.returns},
                                        {"bytes", bytes}});
  findings.lines.push_back(
      formatted("%s: %zu cuboids, %zu of them held, of %zu returns in the window, %zu bytes",
                scene.c_str(), sweep.cuboids, sweep.held, sweep.returns, bytes));
}

/// All windows, in turn.
std::vector<Replacement> replacementsOf(const Sweep& sweep, const IntegrationMap::Config& config,
                                        const UpdatesOptions& options) {
  constexpr std::size_t kRounds = 3;
  std::vector<Replacement> replacements;
  for (const std::size_t window : options.windows) replacements.emplace_back(sweep, config, window);
  for (std::size_t round = 0; round < kRounds; ++round) {
    for (Replacement& replacement : replacements) replacement.measure(options.steps);
  }
  return replacements;
}

void compare(const Sweep& sweep, const IntegrationMap::Config& config,
             const UpdatesOptions& options, const Progress& progress, Findings& findings) {
  constexpr double kRise = 1.3;
  constexpr double kFaster = 30.0;
  const std::vector<Replacement> replacements = replacementsOf(sweep, config, options);
  MarkdownTable table;
  for (const char* column : {"part maps", "replacement [us]", "adding all [us]", "ratio"}) {
    table.addColumn(column);
  }
  double ratio_at_40 = kFaster;
  for (std::size_t i = 0; i < options.windows.size(); ++i) {
    const std::size_t window = options.windows[i];
    const double replace_us = replacements[i].best();
    const double add_us = addition(sweep, config, window, options.additions);
    if (window == 40) ratio_at_40 = add_us / replace_us;
    findings.timing["updates"].push_back(
        {{"part_maps", window}, {"replacement_us", replace_us}, {"addition_us", add_us}});
    table.addRow({std::to_string(window), fixed(replace_us, 1), fixed(add_us, 0),
                  fixed(add_us / replace_us, 1)});
    if (progress) progress(share(i + 1, options.windows.size()));
  }
  const double rise = replacements.back().best() / replacements.front().best();
  findings.addLines(table.lines());
  findings.lines.push_back(formatted("rise           %.2f times from %zu to %zu part maps", rise,
                                     options.windows.front(), options.windows.back()));
  if (rise > kRise) findings.missed.emplace_back("rise");
  if (ratio_at_40 < kFaster) findings.missed.emplace_back("ratio_at_40");
}

Findings runUpdates(UpdatesOptions options, const TrialRun& run) {
  run.requireLaserAlone();
  run.requireWhole();
  Findings findings(
      {{"windows", options.windows}, {"steps", options.steps}, {"additions", options.additions}},
      "scene,cuboids,held,returns,bytes");
  std::vector<Sweep> sweeps;
  for (const std::string& scene : options.scenes) {
    // Of the others the map is wanted alone.
    sweeps.push_back(sweepOf(scene, run, sweeps.empty() ? kScans : 1));
    add(scene, sweeps.back(), findings);
  }
  const auto simulated = Clock::now();
  compare(sweeps.front(), run.settings.mapper.mapper.map, options, run.progress, findings);
  findings.not_simulating_s = std::chrono::duration<double>(Clock::now() - simulated).count();
  return findings;
}

}  // namespace

Experiment updatesExperiment(CLI::App& app) { return experiment(app, kAbout, declare, runUpdates); }

}  // namespace tccm::simulation
