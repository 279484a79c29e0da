#include <algorithm>
#include <array>
#include <map>
#include <optional>

#include "experiments/csv.h"
#include "experiments/experiment.h"
#include "experiments/markdown_table.h"
#include "experiments/nodelet_guardian.h"
#include "experiments/options.h"
#include "experiments/result_members.h"
#include "experiments/statistics.h"
#include "experiments/stopping_trial.h"

namespace tccm::simulation {
namespace {

constexpr About kAbout = {
    "stopping", "an arm that stops before what appears in its way",
    R"(The paper's experiment: the arm stretches over a table, something appears before its hand,
and the arm brakes when its permission goes. Speeds and obstacles take turns; the tilt's
phase, the gap, the place aside and the turn are drawn. A contact is avoidable where an arm
that brakes once the evidence is judged comes to rest before it: evidence is the first beam
that shows what is in the way, or the first scan that gives it its support, three accepted
returns within 3 x 3 cells and 30 mm of height. In the way is what the padded arm meets
before the contact.
Limits: no contact that support would have avoided, at most --avoidable-max that the first
beam would have, none of these at 100 mm/s; and no contact at all where the obstacle is
brought in.)"};

struct StoppingOptions {
  StoppingTrial::Config trial;
  std::size_t trials = 90;
  std::vector<double> speeds_mps = {0.1, 0.25, 0.4};
  std::vector<std::string> obstacles = {"pole", "arm", "box"};
  double avoidable_max = 0.01;
  double appear_distance_m = 0.0;
  bool through_nodelets = false;
};

void declare(CLI::App& command, StoppingOptions& options) {
  StoppingTrial::Config& trial = options.trial;
  command.add_option("--trials", options.trials)->check(CLI::Range(1, 1000000));
  addList(command, "--speeds", options.speeds_mps, CLI::Range(0.01, 2.0), "of the hand [m/s]");
  addList(command, "--obstacles", options.obstacles, CLI::IsMember({"pole", "arm", "box"}));
  command.add_option("--obstacle-speed", trial.obstacle_speed_mps,
                     "brought in from aside at [m/s]; 0: it appears at once");
  command.add_option("--gap-min-m", trial.gap_min_m, "between hand and obstacle");
  command.add_option("--gap-max-m", trial.gap_max_m);
  command.add_option("--aside-m", trial.aside_max_m, "at most, of the middle of the way");
  command.add_option("--turn-rad", trial.turn_max_rad, "at most");
  addNoise(command, trial.scanner.noise_m);
  command.add_option("--tilt-period-s", trial.tilt_period_s);
  command.add_option("--body-error-m", trial.body_error_m, "by which the robot's parts are aside");
  addBraking(command, trial.controller, "the hand");
  command.add_flag("--obey-scale", trial.obeys_scale, "the arm scales its speed as it is told")
      ->always_capture_default(false);
  command.add_flag("--ros", options.through_nodelets,
                   "the arm obeys the nodelets of a running ROS system, at the pace of the wall "
                   "clock; see trials.launch. No two runs are the same");
  command
      .add_option(
          "--appear-distance-m", options.appear_distance_m,
          "above 0: the speed is governed, the arm obeys the scale, collision_padding_m is at "
          "least 0.04, and what appears may do so at any speed; then no contact at all may be")
      ->check(CLI::Range(0.0, 0.25));
  addShare(command, "--avoidable-max", options.avoidable_max,
           "share of the trials at a speed above 100 mm/s");
}

Json settingsOf(const StoppingOptions& options) {
  return {
      {"speeds_mps", options.speeds_mps},
      {"obstacles", options.obstacles},
      {"obstacle_speed_mps", options.trial.obstacle_speed_mps},
      {"gap_m", {options.trial.gap_min_m, options.trial.gap_max_m}},
      {"noise_m", options.trial.scanner.noise_m},
      {"tilt_period_s", options.trial.tilt_period_s},
      {"body_error_m", options.trial.body_error_m},
      {"latency_s", options.trial.controller.latency_s},
      {"deceleration_mps2", options.trial.controller.acceleration_mps2},
      {"obeys_scale", options.trial.obeys_scale},
      {"appear_distance_m", options.appear_distance_m},
      {"collision_padding_m", options.trial.monitor.checker.pose.collision_use.expansion.padding_m},
      {"through_nodelets", options.through_nodelets}};
}

/// A trial with what it was about.
struct Case {
  double speed_mps = 0.0;
  std::string obstacle;
  StoppingTrial::Result result;
};

constexpr char kColumns[] =
    "seed,speed_mps,obstacle,gap_m,aside_m,turn_rad,tilt_phase,outcome,reason,left_m,beam_s,"
    "way_beam_s,support_s,due_s,stop_s,contact_s,delay_scans,avoidable_from_beam,avoidable_from_"
    "support,cause";

std::string rowOf(const Case& one) {
  const StoppingTrial::Result& r = one.result;
  return csvRow(r.seed, fixed(one.speed_mps, 3), one.obstacle, fixed(r.gap_m, 4),
                fixed(r.aside_m, 4), fixed(r.turn_rad, 4), fixed(r.tilt_phase, 4), name(r.outcome),
                r.reason, fixed(r.left_m, 4), fixed(r.beam_s, 4), fixed(r.way_beam_s, 4),
                fixed(r.support_s, 4), fixed(r.due_s, 4), fixed(r.stop_s, 4), fixed(r.contact_s, 4),
                r.delay_scans ? std::to_string(*r.delay_scans) : "", r.avoidable_from_beam,
                r.avoidable_from_support, r.cause ? name(*r.cause) : "");
}

/// Null where there are none.
Json quantiles(std::vector<double> values) {
  if (values.empty()) return nullptr;
  std::sort(values.begin(), values.end());
  return {{"least", values.front()},
          {"p50", quantile(values, 0.5)},
          {"p99", quantile(values, 0.99)},
          {"most", values.back()}};
}

/// What became of the trials of one kind.
class Tally {
 public:
  void add(const StoppingTrial::Result& result) {
    ++trials_;
    outcomes_.add(result.outcome);
    if (result.avoidable_from_beam) ++avoidable_from_beam_;
    if (result.avoidable_from_support) ++avoidable_from_support_;
    if (result.delay_scans) delays_.push_back(static_cast<double>(*result.delay_scans));
    if (result.stop_s && result.support_s) {
      waits_ms_.push_back(
          1e3 * std::max(0.0, *result.stop_s - std::max(*result.support_s,
                                                        result.due_s.value_or(*result.stop_s))));
    }
    if (result.outcome == Outcome::kStopped) left_mm_.push_back(1e3 * *result.left_m);
  }

  [[nodiscard]] const OutcomeCounts& outcomes() const { return outcomes_; }
  [[nodiscard]] std::size_t avoidableFromSupport() const { return avoidable_from_support_; }
  [[nodiscard]] double shareAvoidableFromBeam() const {
    return share(avoidable_from_beam_, trials_);
  }
  [[nodiscard]] Json toJson() const {
    Json json = {{"trials", trials_}};
    outcomes_.addTo(json);
    json["avoidable_from_first_beam"] = avoidable_from_beam_;
    json["avoidable_from_support"] = avoidable_from_support_;
    json["delay_scans"] = quantiles(delays_);
    json["delay_ms"] = quantiles(waits_ms_);
    json["left_mm"] = quantiles(left_mm_);
    return json;
  }
  [[nodiscard]] std::string line(const std::string& what) const {
    return formatted(
        "%-14s %5zu trials: %zu stopped, %zu touched (%zu avoidable from the first beam, %zu from "
        "its support), %zu not started, %zu undecided",
        what.c_str(), trials_, outcomes_.of(Outcome::kStopped), outcomes_.of(Outcome::kTouched),
        avoidable_from_beam_, avoidable_from_support_, outcomes_.of(Outcome::kNotStarted),
        outcomes_.of(Outcome::kUndecided));
  }

 private:
  std::size_t trials_ = 0, avoidable_from_beam_ = 0, avoidable_from_support_ = 0;
  OutcomeCounts outcomes_;
  std::vector<double> delays_, waits_ms_, left_mm_;
};

std::string speedName(double speed_mps) { return fixed(1e3 * speed_mps, 0) + " mm/s"; }

/// Contacts by what caused them, over speed and phase of the tilt when the obstacle appeared.
class CausesByPhase {
 public:
  static constexpr std::size_t kPhases = 8;

  void add(double speed_mps, const StoppingTrial::Result& result) {
    if (!result.cause) return;
    ++counts_[{speed_mps, *result.cause}][phaseOf(result.tilt_phase)];
  }
  [[nodiscard]] Json toJson() const {
    Json rows = Json::array();
    for (const auto& [key, counts] : counts_) {
      rows.push_back({{"speed_mps", key.first}, {"cause", name(key.second)}, {"by_phase", counts}});
    }
    return rows;
  }
  /// Empty where nothing touched.
  [[nodiscard]] std::vector<std::string> table() const {
    if (counts_.empty()) return {};
    MarkdownTable table;
    table.addColumn("contacts at");
    table.addColumn("because", MarkdownTable::Column::kText);
    table.addColumn("by phase of the tilt, from 0");
    for (std::size_t i = 1; i < kPhases; ++i) table.addColumn(fixed(share(i, kPhases), 3));
    for (const auto& [key, counts] : counts_) {
      std::vector<std::string> cells = {speedName(key.first), name(key.second)};
      for (const std::size_t count : counts) cells.push_back(std::to_string(count));
      table.addRow(cells);
    }
    return table.lines();
  }

 private:
  static std::size_t phaseOf(double phase) {
    return std::min(kPhases - 1, static_cast<std::size_t>(phase * kPhases));
  }

  std::map<std::pair<double, StoppingTrial::Cause>, std::array<std::size_t, kPhases>> counts_;
};

Findings findingsOf(const std::vector<Case>& cases, const StoppingOptions& options) {
  constexpr double kSlow = 0.1001;  // [m/s]
  Findings findings(settingsOf(options), kColumns);
  Tally all;
  std::vector<double> processing_us;
  std::map<double, Tally> by_speed;
  std::map<std::string, Tally> by_obstacle;
  CausesByPhase causes;
  for (const Case& one : cases) {
    causes.add(one.speed_mps, one.result);
    findings.add(rowOf(one), one.result.simulated_s);
    all.add(one.result);
    processing_us.insert(processing_us.end(), one.result.processing_us.begin(),
                         one.result.processing_us.end());
    by_speed[one.speed_mps].add(one.result);
    by_obstacle[one.obstacle].add(one.result);
  }
  bool beam_missed = false;
  for (const auto& [speed, tally] : by_speed) {
    findings.figures["by_speed"][speedName(speed)] = tally.toJson();
    findings.lines.push_back(tally.line(speedName(speed)));
    const double most = speed < kSlow ? 0.0 : options.avoidable_max;
    beam_missed = beam_missed || tally.shareAvoidableFromBeam() > most;
  }
  for (const auto& [obstacle, tally] : by_obstacle) {
    findings.figures["by_obstacle"][obstacle] = tally.toJson();
    findings.lines.push_back(tally.line(obstacle));
  }
  findings.timing["processing_us"] = quantiles(std::move(processing_us));
  findings.figures["all"] = all.toJson();
  findings.figures["contacts"] = causes.toJson();
  findings.lines.push_back(all.line("all"));
  findings.addLines(causes.table());
  if (all.avoidableFromSupport() > 0) findings.missed.emplace_back("avoidable_from_support");
  if (beam_missed) findings.missed.emplace_back("avoidable_from_first_beam");
  const bool none_may_touch =
      options.trial.obstacle_speed_mps > 0.0 || options.appear_distance_m > 0.0;
  if (none_may_touch && all.outcomes().of(Outcome::kTouched) > 0) {
    findings.missed.emplace_back("contacts");
  }
  all.outcomes().addMissed(findings.missed);
  return findings;
}

/// The hand's links alone: places ahead of elbows are mostly out of the tilt's range. A face that
/// the laser grazes gives single returns, which are taken for mixed pixels: the padding is what
/// README says that goes with a governed speed.
void govern(MonitorConfig& settings, StoppingOptions& options) {
  constexpr double kPadding = 0.04;  // [m]
  constexpr double kMoving = 0.02;   // of the speed commanded
  settings.checker.checker.governed_speed.appear_distance_m = options.appear_distance_m;
  settings.checker.checker.evidence.links = {"right_wrist_pitch_link", "right_wrist_roll_link",
                                             "right_palm_link", "right_*_finger_link"};
  double& padding_m = settings.checker.checker.pose.collision_use.expansion.padding_m;
  padding_m = std::max(padding_m, kPadding);
  options.trial.obeys_scale = true;
  options.trial.appear_speed_share = kMoving;
}

Findings runStopping(StoppingOptions options, const TrialRun& run) {
  if (options.through_nodelets && options.appear_distance_m > 0.0) {
    throw InputError(
        "--ros: whether the speed is governed is up to the nodelets' appear_distance_m; "
        "--appear-distance-m goes without it");
  }
  MonitorConfig settings = run.settings;
  if (options.appear_distance_m > 0.0) govern(settings, options);
  if (options.through_nodelets) run.requireLaserAlone();
  if (options.through_nodelets) run.requireWhole();
  run.prepare(options.trial, settings);
  std::vector<Case> cases(options.trials);
  std::optional<NodeletGuardian> nodelets;
  if (options.through_nodelets) nodelets.emplace(options.trial.start);
  const auto runCase = [&](std::size_t i) {
    Case& one = cases[i];
    one.speed_mps = options.speeds_mps[i % options.speeds_mps.size()];
    one.obstacle = options.obstacles[i / options.speeds_mps.size() % options.obstacles.size()];
    StoppingTrial::Config config = options.trial;
    config.controller.speed_mps = one.speed_mps;
    config.controller.resume_mps2 = config.controller.acceleration_mps2;
    config.obstacle = obstacleKind(one.obstacle);
    if (nodelets) {
      config.guardian = &*nodelets;
      config.start = nodelets->nextStart();
    }
    one.result = StoppingTrial(config, run.model, run.seedOf(i)).run();
  };
  if (nodelets) {  // they hear one robot
    inParallel(cases.size(), 1, runCase, run.progress);
  } else {
    run.forEach(cases.size(), runCase, [&](std::size_t i, Archive& archive) {
      archive(cases[i].speed_mps, cases[i].obstacle, cases[i].result);
    });
  }
  return findingsOf(cases, options);
}

}  // namespace

Experiment stoppingExperiment(CLI::App& app) {
  return experiment(app, kAbout, declare, runStopping);
}

}  // namespace tccm::simulation
