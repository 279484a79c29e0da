#include "experiments/occlusion_trial.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "experiments/draw.h"
#include "simulation/robot/dual_arm.h"
#include "tccm_monitor/config_error.h"

namespace tccm::simulation {
namespace {

constexpr double kSettled = 5.0;  // [s] until the map is whole
constexpr double kAside = 0.4;    // [m] that an occluder is brought in from

}  // namespace

void OcclusionTrial::Config::validate() const {
  requireInRange("noise_m", noise_m, 0.0, 0.1);
  requireInRange("clearance_m", clearance_m, 0.0, 0.2);
  requireInRange("resolution_rad", resolution_rad, 1e-3, 0.1);
  counted.validate();
  requireInRange("obstacle_speed_mps", obstacle_speed_mps, 0.0, 10.0);
  requireInRange("hidden_min", hidden_min, 0.0, 1.0);
}

OcclusionTrial::OcclusionTrial(const Config& config, std::shared_ptr<const RobotModel> model,
                               std::uint64_t seed)
    : config_((config.validate(), config)),
      model_(std::move(model)),
      scene_(visibilityScene(model_, config_.clearance_m, seed)),
      simulation_(settingFor(seed), config_.monitor, model_),
      watched_(watchedLinks()) {
  result_.seed = seed;
  result_.scene = scene_.scene;
  result_.obstacle = scene_.obstacle;
  // The arms stand.
  simulation_.simulator().setStop(true);
  simulation_.onScan([this](const SimulatedScan& scan) { noteScan(scan); });
  simulation_.onVerdict([this](const Verdict& verdict) { noteVerdict(verdict); });
}

Simulator::Config OcclusionTrial::settingFor(std::uint64_t seed) {
  Draw draw(seed);
  Simulator::Config simulator;
  const double period_s = simulator.head.tilt.period_s;
  const double settled_s = kSettled + draw.between(0.0, period_s);
  result_.tilt_phase = std::fmod(settled_s / period_s, 1.0);
  there_ = simulator.start + fromSeconds(settled_s);
  Entrance entrance{there_};
  if (config_.obstacle_speed_mps > 0.0) {
    const double side = draw.between(-1.0, 1.0) < 0.0 ? -kAside : kAside;
    entrance.offset = Vector3(0.0, side, 0.0);
    entrance.speed_mps = config_.obstacle_speed_mps;
    entrance.appears = there_ - fromSeconds(kAside / config_.obstacle_speed_mps);
  }
  simulator.scene = scene_.scene;
  simulator.objects = scene_.objects;
  for (SceneObject& part : simulator.objects) part.entrance = entrance;
  simulator.path = standing(model_, scene_.joints);
  simulator.scanner.noise_m = config_.noise_m;
  simulator.seed = seed;
  return simulator;
}

/// Links of a size that the laser looks at, and what the occluder hides of each.
std::vector<OcclusionTrial::Watched> OcclusionTrial::watchedLinks() const {
  const CheckedRobot::Config& pose = config_.monitor.checker.pose;
  const World& world = simulation_.simulator().world();
  World standing_things;
  std::copy_if(world.begin(), world.end(), std::back_inserter(standing_things),
               [](const SceneObject& object) { return object.name != kObstacleName; });
  const auto find = [&](const World& things) {
    return trueVisibility(model_, pose, scene_.joints, bodyOf(things), true,
                          config_.resolution_rad);
  };
  const std::vector<TrueLinkVisibility> before = find(standing_things);
  const std::vector<TrueLinkVisibility> after = find(world);
  const double pixel_sr = std::pow(pose.occlusion.resolution_rad, 2);
  std::vector<Watched> watched;
  for (std::size_t i = 0; i < before.size(); ++i) {
    if (!config_.counted.has(before[i].in_range, before[i].silhouette_sr / pixel_sr)) continue;
    Watched link{before[i].link,
                 before[i].visible_fraction,
                 before[i].visible_fraction - after[i].visible_fraction,
                 {}};
    link.found.name = model_->links()[link.link];
    link.found.hidden = link.hidden;
    watched.push_back(link);
  }
  return watched;
}

void OcclusionTrial::noteScan(const SimulatedScan& scan) {
  if (result_.beam_s || !occluderIsThere()) return;
  const World& world = simulation_.simulator().world();
  for (std::size_t i = 0; i < scan.truth.size(); ++i) {
    const BeamTruth& beam = scan.truth[i];
    if (!beam.label || *beam.label < Simulator::kFirstObject || beam.mixed) continue;
    if (world[*beam.label - Simulator::kFirstObject].name != kObstacleName) continue;
    const double beam_s = toSeconds(scan.scan.beamTime(i) - there_);
    if (beam_s < 0.0) continue;
    result_.beam_s = beam_s;
    return;
  }
}

void OcclusionTrial::noteVerdict(const Verdict& verdict) {
  if (!verdict.known || !occluderIsThere()) return;
  const OcclusionCheck::Config& occlusion = config_.monitor.checker.pose.occlusion;
  for (Watched& watched : watched_) {
    for (const LinkVisibility& link : verdict.now.links) {
      if (link.link != watched.link) continue;
      watched.found.occluded = std::max(watched.found.occluded, link.occluded_fraction);
      const bool is_found = link.silhouette >= occlusion.silhouette_min_pixels &&
                            link.occluded_fraction >= occlusion.hidden_fraction;
      if (is_found && !watched.found.found_s) {
        watched.found.found_s = toSeconds(verdict.stamp - there_);
      }
    }
  }
}

/// One tilt, the scan that ends it, and the robot sample that it waits for.
OcclusionTrial::Result OcclusionTrial::run() {
  const Simulator& simulator = simulation_.simulator();
  const Time start = simulator.now();
  const ScanningHead::Config head;
  const Scanner::Config scanner;
  const Time end = there_ + fromSeconds(head.tilt.period_s + 2.0 * scanner.period_s + 0.01);
  while (simulator.now() < end) simulation_.step();
  for (const Watched& watched : watched_) {
    const bool is_hidden = watched.hidden > config_.hidden_min;
    if (is_hidden && (!result_.link || watched.hidden > result_.link->hidden)) {
      result_.link = watched.found;
    }
    const bool is_free = 1.0 - watched.visible + watched.hidden <= config_.hidden_min;
    if (is_free && watched.found.found_s && !result_.false_flag) {
      result_.false_flag = watched.found;
    }
  }
  result_.simulated_s = toSeconds(simulator.now() - start);
  return result_;
}

}  // namespace tccm::simulation
