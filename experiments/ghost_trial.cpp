#include "experiments/ghost_trial.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "experiments/draw.h"
#include "geometry/ray.h"
#include "simulation/robot/dual_arm.h"
#include "tccm_monitor/config_error.h"

namespace tccm::simulation {
namespace {

using Model = std::shared_ptr<const RobotModel>;

constexpr Time kStart{std::chrono::seconds(1000)};
// [s] after the start
constexpr double kHandComes = 3.0;
constexpr double kArmComes = 6.0;
constexpr double kHandLeaves = 9.0;
constexpr double kArmLeaves = 11.5;
const Vector3 kHandWay(0.6, 0.0, 0.1);  // [m] from where the person stands
constexpr double kHandSpeed = 0.5;      // [m/s]
constexpr double kArmSpeed = 0.25;      // [m/s]

World lyingHand(Draw& draw) {
  Pose place = at(draw.between(0.72, 0.85), draw.between(-0.25, 0.0), draw.between(0.88, 0.95));
  place.rotate(Eigen::AngleAxisd(draw.between(-0.4, 0.4), Vector3::UnitZ()));
  World hand = obstacleAt(ObstacleKind::kArm, place);
  for (SceneObject& part : hand) {
    part.entrance = Entrance{kStart + fromSeconds(kHandComes), kHandWay, kHandSpeed};
    part.departure = Departure{kStart + fromSeconds(kHandLeaves), kHandWay, kHandSpeed};
  }
  return hand;
}

/// From aside to between the sensor and a place, and back.
ArmPath coveringPath(const Model& model, const Vector3& place, Draw& draw) {
  constexpr double kHandCentre = 0.07;  // [m] ahead of the palm's link
  const Vector3 sensor = laserOrigin(model, TiltMotion().mean_rad);
  const Vector3 aside(0.32, -0.45, 1.0);
  Vector3 between = sensor + draw.between(0.68, 0.74) * (place - sensor);
  between.x() -= kHandCentre;
  return reachVia(model, {aside, between, aside});
}

Simulator::Config settingOf(const GhostTrial::Config& config, const Model& model,
                            std::uint64_t seed) {
  config.validate();
  Draw draw(seed);
  const World hand = lyingHand(draw);
  Simulator::Config simulator;
  simulator.start = kStart;
  simulator.scene = "empty";
  simulator.objects = bareTable();
  simulator.path = coveringPath(model, hand.front().T_fixed_shape.translation(), draw);
  const double way_m = 0.5 * simulator.path->length();
  const double covers_s = kArmLeaves - kArmComes - way_m / kArmSpeed;
  simulator.controller = config.controller;
  simulator.controller.stages = {
      {0.0, kArmSpeed, kArmComes}, {way_m, kArmSpeed, covers_s}, {2.0 * way_m, kArmSpeed, 0.0}};
  simulator.scanner.noise_m = config.noise_m;
  simulator.head.tilt.phase_rad = draw.between(0.0, 2.0 * M_PI);
  simulator.seed = seed;
  simulator.objects.insert(simulator.objects.end(), hand.begin(), hand.end());
  return simulator;
}

/// Those of the simulator's objects that belong to the person.
World handOf(const Simulator::Config& setting) {
  World hand;
  std::copy_if(setting.objects.begin(), setting.objects.end(), std::back_inserter(hand),
               [](const SceneObject& object) { return object.departure.has_value(); });
  return hand;
}

/// Where a ray enters any of a body's shapes; infinite where it meets none.
double enters(const Body& body, const Ray& ray) {
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < body.shapes.size(); ++i) {
    const auto span = intersect(body.shapes[i], transformed(ray, body.poses[i].inverse()));
    if (span) nearest = std::min(nearest, span->enter);
  }
  return nearest;
}

/// Points of a body's surface that face the viewpoint, in the fixed frame.
std::vector<Vector3> facing(const Body& body, const Vector3& viewpoint) {
  constexpr double kSpacing = 0.02;  // [m]
  constexpr double kOwn = 1e-6;      // [m]
  std::vector<Vector3> points;
  for (std::size_t i = 0; i < body.shapes.size(); ++i) {
    for (const Vector3& p_shape : surfacePoints(body.shapes[i], kSpacing)) {
      const Vector3 p = body.poses[i] * p_shape;
      const Vector3 way = p - viewpoint;
      if (enters(body, {viewpoint, way.normalized()}) > way.norm() - kOwn) points.push_back(p);
    }
  }
  return points;
}

}  // namespace

void GhostTrial::Config::validate() const {
  controller.validate();
  requireInRange("noise_m", noise_m, 0.0, 0.1);
  requireInRange("deadline_tilt_periods", deadline_tilt_periods, 0.0, 100.0);
}

GhostTrial::GhostTrial(const Config& config, const Model& model, std::uint64_t seed)
    : config_(config),
      setting_(settingOf(config, model, seed)),
      hand_(bodyOf(handOf(setting_))),
      simulation_(setting_, config.monitor, model),
      arm_(model, {"right_*"}, 0.1),
      surface_(facing(hand_, laserOrigin(model, TiltMotion().mean_rad))) {
  result_.seed = seed;
  simulation_.onScan([this](const SimulatedScan&) { look(); });
}

GhostTrial::Result GhostTrial::run() {
  const Simulator& simulator = simulation_.simulator();
  const Duration wait =
      fromSeconds((config_.deadline_tilt_periods + 1.0) * setting_.head.tilt.period_s);
  while (simulator.controller().stagesDone() < setting_.controller.stages.size() ||
         simulator.now() < last_hidden_ + wait) {
    simulation_.step();
  }
  const Time deadline =
      last_hidden_ + fromSeconds(config_.deadline_tilt_periods * setting_.head.tilt.period_s);
  Time gone = last_hidden_;
  for (const auto& [stamp, cuboids] : counts_) {
    if (stamp <= deadline) {
      result_.left = cuboids.all();
      result_.left_held = cuboids.held;
    }
    if (cuboids.all() > 0) gone = std::max(gone, stamp);
  }
  if (counts_.back().second.all() == 0) result_.gone_after_s = toSeconds(gone - last_hidden_);
  result_.hidden_s = toSeconds(last_hidden_ - kStart) - kHandLeaves;
  result_.simulated_s = toSeconds(simulator.now() - kStart);
  return result_;
}

void GhostTrial::look() {
  const Time now = simulation_.simulator().now();
  const Count count = cuboidsInPlace();
  if (now < kStart + fromSeconds(kHandLeaves)) {
    result_.seen_max = std::max(result_.seen_max, count.all());
    return;
  }
  result_.held_max = std::max(result_.held_max, count.held);
  if (placeIsHidden()) last_hidden_ = now;
  counts_.emplace_back(now, count);
}

GhostTrial::Count GhostTrial::cuboidsInPlace() const {
  constexpr double kNear = 0.04;  // [m] more than noise makes of a cuboid's height
  const CuboidMap& map = *simulation_.monitor().map();
  Count count;
  for (const Cuboid& cuboid : map.cuboids) {
    const Vector3 centre = map.box(cuboid).center();
    for (std::size_t i = 0; i < hand_.shapes.size(); ++i) {
      if (distance(hand_.shapes[i], hand_.poses[i].inverse() * centre) > kNear) continue;
      ++(cuboid.held ? count.held : count.live);
      break;
    }
  }
  return count;
}

/// Any part of it, by the arm.
bool GhostTrial::placeIsHidden() {
  arm_.moveTo(simulation_.robot()->link_poses);
  const Vector3 sensor = simulation_.monitor().map()->viewpoint;
  return std::any_of(surface_.begin(), surface_.end(), [&](const Vector3& p) {
    const Vector3 way = p - sensor;
    return enters(arm_.body().body(), {sensor, way.normalized()}) < way.norm();
  });
}

}  // namespace tccm::simulation
