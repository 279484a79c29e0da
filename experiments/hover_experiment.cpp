#include <algorithm>
#include <map>
#include <optional>

#include "experiments/csv.h"
#include "experiments/experiment.h"
#include "experiments/ghost_trial.h"
#include "experiments/hover_trial.h"
#include "experiments/options.h"
#include "experiments/result_members.h"

namespace tccm::simulation {
namespace {

constexpr About kAbout = {
    "hover", "a hand that hides what it is about to touch",
    R"(The hand comes over an object from aside, from behind or from above, hovers, and so hides
it from the laser; then it moves straight down, and obeys the monitor. Object, size, place,
gap, way, noise and phase of the tilt are drawn. Then ghosts: a person's hand goes away
behind the arm; once its place is in view again the map may show it for two tilts.
Limits: no object touched, every trial started and decided, no ghost left.)"};

struct HoverOptions {
  HoverTrial::Config trial;
  double ghost_noise_m = 0.01;
  std::size_t trials = 300;
  std::size_t ghosts = 30;
  std::optional<double> hold_s;  ///< nothing: as configured
};

void declare(CLI::App& command, HoverOptions& options) {
  HoverTrial::Config& trial = options.trial;
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
  addBraking(command, trial.controller, "the hand");
}

Json settingsOf(const HoverOptions& options) {
  return {{"hold_s", options.trial.monitor.sensors.front().mapper.hold.longest_s},
          {"hover_s", options.trial.hover_s},
          {"speed_mps", options.trial.down_mps},
          {"gap_m", {options.trial.ranges.gap_min_m, options.trial.ranges.gap_max_m}},
          {"noise_m", {options.trial.ranges.noise_min_m, options.trial.ranges.noise_max_m}},
          {"latency_s", options.trial.controller.latency_s},
          {"deceleration_mps2", options.trial.controller.acceleration_mps2}};
}

constexpr char kColumns[] =
    "kind,seed,object,approach,gap_m,noise_m,outcome,reason,left_m,stop_left_m,held_max,"
    "held_mean,left_cuboids,left_held,gone_after_s";

std::string rowOf(const HoverTrial::Result& r) {
  return csvRow("hover", r.seed, r.object, r.approach, fixed(r.gap_m, 4), fixed(r.noise_m, 4),
                name(r.outcome), r.reason, fixed(r.left_m, 4), fixed(r.stop_left_m, 4), r.held_max,
                fixed(r.held_mean, 1), "", "", "");
}

std::string rowOf(const GhostTrial::Result& r, double noise_m) {
  return csvRow("ghost", r.seed, "hand", "", "", fixed(noise_m, 4), r.left == 0 ? "gone" : "left",
                "", "", "", r.held_max, "", r.left, r.left_held, fixed(r.gone_after_s, 3));
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
    for (const HoverTrial::Result& result : results_) outcomes_.add(result.outcome);
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
    outcomes_.addTo(json);
    json["left_m"] = spread(left_m);
    json["left_when_permission_went_m"] = spread(stop_left_m);
    json["held_intervals_max"] = spread(held_max);
    json["held_intervals_mean"] = spread(held_mean);
    json["stopped_by"] = reasons;
    return json;
  }
  void addTo(Findings& findings) const {
    for (const HoverTrial::Result& result : results_) {
      findings.add(rowOf(result), result.simulated_s);
    }
    findings.figures["hover"] = figures();
    findings.lines.push_back(
        formatted("hovering       %zu trials: %zu stopped before the object, %zu touched it, %zu "
                  "not started, "
                  "%zu undecided",
                  results_.size(), outcomes_.of(Outcome::kStopped), outcomes_.of(Outcome::kTouched),
                  outcomes_.of(Outcome::kNotStarted), outcomes_.of(Outcome::kUndecided)));
    if (outcomes_.of(Outcome::kTouched) > 0) findings.missed.emplace_back("contacts");
    outcomes_.addMissed(findings.missed);
  }

 private:
  std::vector<HoverTrial::Result> results_;
  OutcomeCounts outcomes_;
};

void add(const std::vector<GhostTrial::Result>& results, double noise_m, Findings& findings) {
  std::size_t left = 0;
  std::size_t held = 0;
  std::vector<double> gone_after_s;
  for (const GhostTrial::Result& result : results) {
    findings.add(rowOf(result, noise_m), result.simulated_s);
    if (result.left > 0) ++left;
    if (result.held_max > 0) ++held;
    if (result.gone_after_s) gone_after_s.push_back(*result.gone_after_s);
  }
  findings.figures["ghosts"] = {{"trials", results.size()},
                                {"held_behind_the_arm", held},
                                {"left_after_two_tilts", left},
                                {"gone_after_s", spread(gone_after_s)}};
  findings.lines.push_back(formatted(
      "ghosts         %zu trials: %zu held behind the arm, %zu left two tilts after their "
      "place was in view again",
      results.size(), held, left));
  if (left > 0) findings.missed.emplace_back("ghosts");
}

Findings runHovers(HoverOptions options, const TrialRun& run) {
  MonitorConfig settings = run.settings;
  if (options.hold_s) settings.mapper.mapper.hold.longest_s = *options.hold_s;
  run.requireLaserAlone();
  options.trial.monitor = settings.monitor();
  options.trial.validate();
  GhostTrial::Config ghost;
  ghost.monitor = options.trial.monitor;
  ghost.noise_m = options.ghost_noise_m;
  ghost.validate();
  std::vector<HoverTrial::Result> hovers(options.trials);
  std::vector<GhostTrial::Result> ghosts(options.ghosts);
  const auto runCase = [&](std::size_t i) {
    if (i < hovers.size()) {
      hovers[i] = HoverTrial(options.trial, run.model, run.seedOf(i)).run();
    } else {
      const std::size_t k = i - hovers.size();
      ghosts[k] = GhostTrial(ghost, run.model, run.seedOf(k)).run();
    }
  };
  run.forEach(hovers.size() + ghosts.size(), runCase, [&](std::size_t i, Archive& archive) {
    if (i < hovers.size()) {
      archive(hovers[i]);
    } else {
      archive(ghosts[i - hovers.size()]);
    }
  });
  Findings findings(settingsOf(options), kColumns);
  Hovers(std::move(hovers)).addTo(findings);
  add(ghosts, ghost.noise_m, findings);
  return findings;
}

}  // namespace

Experiment hoverExperiment(CLI::App& app) { return experiment(app, kAbout, declare, runHovers); }

}  // namespace tccm::simulation
