#include "experiments/hover_trial.h"

#include <algorithm>
#include <utility>

#include "tccm_monitor/config_error.h"

namespace tccm::simulation {
namespace {

constexpr double kSpacing = 0.01;        // [m] between the points that clearances are measured from
constexpr double kUntilPermitted = 5.0;  // [s] until the map is whole and the speed scale up
constexpr double kLongest = 30.0;        // [s] on the way down
constexpr int kRest = 50;                // robot samples, half a second
enum Stage : std::size_t { kWait, kTurn, kHover, kDown };

}  // namespace

void HoverTrial::Config::validate() const {
  ranges.validate();
  controller.validate();
  requireInRange("hover_s", hover_s, 0.0, 1000.0);
  requireInRange("down_mps", down_mps, 0.01, 2.0);
  requireInRange("approach_mps", approach_mps, 0.01, 2.0);
  requireInRange("approach_from_above_mps", approach_from_above_mps, 0.01, 2.0);
}

HoverTrial::HoverTrial(const Config& config, std::shared_ptr<const RobotModel> model,
                       std::uint64_t seed)
    : config_((config.validate(), config)),
      seed_(seed),
      scene_(hoverScene(model, config_.ranges, seed)),
      simulation_(simulatorConfig(), config_.monitor, model),
      arm_(std::move(model), hoveringLinks(), kSpacing),
      things_(bodyOf(scene_.things), kSpacing),
      start_(simulation_.simulator().now()) {
  result_.seed = seed;
  result_.object = scene_.object;
  result_.approach = scene_.approach;
  result_.gap_m = scene_.gap_m;
  result_.noise_m = scene_.noise_m;
  simulation_.obey();
  simulation_.onScan([this](const SimulatedScan&) { countHeld(); });
  simulation_.onVerdict([this](const Verdict& verdict) { noteVerdict(verdict); });
}

Simulator::Config HoverTrial::simulatorConfig() const {
  Simulator::Config config;
  config.scene = "empty";
  config.objects = bareTable();
  config.objects.insert(config.objects.end(), scene_.things.begin(), scene_.things.end());
  config.path = scene_.path;
  config.controller = config_.controller;
  const double last_mps =
      scene_.approach == "above" ? config_.approach_from_above_mps : config_.approach_mps;
  config.controller.stages = {{0.0, config_.approach_mps, kUntilPermitted},
                              {scene_.via_m, config_.approach_mps, 0.1},
                              {scene_.hover_m, last_mps, config_.hover_s},
                              {scene_.path.length(), config_.down_mps, 0.0}};
  config.scanner.noise_m = scene_.noise_m;
  config.head.tilt.phase_rad = scene_.tilt_phase_rad;
  config.seed = seed_;
  return config;
}

HoverTrial::Result HoverTrial::run() {
  std::optional<Outcome> outcome;
  while (!outcome) {
    if (simulation_.step()) outcome = outcomeSoFar();
  }
  result_.outcome = *outcome;
  result_.left_m = *outcome == Outcome::kTouched ? 0.0 : clearanceNow();
  result_.held_mean =
      static_cast<double>(held_sum_) / static_cast<double>(std::max<std::size_t>(scans_, 1));
  result_.simulated_s = toSeconds(simulation_.simulator().now() - start_);
  return result_;
}

bool HoverTrial::goesDown() const {
  return simulation_.simulator().controller().stagesDone() >= kDown;
}

void HoverTrial::countHeld() {
  const auto& cuboids = simulation_.monitor().map()->cuboids;
  const auto held = static_cast<std::size_t>(
      std::count_if(cuboids.begin(), cuboids.end(), [](const Cuboid& c) { return c.held; }));
  result_.held_max = std::max(result_.held_max, held);
  held_sum_ += held;
  ++scans_;
}

void HoverTrial::noteVerdict(const Verdict& verdict) {
  if (permitted_ && verdict.stop && goesDown()) result_.stop_left_m = clearanceNow();
  // Once it stops on its way down: why it did.
  if (permitted_ || !goesDown()) result_.reason = name(verdict.reason);
  permitted_ = !verdict.stop;
}

double HoverTrial::clearanceNow() {
  arm_.moveTo(simulation_.robot()->link_poses);
  return clearance(arm_.body(), things_);
}

std::optional<Outcome> HoverTrial::outcomeSoFar() {
  const Time now = simulation_.simulator().now();
  if (!goesDown()) {
    const bool late = now - start_ > fromSeconds(kLongest + config_.hover_s);
    return late ? std::optional(Outcome::kNotStarted) : std::nullopt;
  }
  if (!down_since_) {
    if (!permitted_) return Outcome::kNotStarted;
    down_since_ = now;
  }
  if (clearanceNow() == 0.0) return Outcome::kTouched;
  const bool rests = !permitted_ && simulation_.simulator().controller().speed() == 0.0;
  at_rest_ = rests ? at_rest_ + 1 : 0;
  if (at_rest_ == kRest) return Outcome::kStopped;
  if (now - *down_since_ > fromSeconds(kLongest)) return Outcome::kUndecided;
  return std::nullopt;
}

}  // namespace tccm::simulation
