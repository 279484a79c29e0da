#include <algorithm>
#include <array>
#include <map>
#include <memory>
#include <optional>

#include "experiments/csv.h"
#include "experiments/experiment.h"
#include "experiments/nodelet_guardian.h"
#include "experiments/parallel.h"
#include "experiments/stopping_trial.h"
#include "simulation/robot/dual_arm.h"

namespace tccm::simulation {
namespace {

using Json = nlohmann::ordered_json;
using Outcome = StoppingTrial::Outcome;

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
  command.footer(
      "The paper's experiment: the arm stretches over a table, something appears before its hand,\n"
      "and the arm brakes when its permission goes. Speeds and obstacles take turns; the tilt's\n"
      "phase, the gap, the place aside and the turn are drawn. A contact is avoidable where an "
      "arm\n"
      "that brakes once the evidence is judged comes to rest before it: evidence is the first "
      "beam\n"
      "that shows what is in the way, or the first scan that gives it its support, three accepted\n"
      "returns within 3 x 3 cells and 30 mm of height. In the way is what the padded arm meets\n"
      "before the contact.\n"
      "Limits: no contact that support would have avoided, at most --avoidable-max that the first\n"
      "beam would have, none of these at 100 mm/s; and no contact at all where the obstacle is\n"
      "brought in.");
  command.option_defaults()->always_capture_default();
  command.add_option("--trials", options.trials)->check(CLI::Range(1, 1000000));
  command.add_option("--speeds", options.speeds_mps, "of the hand [m/s]")
      ->delimiter(',')
      ->check(CLI::Range(0.01, 2.0));
  command.add_option("--obstacles", options.obstacles)
      ->delimiter(',')
      ->check(CLI::IsMember({"pole", "arm", "box"}));
  command.add_option("--obstacle-speed", trial.obstacle_speed_mps,
                     "brought in from aside at [m/s]; 0: it appears at once");
  command.add_option("--gap-min-m", trial.gap_min_m, "between hand and obstacle");
  command.add_option("--gap-max-m", trial.gap_max_m);
  command.add_option("--aside-m", trial.aside_max_m, "at most, of the middle of the way");
  command.add_option("--turn-rad", trial.turn_max_rad, "at most");
  command.add_option("--noise-m", trial.scanner.noise_m, "standard deviation of a range");
  command.add_option("--tilt-period-s", trial.tilt_period_s);
  command.add_option("--body-error-m", trial.body_error_m, "by which the robot's parts are aside");
  command.add_option("--latency-s", trial.controller.latency_s, "from the stop to the brake");
  command.add_option("--deceleration", trial.controller.acceleration_mps2, "of the hand [m/s^2]");
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
  command
      .add_option("--avoidable-max", options.avoidable_max,
                  "share of the trials at a speed above 100 mm/s")
      ->check(CLI::Range(0.0, 1.0));
}

/// A trial with what it was about.
struct Case {
  double speed_mps = 0.0;
  std::string obstacle;
  StoppingTrial::Result result;
};

std::string orNothing(const std::optional<double>& number) {
  return number ? fixed(*number, 4) : "";
}

std::string rowOf(const Case& one) {
  const StoppingTrial::Result& r = one.result;
  return std::to_string(r.seed) + ',' + fixed(one.speed_mps, 3) + ',' + one.obstacle + ',' +
         fixed(r.gap_m, 4) + ',' + fixed(r.aside_m, 4) + ',' + fixed(r.turn_rad, 4) + ',' +
         fixed(r.tilt_phase, 4) + ',' + name(r.outcome) + ',' + r.reason + ',' +
         orNothing(r.left_m) + ',' + orNothing(r.beam_s) + ',' + orNothing(r.way_beam_s) + ',' +
         orNothing(r.support_s) + ',' + orNothing(r.due_s) + ',' + orNothing(r.stop_s) + ',' +
         orNothing(r.contact_s) + ',' + (r.delay_scans ? std::to_string(*r.delay_scans) : "") +
         ',' + (r.avoidable_from_beam ? "1," : "0,") + (r.avoidable_from_support ? "1," : "0,") +
         (r.cause ? name(*r.cause) : "") + '\n';
}

/// Null where there are none.
Json quantiles(std::vector<double> values) {
  if (values.empty()) return nullptr;
  std::sort(values.begin(), values.end());
  const auto at = [&values](double share) {
    return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
  };
  return {{"least", at(0.0)}, {"p50", at(0.5)}, {"p99", at(0.99)}, {"most", at(1.0)}};
}

/// What became of the trials of one kind.
class Tally {
 public:
  void add(const StoppingTrial::Result& result) {
    ++trials_;
    ++outcomes_[result.outcome];
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

  [[nodiscard]] std::size_t of(Outcome outcome) const {
    const auto found = outcomes_.find(outcome);
    return found == outcomes_.end() ? 0 : found->second;
  }
  [[nodiscard]] std::size_t avoidableFromSupport() const { return avoidable_from_support_; }
  [[nodiscard]] double shareAvoidableFromBeam() const {
    return static_cast<double>(avoidable_from_beam_) /
           static_cast<double>(std::max<std::size_t>(trials_, 1));
  }
  [[nodiscard]] Json toJson() const {
    Json json = {{"trials", trials_}};
    for (const Outcome outcome :
         {Outcome::kStopped, Outcome::kTouched, Outcome::kNotStarted, Outcome::kUndecided}) {
      json[name(outcome)] = of(outcome);
    }
    json["avoidable_from_first_beam"] = avoidable_from_beam_;
    json["avoidable_from_support"] = avoidable_from_support_;
    json["delay_scans"] = quantiles(delays_);
    json["delay_ms"] = quantiles(waits_ms_);
    json["left_mm"] = quantiles(left_mm_);
    return json;
  }
  [[nodiscard]] std::string line(const std::string& what) const {
    char text[240];
    std::snprintf(text, sizeof text,
                  "%-14s %5zu trials: %zu stopped, %zu touched (%zu avoidable from the first beam, "
                  "%zu from its support), %zu not started, %zu undecided",
                  what.c_str(), trials_, of(Outcome::kStopped), of(Outcome::kTouched),
                  avoidable_from_beam_, avoidable_from_support_, of(Outcome::kNotStarted),
                  of(Outcome::kUndecided));
    return text;
  }

 private:
  std::size_t trials_ = 0, avoidable_from_beam_ = 0, avoidable_from_support_ = 0;
  std::map<Outcome, std::size_t> outcomes_;
  std::vector<double> delays_, waits_ms_, left_mm_;
};

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
  /// A table in Markdown; empty where nothing touched.
  [[nodiscard]] std::vector<std::string> table() const {
    if (counts_.empty()) return {};
    std::vector<std::string> lines = {"| contacts at | because | by phase of the tilt, from 0",
                                      "|---:|---|---:"};
    for (std::size_t i = 1; i < kPhases; ++i) {
      lines[0] += " | " + fixed(static_cast<double>(i) / kPhases, 3);
      lines[1] += "|---:";
    }
    lines[0] += " |";
    lines[1] += '|';
    for (const auto& [key, counts] : counts_) {
      std::string line = "| " + fixed(1e3 * key.first, 0) + " mm/s | " + name(key.second);
      for (const std::size_t count : counts) line += " | " + std::to_string(count);
      lines.push_back(line + " |");
    }
    return lines;
  }

 private:
  static std::size_t phaseOf(double phase) {
    return std::min(kPhases - 1, static_cast<std::size_t>(phase * kPhases));
  }

  std::map<std::pair<double, StoppingTrial::Cause>, std::array<std::size_t, kPhases>> counts_;
};

std::string speedName(double speed_mps) { return fixed(1e3 * speed_mps, 0) + " mm/s"; }

void add(const std::vector<Case>& cases, const StoppingOptions& options, Findings& findings) {
  constexpr double kSlow = 0.1001;  // [m/s]
  Tally all;
  std::vector<double> processing_us;
  std::map<double, Tally> by_speed;
  std::map<std::string, Tally> by_obstacle;
  CausesByPhase causes;
  for (const Case& one : cases) {
    causes.add(one.speed_mps, one.result);
    findings.rows += rowOf(one);
    findings.simulated_s += one.result.simulated_s;
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
  for (const std::string& line : causes.table()) findings.lines.push_back(line);
  if (all.avoidableFromSupport() > 0) findings.missed.emplace_back("avoidable_from_support");
  if (beam_missed) findings.missed.emplace_back("avoidable_from_first_beam");
  const bool none_may_touch =
      options.trial.obstacle_speed_mps > 0.0 || options.appear_distance_m > 0.0;
  if (none_may_touch && all.of(Outcome::kTouched) > 0) {
    findings.missed.emplace_back("contacts");
  }
  if (all.of(Outcome::kNotStarted) > 0) findings.missed.emplace_back("not_started");
  if (all.of(Outcome::kUndecided) > 0) findings.missed.emplace_back("undecided");
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

Findings runStopping(StoppingOptions options, const TrialOptions& common,
                     const Progress& progress) {
  if (options.through_nodelets && options.appear_distance_m > 0.0) {
    throw InputError(
        "--ros: whether the speed is governed is up to the nodelets' appear_distance_m; "
        "--appear-distance-m goes without it");
  }
  MonitorConfig settings = trialSettings(common);
  if (options.appear_distance_m > 0.0) govern(settings, options);
  options.trial.monitor = settings.monitor();
  options.trial.validate();
  const auto model = std::make_shared<const RobotModel>(dualArmUrdf(), settings.robot);
  std::vector<Case> cases(options.trials);
  std::optional<NodeletGuardian> nodelets;
  if (options.through_nodelets) nodelets.emplace(options.trial.start);
  const auto work = [&](std::size_t i) {
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
    one.result = StoppingTrial(config, model, seedOf(common, i)).run();
  };
  inParallel(cases.size(), nodelets ? 1 : common.jobs, work, progress);
  Findings findings;
  findings.settings = {
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
  findings.rows =
      "seed,speed_mps,obstacle,gap_m,aside_m,turn_rad,tilt_phase,outcome,reason,left_m,beam_s,"
      "way_beam_s,support_s,due_s,stop_s,contact_s,delay_scans,avoidable_from_beam,avoidable_from_"
      "support,cause\n";
  add(cases, options, findings);
  return findings;
}

}  // namespace

Experiment stoppingExperiment(CLI::App& app) {
  auto options = std::make_shared<StoppingOptions>();
  CLI::App* command =
      app.add_subcommand("stopping", "an arm that stops before what appears in its way");
  declare(*command, *options);
  return {command, [options](const TrialOptions& common, const Progress& progress) {
            return runStopping(*options, common, progress);
          }};
}

}  // namespace tccm::simulation
