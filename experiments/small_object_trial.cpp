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

/// With its arms where they begin.
struct RobotAtStart {
  Body body;
  std::vector<Pose> link_poses;
};

RobotAtStart robotAtStart(const std::shared_ptr<const RobotModel>& model) {
  Simulator::Config setting;
  setting.scene = kScene;
  Simulator simulator(setting);
  simulator.setStop(true);
  StepOutput output;
  while (!output.robot) output = simulator.step();
  Kinematics kinematics(model);
  kinematics.update(output.robot->positions, {Pose::Identity()});
  RobotAtStart robot{{}, kinematics.linkPoses()};
  for (std::size_t i = 0; i < model->shapes().size(); ++i) {
    robot.body.shapes.push_back(model->shapes()[i].shape);
    robot.body.poses.push_back(kinematics.shapePoses()[i]);
  }
  return robot;
}

/// Whether a camera sees all of a box before the robot: by what each pixel of its picture shows.
class BoxInPicture {
 public:
  BoxInPicture(const CloudSensors::Config& sensors, const RobotModel& model,
               const RobotAtStart& robot)
      : config_(sensors.camera),
        T_fixed_camera_(robot.link_poses[linkIndex(model, sensors.camera_mount.link)] *
                        sensors.camera_mount.T_link_sensor),
        robot_(sensors.camera.pinhole) {
    const Pose T_camera_fixed = T_fixed_camera_.inverse();
    for (std::size_t i = 0; i < robot.body.shapes.size(); ++i) {
      robot_.draw(0, robot.body.shapes[i], T_camera_fixed * robot.body.poses[i]);
    }
  }

  [[nodiscard]] Vector3 camera() const { return T_fixed_camera_.translation(); }
  [[nodiscard]] bool showsAll(const SceneObject& box) const {
    const Vector3 p_camera = T_fixed_camera_.inverse() * box.T_fixed_shape.translation();
    const double radius = boundingRadius(box.shape);
    if (p_camera.z() - radius < config_.depth_min_m) return false;
    const Pinhole& pinhole = config_.pinhole;
    const double depth = p_camera.z() - radius;
    const double right = pinhole.focal_px * (std::abs(p_camera.x()) + radius) / depth;
    const double down = pinhole.focal_px * (std::abs(p_camera.y()) + radius) / depth;
    if (right > pinhole.centreColumn() || down > pinhole.centreRow()) return false;
    DepthImage alone(pinhole);
    alone.draw(1, box.shape, T_fixed_camera_.inverse() * box.T_fixed_shape);
    for (std::size_t i = 0; i < alone.targets().size(); ++i) {
      const bool hidden = alone.targets()[i] != DepthImage::kNothing &&
                          robot_.inverseDepths()[i] > alone.inverseDepths()[i];
      if (hidden) return false;
    }
    return true;
  }

 private:
  DepthCamera::Config config_;
  Pose T_fixed_camera_;
  DepthImage robot_;
};

/// Of an even grid.
std::vector<Vector3> placesAround(const Vector3& middle, double within_m, double step_m) {
  const auto steps = static_cast<int>(within_m / step_m);
  std::vector<Vector3> places;
  for (int ix = -steps; ix <= steps; ++ix) {
    for (int iy = -steps; iy <= steps; ++iy) {
      for (int iz = -steps; iz <= steps; ++iz) {
        const Vector3 place = middle + step_m * Vector3(ix, iy, iz);
        if ((place - middle).norm() <= within_m) places.push_back(place);
      }
    }
  }
  return places;
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
  const bool is_camera = sensors.kinds == std::vector<SensorKind>{SensorKind::kCamera};
  if (!sensors.isLaserAlone() && !is_camera) {
    throw ConfigError("sensors: small objects are looked for by the laser alone or a camera alone");
  }
}

double SmallObjectTrial::Config::limit() const {
  return ofCamera() ? sensors.clouds.camera.period_s + 0.001 : tilt.period_s + scanner.period_s;
}

SmallObjectTrial::SmallObjectTrial(const Config& config, std::shared_ptr<const RobotModel> model,
                                   const Vector3& place, std::uint64_t seed)
    : config_((config.validate(), config)),
      check_(config_.monitor.checker.pose.collision),
      simulation_(settingFor(place, seed), config_.monitor, std::move(model)) {
  simulation_.simulator().setStop(true);
  simulation_.onScan([this](const SimulatedScan& scan) { noteScan(scan); });
  simulation_.onCloud([this](const MappedCloud& frame) { noteFrame(frame); });
}

Simulator::Config SmallObjectTrial::settingFor(const Vector3& place, std::uint64_t seed) {
  Draw draw(seed);
  Simulator::Config setting;
  setting.seed = seed;
  setting.scene = kScene;
  config_.sensors.applyTo(setting);
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

std::size_t SmallObjectTrial::label() const {
  return Simulator::kFirstObject + simulation_.simulator().world().size() - 1;
}

void SmallObjectTrial::noteScan(const SimulatedScan& scan) {
  for (std::size_t i = 0; i < scan.truth.size() && !result_.beam_s; ++i) {
    const bool shows = scan.truth[i].label == label() && !scan.truth[i].mixed;
    if (shows) result_.beam_s = toSeconds(scan.scan.beamTime(i) - there_);
  }
  lookForContact(scan.scan.lastBeamTime());
}

void SmallObjectTrial::noteFrame(const MappedCloud& frame) {
  const Cloud& cloud = frame.cloud.cloud;
  for (std::size_t i = 0; i < cloud.points.size() && !result_.beam_s; ++i) {
    const PointTruth& truth = frame.cloud.truth[i];
    const bool shows = truth.label == label() && !truth.mixed() && isMeasured(cloud.points[i]);
    if (shows) result_.beam_s = toSeconds(cloud.stamp - there_);
  }
  lookForContact(cloud.last());
}

/// The map of before knows nothing of the box, but may hold something else there.
void SmallObjectTrial::lookForContact(Time seen) {
  if (!result_.beam_s || result_.found_s) return;
  const CuboidMap& map = *simulation_.monitor().map();
  if (check_.first(map, object_.shape, object_.T_fixed_shape, 0)) {
    result_.found_s = toSeconds(seen - there_);
  }
}

SmallObjectTrial::Result SmallObjectTrial::run() {
  constexpr double kFrames = 10.0;  // after which it is not found
  const double longest_s = config_.ofCamera()
                               ? kFrames * config_.sensors.clouds.camera.period_s
                               : config_.tilt.period_s + 2.0 * config_.scanner.period_s;
  const double length_s = config_.settle_s + longest_s;
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
  const RobotAtStart robot = robotAtStart(model);
  const Grid grid(config.monitor.sensors.front().mapper.map.grid);
  const double radius_m = std::sqrt(0.75) * config.size_m;
  const auto isFree = [&](const Vector3& place) {
    const Vector3 reach = Vector3::Constant(radius_m);
    return grid.cellOf(place - reach) && grid.cellOf(place + reach) &&
           place.z() - radius_m > grid.config().height_min_m &&
           isClear(robot.body, place, kClearOfRobot + radius_m);
  };
  std::vector<Vector3> places;
  const auto take = [&](const Vector3& sensor, auto&& isSeen) {
    for (const Vector3& place : placesAround(sensor, within_m, step_m)) {
      if (isFree(place) && isSeen(boxAt(place, 0.0, config.size_m))) places.push_back(place);
    }
  };
  if (config.ofCamera()) {
    const BoxInPicture picture(config.sensors.clouds, *model, robot);
    take(picture.camera(), [&](const SceneObject& box) { return picture.showsAll(box); });
    return places;
  }
  const Vector3 laser = laserOrigin(model, config.tilt.mean_rad);
  TrueVisibility::Config rays;
  rays.margin_m = 0.0;
  rays.tilt = config.tilt;
  const TrueVisibility visibility(rays);
  take(laser, [&](const SceneObject& box) {
    const TrueLinkVisibility seen = visibility.find(laser, bodyOf({box}), {0}, robot.body).front();
    return seen.in_range >= kWhole && seen.visible_fraction >= kWhole;
  });
  return places;
}

}  // namespace tccm::simulation
