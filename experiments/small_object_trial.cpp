#include "experiments/small_object_trial.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "experiments/draw.h"
#include "experiments/true_visibility.h"
#include "simulation/robot/dual_arm.h"
#include "tccm_monitor/config_error.h"

namespace tccm::simulation {
namespace {

const char kScene[] = "empty";
constexpr double kClearOfRobot = 0.1;  // [m]: what is nearer the self filter takes for the robot
constexpr double kWhole = 0.999;       // of the box's silhouette

SceneObject boxAt(const Vector3& place, double yaw_rad, double size_m) {
  Pose pose = Pose::Identity();
  pose.translation() = place;
  pose.rotate(Eigen::AngleAxisd(yaw_rad, Vector3::UnitZ()));
  return {"small", Box{Vector3::Constant(0.5 * size_m)}, pose, Eigen::Vector3f(0.9F, 0.6F, 0.1F)};
}

/// The robot with its arms where they begin.
Body robotAtStart(const std::shared_ptr<const RobotModel>& model) {
  Simulator::Config setting;
  setting.scene = kScene;
  Simulator simulator(setting);
  simulator.setStop(true);
  StepOutput output;
  while (!output.robot) output = simulator.step();
  Kinematics kinematics(model);
  kinematics.update(output.robot->positions, {Pose::Identity()});
  Body body;
  for (std::size_t i = 0; i < model->shapes().size(); ++i) {
    body.shapes.push_back(model->shapes()[i].shape);
    body.poses.push_back(kinematics.shapePoses()[i]);
  }
  return body;
}

bool isClear(const Body& robot, const Vector3& place, double clearance_m) {
  for (std::size_t i = 0; i < robot.shapes.size(); ++i) {
    if (distance(robot.shapes[i], robot.poses[i].inverse() * place) < clearance_m) return false;
  }
  return true;
}

}  // namespace

void SmallObjectTrial::Config::validate() const {
  scanner.validate();
  requireInRange("size_m", size_m, 0.005, 0.5);
  requireInRange("settle_s", settle_s, 0.0, 100.0);
}

SmallObjectTrial::SmallObjectTrial(const Config& config, std::shared_ptr<const RobotModel> model,
                                   const Vector3& place, std::uint64_t seed)
    : config_((config.validate(), config)),
      check_(config_.monitor.checker.pose.collision),
      simulation_(settingFor(place, seed), config_.monitor, std::move(model)) {
  simulation_.simulator().setStop(true);
  simulation_.onScan([this](const SimulatedScan& scan) { noteScan(scan); });
}

Simulator::Config SmallObjectTrial::settingFor(const Vector3& place, std::uint64_t seed) {
  Draw draw(seed);
  Simulator::Config setting;
  setting.seed = seed;
  setting.scene = kScene;
  setting.scanner = config_.scanner;
  setting.head.tilt = config_.tilt;
  setting.head.tilt.phase_rad = draw.between(0.0, 2.0 * M_PI);
  const double turns =
      setting.head.tilt.phase_rad / (2.0 * M_PI) + config_.settle_s / setting.head.tilt.period_s;
  result_.seed = seed;
  result_.place = place;
  result_.yaw_rad = draw.between(0.0, 0.5 * M_PI);
  result_.tilt_phase = turns - std::floor(turns);
  there_ = setting.start + fromSeconds(config_.settle_s);
  object_ = boxAt(place, result_.yaw_rad, config_.size_m);
  object_.entrance = Entrance{there_};
  setting.objects = {object_};
  return setting;
}

void SmallObjectTrial::noteScan(const SimulatedScan& scan) {
  const std::size_t label = Simulator::kFirstObject + simulation_.simulator().world().size() - 1;
  for (std::size_t i = 0; i < scan.truth.size() && !result_.beam_s; ++i) {
    const bool shows = scan.truth[i].label == label && !scan.truth[i].mixed;
    if (shows) result_.beam_s = toSeconds(scan.scan.beamTime(i) - there_);
  }
  // The map of before knows nothing of it, but may hold something else there.
  if (!result_.beam_s || result_.found_s) return;
  const CuboidMap& map = *simulation_.monitor().map();
  if (check_.first(map, object_.shape, object_.T_fixed_shape, 0)) {
    result_.found_s = toSeconds(scan.scan.lastBeamTime() - there_);
  }
}

SmallObjectTrial::Result SmallObjectTrial::run() {
  const double length_s = config_.settle_s + config_.tilt.period_s + 2.0 * config_.scanner.period_s;
  const Time end = simulation_.simulator().now() + fromSeconds(length_s);
  while (simulation_.simulator().now() < end && !result_.found_s) simulation_.step();
  result_.simulated_s = length_s - toSeconds(end - simulation_.simulator().now());
  return result_;
}

std::vector<Vector3> smallObjectPlaces(const SmallObjectTrial::Config& config,
                                       const std::shared_ptr<const RobotModel>& model,
                                       double within_m, double step_m) {
  requireInRange("within_m", within_m, 0.1, 10.0);
  requireInRange("step_m", step_m, 0.01, 1.0);
  const Body robot = robotAtStart(model);
  const Vector3 laser = laserOrigin(model, config.tilt.mean_rad);
  TrueVisibility::Config rays;
  rays.margin_m = 0.0;
  rays.tilt = config.tilt;
  const TrueVisibility visibility(rays);
  const Grid grid(config.monitor.sensors.front().mapper.map.grid);
  const Grid::Config& area = grid.config();
  const double radius_m = std::sqrt(0.75) * config.size_m;
  const auto steps = static_cast<int>(within_m / step_m);
  std::vector<Vector3> places;
  for (int ix = -steps; ix <= steps; ++ix) {
    for (int iy = -steps; iy <= steps; ++iy) {
      for (int iz = -steps; iz <= steps; ++iz) {
        const Vector3 place = laser + step_m * Vector3(ix, iy, iz);
        const Vector3 reach = Vector3::Constant(radius_m);
        const bool in_area = grid.cellOf(place - reach) && grid.cellOf(place + reach) &&
                             place.z() - radius_m > area.height_min_m;
        if (!in_area || (place - laser).norm() > within_m) continue;
        if (!isClear(robot, place, kClearOfRobot + radius_m)) continue;
        const SceneObject box = boxAt(place, 0.0, config.size_m);
        const TrueLinkVisibility seen = visibility.find(laser, bodyOf({box}), {0}, robot).front();
        if (seen.in_range >= kWhole && seen.visible_fraction >= kWhole) places.push_back(place);
      }
    }
  }
  return places;
}

}  // namespace tccm::simulation
