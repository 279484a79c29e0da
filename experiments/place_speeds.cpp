#include "experiments/place_speeds.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "robot/kinematics.h"
#include "robot/link_use.h"
#include "simulation/robot/dual_arm.h"
#include "tccm_monitor/config_error.h"

namespace tccm::simulation {
namespace {

constexpr double kSettled = 8.0;  // [s] until the map is whole and the speed scale up

/// To and fro sideways: the laser is tilted by the same angle all along.
ArmPath acrossAt(const std::shared_ptr<const RobotModel>& model, double tilt_rad) {
  constexpr double kAhead = 0.5;  // [m] of the laser, where the arm reaches so far
  constexpr double kBelow = 0.7;  // [m] the laser, at most
  const Vector3 half(0.0, 0.12, 0.0);
  const double ahead = std::min(kAhead, kBelow / std::tan(tilt_rad));
  const Vector3 middle =
      laserOrigin(model, tilt_rad) + Vector3(ahead, -0.22, -ahead * std::tan(tilt_rad));
  try {
    return reachVia(model, {middle - half, middle + half});
  } catch (const std::runtime_error&) {
    throw ConfigError("tilt_rad: no hand is where the laser looks at " + std::to_string(tilt_rad));
  }
}

std::vector<double> partTilts(const std::vector<std::string>& links,
                              const std::shared_ptr<const RobotModel>& model, const ArmPath& path,
                              double tilt_rad) {
  constexpr double kMoves = 0.05;  // [m]
  Kinematics start(model);
  Kinematics halfway(model);
  start.update(path.positions(0.0), {Pose::Identity()});
  halfway.update(path.positions(0.5 * path.length()), {Pose::Identity()});
  const LinkSelector selector({}, model->links());
  const Vector3 laser = laserOrigin(model, tilt_rad);
  std::vector<double> tilts;
  for (std::size_t i = 0; i < model->shapes().size(); ++i) {
    const Vector3 p_fixed = halfway.shapePoses()[i].translation();
    const double moved_m = (p_fixed - start.shapePoses()[i].translation()).norm();
    if (moved_m < kMoves || !selector.matches(links, model->linkOf(i))) continue;
    tilts.push_back(std::atan2(laser.z() - p_fixed.z(), p_fixed.x() - laser.x()));
  }
  return tilts;
}

Simulator::Config settingOf(const PlaceSpeeds::Config& config,
                            const std::shared_ptr<const RobotModel>& model, double tilt_rad,
                            std::uint64_t seed) {
  config.validate();
  requireInRange("tilt_rad", tilt_rad, 0.1, 1.4);
  Simulator::Config simulator;
  simulator.scene = "empty";
  simulator.path = acrossAt(model, tilt_rad);
  simulator.controller = config.controller;
  simulator.controller.speed_mps = config.speed_mps;
  simulator.controller.dwell_s = 0.0;
  simulator.controller.resume_mps2 = config.controller.acceleration_mps2;
  simulator.seed = seed;
  return simulator;
}

}  // namespace

void PlaceSpeeds::Config::validate() const {
  controller.validate();
  requireInRange("speed_mps", speed_mps, 0.01, 5.0);
  requireInRange("duration_s", duration_s, kSettled + 1.0, 3600.0);
  requireInRange("phases", static_cast<double>(phases), 1.0, 1000.0);
}

PlaceSpeeds::PlaceSpeeds(const Config& config, const std::shared_ptr<const RobotModel>& model,
                         double tilt_rad, std::uint64_t seed)
    : config_(config),
      simulation_(settingOf(config, model, tilt_rad, seed), config.monitor, model),
      start_(simulation_.simulator().now()),
      sums_mps_(config.phases, 0.0),
      counts_(config.phases, 0) {
  result_.tilt_rad = tilt_rad;
  result_.part_tilts_rad = partTilts(config_.links, model, acrossAt(model, tilt_rad), tilt_rad);
  simulation_.obey();
  simulation_.onVerdict([this](const Verdict& verdict) { note(verdict); });
}

PlaceSpeeds::Result PlaceSpeeds::run() {
  const Simulator& simulator = simulation_.simulator();
  const Time settled = start_ + fromSeconds(kSettled);
  double way_m = 0.0;
  while (simulator.now() < start_ + fromSeconds(config_.duration_s)) {
    simulation_.step();
    if (simulator.now() > settled) way_m += 1e-3 * std::abs(simulator.controller().speed());
  }
  double sum = 0.0;
  for (std::size_t i = 0; i < config_.phases; ++i) {
    const auto count = static_cast<double>(std::max<std::size_t>(counts_[i], 1));
    result_.allowed_mps.push_back(sums_mps_[i] / count);
    sum += result_.allowed_mps.back();
  }
  result_.mean_mps = sum / static_cast<double>(config_.phases);
  result_.travelled_mps = way_m / (config_.duration_s - kSettled);
  result_.simulated_s = config_.duration_s;
  return result_;
}

void PlaceSpeeds::note(const Verdict& verdict) {
  const double elapsed_s = toSeconds(verdict.stamp - start_);
  if (elapsed_s < kSettled) return;
  const double phase = std::fmod(elapsed_s / TiltMotion().period_s, 1.0);
  const auto i = static_cast<std::size_t>(phase * static_cast<double>(config_.phases));
  sums_mps_[i] += config_.speed_mps * verdict.speed_scale;
  ++counts_[i];
}

}  // namespace tccm::simulation
