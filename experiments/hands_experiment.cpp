#include <array>
#include <vector>

#include "experiments/csv.h"
#include "experiments/experiment.h"
#include "experiments/markdown_table.h"
#include "experiments/options.h"
#include "experiments/result_members.h"
#include "experiments/stopping_trial.h"

namespace tccm::simulation {
namespace {

constexpr About kAbout = {
    "hands", "a person's hand reaches for the robot's from side and behind",
    R"(A person's hand reaches for the robot's while that moves over a table, from 0.4 m away, from
the side or from behind. Who reaches for a robot touches it in the end: what counts is
whether the permission went before, and whether the arm stood by then. Where the hand touches the arm as it appears, or the
arm does not start, the trial does not count. No limits.)"};

constexpr double kRest = 0.005;  // [m/s]; a palm that is slower stands

/// Where a hand comes from: counterclockwise from the heading of the robot's [rad].
struct Side {
  const char* name;
  std::array<double, 2> from_rad;
};

/// The right, where a person stands before the robot, and behind.
constexpr std::array<Side, 2> kSides = {{{"side", {-1.97, -1.17}}, {"behind", {-3.0, -2.2}}}};

struct HandsOptions {
  StoppingTrial::Config trial;
  std::size_t trials = 60;
  std::vector<double> hand_speeds_mps = {0.5, 1.0, 1.6};
  std::vector<double> tilt_periods_s = {1.575, 3.15};
  std::vector<double> speeds_mps = {0.1, 0.25, 0.4};
};

void declare(CLI::App& command, HandsOptions& options) {
  command.add_option("--trials", options.trials, "for each side, speed of the hand and period")
      ->check(CLI::Range(1, 100000));
  addList(command, "--hand-speeds", options.hand_speeds_mps, CLI::Range(0.1, 10.0),
          "of the person's hand [m/s]");
  addList(command, "--tilt-periods", options.tilt_periods_s, CLI::Range(0.2, 20.0), "[s]");
  addList(command, "--speeds", options.speeds_mps, CLI::Range(0.01, 2.0),
          "of the robot's hand, in turn [m/s]");
  addNoise(command, options.trial.scanner.noise_m);
  addBraking(command, options.trial.controller, "the robot's hand");
}

Json settingsOf(const HandsOptions& options) {
  return {{"trials", options.trials},
          {"hand_speeds_mps", options.hand_speeds_mps},
          {"tilt_periods_s", options.tilt_periods_s},
          {"speeds_mps", options.speeds_mps},
          {"noise_m", options.trial.scanner.noise_m},
          {"latency_s", options.trial.controller.latency_s},
          {"deceleration_mps2", options.trial.controller.acceleration_mps2}};
}

/// A trial with what it was about.
struct Case {
  const Side* side;
  double hand_mps;
  double tilt_period_s;
  double speed_mps;
  StoppingTrial::Result result;

  /// The hand came, and did not touch the arm from the first on.
  [[nodiscard]] bool begun() const {
    constexpr double kAtOnce = 0.01;  // [s]
    return result.outcome != Outcome::kNotStarted &&
           (!result.contact_s || *result.contact_s > kAtOnce);
  }
  [[nodiscard]] bool touched() const { return result.outcome == Outcome::kTouched; }
  [[nodiscard]] bool seen() const {
    return result.beam_s && (!result.contact_s || *result.beam_s < *result.contact_s);
  }
  /// Two frames of a camera before the contact.
  [[nodiscard]] bool seenEarly() const {
    constexpr double kFrames = 2.0 / 30.0;  // [s]
    return seen() && (!result.contact_s || *result.beam_s + kFrames <= *result.contact_s);
  }
  /// Before the contact; without one, at all.
  [[nodiscard]] bool stopped() const {
    return result.stop_s && (!result.contact_s || *result.stop_s < *result.contact_s);
  }
  [[nodiscard]] bool touchedInMotion() const {
    return touched() && result.contact_speed_mps > kRest;
  }
};

std::vector<Case> casesOf(const HandsOptions& options) {
  std::vector<Case> cases;
  for (const double period : options.tilt_periods_s) {
    for (const Side& side : kSides) {
      for (const double hand : options.hand_speeds_mps) {
        for (std::size_t i = 0; i < options.trials; ++i) {
          cases.push_back(
              {&side, hand, period, options.speeds_mps[i % options.speeds_mps.size()], {}});
        }
      }
    }
  }
  return cases;
}

constexpr char kColumns[] =
    "seed,from,from_rad,hand_mps,tilt_period_s,speed_mps,tilt_phase,outcome,reason,beam_s,stop_s,"
    "contact_s,contact_speed_mps";

std::string rowOf(const Case& one) {
  const StoppingTrial::Result& r = one.result;
  return csvRow(r.seed, one.side->name, fixed(*r.reaches_from_rad, 4), fixed(one.hand_mps, 3),
                fixed(one.tilt_period_s, 4), fixed(one.speed_mps, 3), fixed(r.tilt_phase, 4),
                name(r.outcome), r.reason, fixed(r.beam_s, 4), fixed(r.stop_s, 4),
                fixed(r.contact_s, 4), fixed(r.contact_speed_mps, 4));
}

/// Of cases that share a period, a side and a speed of the person's hand.
struct Tally {
  std::size_t not_begun = 0;  ///< these do not count
  std::size_t trials = 0, seen = 0, seen_early = 0, early_unstopped = 0, stopped = 0, touched = 0,
              touched_in_motion = 0;
  double fastest_contact_mps = 0.0;

  void add(const Case& one) {
    if (!one.begun()) {
      ++not_begun;
      return;
    }
    ++trials;
    seen += one.seen() ? 1 : 0;
    seen_early += one.seenEarly() ? 1 : 0;
    early_unstopped += one.seenEarly() && !one.stopped() ? 1 : 0;
    stopped += one.stopped() ? 1 : 0;
    touched += one.touched() ? 1 : 0;
    touched_in_motion += one.touchedInMotion() ? 1 : 0;
    if (one.touched()) {
      fastest_contact_mps = std::max(fastest_contact_mps, one.result.contact_speed_mps);
    }
  }
};

Findings findingsOf(const std::vector<Case>& cases, const HandsOptions& options) {
  Findings findings(settingsOf(options), kColumns);
  MarkdownTable table;
  table.addColumn("tilt");
  table.addColumn("from", MarkdownTable::Column::kText);
  for (const char* column :
       {"hand", "trials", "seen before", "stopped before", "touched", "in motion", "at most"}) {
    table.addColumn(column);
  }
  for (std::size_t first = 0; first < cases.size(); first += options.trials) {
    Tally tally;
    for (std::size_t i = first; i < first + options.trials; ++i) {
      tally.add(cases[i]);
      findings.add(rowOf(cases[i]), cases[i].result.simulated_s);
    }
    const Case& one = cases[first];
    findings.figures["hands"].push_back({{"tilt_period_s", one.tilt_period_s},
                                         {"from", one.side->name},
                                         {"hand_mps", one.hand_mps},
                                         {"trials", tally.trials},
                                         {"not_begun", tally.not_begun},
                                         {"seen_before_contact", tally.seen},
                                         {"seen_two_frames_before", tally.seen_early},
                                         {"of_these_not_stopped", tally.early_unstopped},
                                         {"stopped_before_contact", tally.stopped},
                                         {"touched", tally.touched},
                                         {"touched_in_motion", tally.touched_in_motion},
                                         {"fastest_contact_mps", tally.fastest_contact_mps}});
    table.addRow({fixed(one.tilt_period_s, 3) + " s", one.side->name,
                  fixed(one.hand_mps, 1) + " m/s", std::to_string(tally.trials),
                  std::to_string(tally.seen), std::to_string(tally.stopped),
                  std::to_string(tally.touched), std::to_string(tally.touched_in_motion),
                  fixed(1e3 * tally.fastest_contact_mps, 0) + " mm/s"});
  }
  findings.addLines(table.lines());
  return findings;
}

Findings runHands(HandsOptions options, const TrialRun& run) {
  options.trial.obstacle = ObstacleKind::kArm;
  run.prepare(options.trial);
  std::vector<Case> cases = casesOf(options);
  const auto runCase = [&](std::size_t i) {
    Case& one = cases[i];
    StoppingTrial::Config config = options.trial;
    config.obstacle_speed_mps = one.hand_mps;
    config.tilt_period_s = one.tilt_period_s;
    config.reaches_from_rad = one.side->from_rad;
    config.controller.speed_mps = one.speed_mps;
    config.controller.resume_mps2 = config.controller.acceleration_mps2;
    one.result = StoppingTrial(config, run.model, run.seedOf(i)).run();
  };
  run.forEach(cases.size(), runCase,
              [&](std::size_t i, Archive& archive) { archive(cases[i].result); });
  return findingsOf(cases, options);
}

}  // namespace

Experiment handsExperiment(CLI::App& app) { return experiment(app, kAbout, declare, runHands); }

}  // namespace tccm::simulation
