#include "experiments/governed_trial.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "experiments/draw.h"
#include "experiments/reaching_about.h"
#include "simulation/robot/dual_arm.h"
#include "tccm_monitor/config_error.h"

namespace tccm::simulation {
namespace {

constexpr double kReached = 0.005;  // [m] from a place is there
constexpr double kNearer = 0.01;    // [m] by which another part of the robot may be to the place

Simulator::Config settingOf(const GovernedTrial::Config& config,
                            const std::shared_ptr<const RobotModel>& model, std::uint64_t seed) {
  Draw draw(seed);
  Simulator::Config simulator;
  simulator.scene = "empty";
  config.sensors.applyTo(simulator);
  simulator.motion = config.motion;
  simulator.controller = config.controller;
  simulator.controller.speed_mps = config.speed_mps;
  simulator.wander_length_m = std::max(1.0, config.speed_mps * config.duration_s);
  simulator.head.tilt.phase_rad = draw.between(0.0, 2.0 * M_PI);
  simulator.seed = seed;
  if (config.motion == kReachingAbout) {
    simulator.path = reachingAbout(model, simulator.wander_length_m, seed);
  }
  return simulator;
}

/// @throws std::out_of_range where the link has none.
std::size_t firstShape(const RobotModel& model, const std::string& link) {
  for (std::size_t i = 0; i < model.shapes().size(); ++i) {
    if (model.linkOf(i) == link) return i;
  }
  throw std::out_of_range("no shape of " + link);
}

}  // namespace

void GovernedTrial::Config::validate() const {
  controller.validate();
  oracle.validate();
  requireInRange("speed_mps", speed_mps, 0.01, 5.0);
  requireInRange("duration_s", duration_s, 5.0, 3600.0);
  requireInRange("slow_mps", slow_mps, 1e-4, 1.0);
  requireInRange("distance_m", distance_m, 0.01, 10.0);
}

GovernedTrial::GovernedTrial(const Config& config, const std::shared_ptr<const RobotModel>& model,
                             std::uint64_t seed)
    : config_((config.validate(), config)),
      simulation_(settingOf(config_, model, seed), config_.monitor, model),
      oracle_(config_.oracle, model) {
  for (const std::string& link : config_.links) shapes_.push_back(firstShape(*model, link));
  result_.seed = seed;
  result_.motion = config_.motion;
  simulation_.obey();
  simulation_.onScan(
      [this](const SimulatedScan& scan) { oracle_.add(scan.scan, simulation_.simulator().now()); });
  simulation_.onCloud([this](const MappedCloud& mapped) {
    const Cloud& cloud = mapped.cloud.cloud;
    if (config_.sensors.kinds[mapped.sensor] != SensorKind::kCamera) return;
    oracle_.add(config_.sensors.clouds, cloud.stamp, simulation_.simulator().now());
  });
  simulation_.onVerdict([this](const Verdict& verdict) {
    permitted_ = !verdict.stop;
    scale_ = verdict.speed_scale;
  });
}

GovernedTrial::Result GovernedTrial::run() {
  const Simulator& simulator = simulation_.simulator();
  const Time start = simulator.now();
  const Time end = start + fromSeconds(config_.duration_s);
  while (simulator.now() < end) {
    if (simulation_.step()) note();
  }
  for (std::size_t link = 0; link < shapes_.size(); ++link) judge(link);
  result_.simulated_s = toSeconds(simulator.now() - start);
  return result_;
}

void GovernedTrial::note() {
  const RobotSample& robot = *simulation_.robot();
  oracle_.add(robot);
  Instant instant{robot.stamp, std::abs(simulation_.simulator().controller().speed()), {}};
  for (const std::size_t i : shapes_) {
    const LinkShape& shape = simulation_.simulator().model().shapes()[i];
    instant.points.push_back(robot.link_poses[shape.link] * shape.T_link_shape.translation());
  }
  countTime(instant);
  instants_.push_back(std::move(instant));
}

void GovernedTrial::countTime(const Instant& instant) {
  if (instants_.empty()) return;
  const double elapsed_s = toSeconds(instant.stamp - instants_.back().stamp);
  result_.way_m += elapsed_s * instant.speed_mps;
  if (permitted_) result_.permitted_s += elapsed_s;
  if (permitted_ && scale_ < 1.0) result_.slowed_s += elapsed_s;
  if (permitted_ && instant.speed_mps < config_.slow_mps) result_.standing_s += elapsed_s;
}

/// Of a link, from the start until each instant [m].
std::vector<double> GovernedTrial::ways(std::size_t link) const {
  std::vector<double> ways = {0.0};
  for (std::size_t i = 1; i < instants_.size(); ++i) {
    ways.push_back(ways.back() +
                   (instants_[i].points[link] - instants_[i - 1].points[link]).norm());
  }
  return ways;
}

void GovernedTrial::judge(std::size_t link) {
  const std::vector<double> way = ways(link);
  for (std::size_t i = 1; i + 1 < instants_.size(); ++i) {
    const Vector3 move = instants_[i + 1].points[link] - instants_[i - 1].points[link];
    const double elapsed_s = toSeconds(instants_[i + 1].stamp - instants_[i - 1].stamp);
    if (move.norm() < config_.slow_mps * elapsed_s) continue;
    const Vector3 direction = move.normalized();
    const Vector3 front = oracle_.furthest(instants_[i].stamp, shapes_[link], direction);
    const Vector3 ahead = front + config_.distance_m * direction;
    const double least_m = config_.distance_m - kNearer;
    if (oracle_.distanceToRobot(instants_[i].stamp, ahead) < least_m) continue;
    const Case one = caseAt(link, i, ahead, way);
    ++result_.cases;
    if (one.way_m > config_.distance_m) ++result_.violations;
    if (one.left_m < kReached) ++result_.reached;
    if (one.way_m > result_.worst.way_m) result_.worst = one;
  }
}

/// Once the look is judged, the latency goes by and the arm brakes: all of its links take as long.
GovernedTrial::Case GovernedTrial::caseAt(std::size_t link, std::size_t i, const Vector3& ahead,
                                          const std::vector<double>& way) const {
  const Time now = instants_[i].stamp;
  const auto look = oracle_.firstLook(now, ahead);
  const Time brakes =
      look ? look->mapped + fromSeconds(config_.controller.latency_s) : instants_.back().stamp;
  const auto found = std::partition_point(instants_.begin(), instants_.end() - 1,
                                          [brakes](const Instant& k) { return k.stamp < brakes; });
  const auto k = static_cast<std::size_t>(found - instants_.begin());
  const double elapsed_s = toSeconds(instants_[k].stamp - instants_[k - 1].stamp);
  const double speed_mps = (way[k] - way[k - 1]) / elapsed_s;
  const double braking_s = found->speed_mps / config_.controller.acceleration_mps2;
  Case one{now, config_.links[link]};
  const double braking_m = 0.5 * speed_mps * braking_s;
  one.left_m = config_.distance_m;
  const auto leftAt = [&](std::size_t j) {
    return oracle_.distanceTo(instants_[j].stamp, shapes_[link], ahead);
  };
  // What it turns away from is not ahead any more.
  for (std::size_t j = i; j <= k; ++j) {
    const double left_m = leftAt(j);
    if (left_m > one.left_m) continue;
    one.left_m = left_m;
    one.way_m = way[j] - way[i];
    if (j == k) one.way_m += braking_m;
  }
  if (leftAt(k) <= one.left_m) one.left_m = std::max(0.0, one.left_m - braking_m);
  one.looked = look.has_value();
  one.wait_s = toSeconds((look ? look->beam : brakes) - now);
  return one;
}

}  // namespace tccm::simulation
