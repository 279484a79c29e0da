#include <algorithm>
#include <map>
#include <memory>
#include <optional>

#include "experiments/csv.h"
#include "experiments/experiment.h"
#include "experiments/ghost_trial.h"
#include "experiments/hover_trial.h"
#include "experiments/parallel.h"
#include "simulation/robot/dual_arm.h"

namespace tccm::simulation {
namespace {

using Json = nlohmann::ordered_json;
using Outcome = HoverTrial::Outcome;

struct HoverOptions {
  HoverTrial::Config trial;
  double ghost_noise_m = 0.01;
  std::size_t trials = 300;
  std::size_t ghosts = 30;
  std::optional<double> hold_s;  ///< nothing: as configured
};

void declare(CLI::App& command, HoverOptions& options) {
  HoverTrial::Config& trial = options.trial;
  command.footer(
      "The hand comes over an object from aside, from behind or from above, hovers, and so hides\n"
      "it from the laser; then it moves straight down, and obeys the monitor. Object, size, "
      "place,\n"
      "gap, way, noise and phase of the tilt are drawn. Then ghosts: a person's hand goes away\n"
      "behind the arm; once its place is in view again the map may show it for two tilts.\n"
      "Limits: no object touched, every trial started and decided, no ghost left.");
  command.option_defaults()->always_capture_default();
  command.add_option("--trials", options.trials)->check(CLI::Range(0, 100000));
  command.add_option("--ghosts", options.ghosts, "trials with a person's hand")
      ->check(CLI::Range(0, 100000));
  command
      .add_option("--hold-s", options.hold_s,
                  "for how long the map holds what the robot hides; 0: not at all; without this "
                  "option as configured")
      ->check(CLI::Range(0.0, 600.0));
  command.add_option("--hover-s", trial.hover_s, "how long the hand hovers");
  command.add_option("--speed", trial.down_mps, "downwards [m/s]");
  command.add_option("--gap-min-m", trial.ranges.gap_min_m, "between hovering hand and object");
  command.add_option("--gap-max-m", trial.ranges.gap_max_m);
  command.add_option("--noise-min-m", trial.ranges.noise_min_m, "standard deviation of a range");
  command.add_option("--noise-max-m", trial.ranges.noise_max_m);
  command.add_option("--ghost-noise-m", options.ghost_noise_m, "the same, of trials with ghosts");
  command.add_option("--latency-s", trial.controller.latency_s, "from the stop to the brake");
  command.add_option("--deceleration", trial.controller.acceleration_mps2, "of the hand [m/s^2]");
}

std::string rowOf(const HoverTrial::Result& r) {
  return "hover," + std::to_string(r.seed) + ',' + r.object + ',' + r.approach + ',' +
         fixed(r.gap_m, 4) + ',' + fixed(r.noise_m, 4) + ',' + name(r.outcome) + ',' + r.reason +
         ',' + fixed(r.left_m, 4) + ',' + fixed(r.stop_left_m, 4) + ',' +
         std::to_string(r.held_max) + ',' + fixed(r.held_mean, 1) + ",,,\n";
}

std::string rowOf(const GhostTrial::Result& r, double noise_m) {
  const std::string gone = r.gone_after_s ? fixed(*r.gone_after_s, 3) : "";
  return "ghost," + std::to_string(r.seed) + ",hand,,," + fixed(noise_m, 4) + ',' +
         (r.left == 0 ? "gone" : "left") + ",,,," + std::to_string(r.held_max) + ",," +
         std::to_string(r.left) + ',' + std::to_string(r.left_held) + ',' + gone + '\n';
}

/// Least, mean and greatest of some numbers; null where there are none.
Json spread(std::vector<double> numbers) {
  if (numbers.empty()) return nullptr;
  double sum = 0.0;
  for (const double number : numbers) sum += number;
  const auto [least, most] = std::minmax_element(numbers.begin(), numbers.end());
  return {{"least", *least}, {"mean", sum / static_cast<double>(numbers.size())}, {"most", *most}};
}

class Hovers {
 public:
  explicit Hovers(std::vector<HoverTrial::Result> results) : results_(std::move(results)) {
    for (const HoverTrial::Result& result : results_) ++counts_[result.outcome];
  }

  [[nodiscard]] std::size_t of(Outcome outcome) const {
    const auto found = counts_.find(outcome);
    return found == counts_.end() ? 0 : found->second;
  }
  [[nodiscard]] Json figures() const {
    std::vector<double> left_m, stop_left_m, held_max, held_mean;
    std::map<std::string, std::size_t> reasons;
    for (const HoverTrial::Result& result : results_) {
      held_max.push_back(static_cast<double>(result.held_max));
      held_mean.push_back(result.held_mean);
      if (result.outcome != Outcome::kStopped) continue;
      left_m.push_back(result.left_m);
      stop_left_m.push_back(result.stop_left_m);
      ++reasons[result.reason];
    }
    Json json = {{"trials", results_.size()}};
    for (const Outcome outcome :
         {Outcome::kStopped, Outcome::kTouched, Outcome::kNotStarted, Outcome::kUndecided}) {
      json[name(outcome)] = of(outcome);
    }
    json["left_m"] = spread(left_m);
    json["left_when_permission_went_m"] = spread(stop_left_m);
    json["held_intervals_max"] = spread(held_max);
    json["held_intervals_mean"] = spread(held_mean);
    json["stopped_by"] = reasons;
    return json;
  }
  void addTo(Findings& findings) const {
    for (const HoverTrial::Result& result : results_) {
      findings.rows += rowOf(result);
      findings.simulated_s += result.simulated_s;
    }
    findings.figures["hover"] = figures();
    findings.lines.push_back("hovering       " + std::to_string(results_.size()) +
                             " trials: " + std::to_string(of(Outcome::kStopped)) +
                             " stopped before the object, " +
                             std::to_string(of(Outcome::kTouched)) + " touched it, " +
                             std::to_string(of(Outcome::kNotStarted)) + " not started, " +
                             std::to_string(of(Outcome::kUndecided)) + " undecided");
    if (of(Outcome::kTouched) > 0) findings.missed.emplace_back("contacts");
    if (of(Outcome::kNotStarted) > 0) findings.missed.emplace_back("not_started");
    if (of(Outcome::kUndecided) > 0) findings.missed.emplace_back("undecided");
  }

 private:
  std::vector<HoverTrial::Result> results_;
  std::map<Outcome, std::size_t> counts_;
};

void add(const std::vector<GhostTrial::Result>& results, double noise_m, Findings& findings) {
  std::size_t left = 0;
  std::size_t held = 0;
  std::vector<double> gone_after_s;
  for (const GhostTrial::Result& result : results) {
    findings.rows += rowOf(result, noise_m);
    findings.simulated_s += result.simulated_s;
    if (result.left > 0) ++left;
    if (result.held_max > 0) ++held;
    if (result.gone_after_s) gone_after_s.push_back(*result.gone_after_s);
  }
  findings.figures["ghosts"] = {{"trials", results.size()},
                                {"held_behind_the_arm", held},
                                {"left_after_two_tilts", left},
                                {"gone_after_s", spread(gone_after_s)}};
  findings.lines.push_back("ghosts         " + std::to_string(results.size()) + " trials: " +
                           std::to_string(held) + " held behind the arm, " + std::to_string(left) +
                           " left two tilts after their place was in view again");
  if (left > 0) findings.missed.emplace_back("ghosts");
}

Findings runHovers(HoverOptions options, const TrialOptions& common, const Progress& progress) {
  MonitorConfig settings = trialSettings(common);
  if (options.hold_s) settings.mapper.mapper.hold.longest_s = *options.hold_s;
  options.trial.monitor = settings.monitor();
  options.trial.validate();
  GhostTrial::Config ghost;
  ghost.monitor = options.trial.monitor;
  ghost.noise_m = options.ghost_noise_m;
  ghost.validate();
  const auto model = std::make_shared<const RobotModel>(dualArmUrdf(), settings.robot);
  std::vector<HoverTrial::Result> hovers(options.trials);
  std::vector<GhostTrial::Result> ghosts(options.ghosts);
  const auto work = [&](std::size_t i) {
    if (i < hovers.size()) {
      hovers[i] = HoverTrial(options.trial, model, seedOf(common, i)).run();
    } else {
      const std::size_t k = i - hovers.size();
      ghosts[k] = GhostTrial(ghost, model, seedOf(common, k)).run();
    }
  };
  inParallel(hovers.size() + ghosts.size(), common.jobs, work, progress);
  Findings findings;
  findings.settings = {
      {"hold_s", settings.mapper.mapper.hold.longest_s},
      {"hover_s", options.trial.hover_s},
      {"speed_mps", options.trial.down_mps},
      {"gap_m", {options.trial.ranges.gap_min_m, options.trial.ranges.gap_max_m}},
      {"noise_m", {options.trial.ranges.noise_min_m, options.trial.ranges.noise_max_m}},
      {"latency_s", options.trial.controller.latency_s},
      {"deceleration_mps2", options.trial.controller.acceleration_mps2}};
  findings.rows =
      "kind,seed,object,approach,gap_m,noise_m,outcome,reason,left_m,stop_left_m,held_max,"
      "held_mean,left_cuboids,left_held,gone_after_s\n";
  Hovers(std::move(hovers)).addTo(findings);
  add(ghosts, ghost.noise_m, findings);
  return findings;
}

}  // namespace

Experiment hoverExperiment(CLI::App& app) {
  auto options = std::make_shared<HoverOptions>();
  CLI::App* command = app.add_subcommand("hover", "a hand that hides what it is about to touch");
  declare(*command, *options);
  return {command, [options](const TrialOptions& common, const Progress& progress) {
            return runHovers(*options, common, progress);
          }};
}

}  // namespace tccm::simulation
