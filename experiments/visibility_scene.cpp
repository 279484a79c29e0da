#include "experiments/visibility_scene.h"

#include <algorithm>
#include <array>
#include <optional>
#include <random>

#include "experiments/draw.h"
#include "experiments/robot_part.h"
#include "robot/kinematics.h"
#include "simulation/motion.h"
#include "simulation/obstacle.h"
#include "simulation/robot/dual_arm.h"
#include "simulation/wander.h"
#include "tccm_monitor/config_error.h"

namespace tccm::simulation {
namespace {

using Model = std::shared_ptr<const RobotModel>;

/// A point of the arms that the sensor should see.
Vector3 goalOn(const RobotModel& model, const std::vector<Pose>& links, Draw& draw) {
  static const std::array<const char*, 6> kLinks = {"left_elbow_link",      "left_wrist_yaw_link",
                                                    "left_palm_link",       "right_elbow_link",
                                                    "right_wrist_yaw_link", "right_palm_link"};
  const Vector3 offset(draw.between(-0.08, 0.08), draw.between(-0.08, 0.08),
                       draw.between(-0.08, 0.08));
  return links[linkIndex(model, draw.of(kLinks))].translation() + offset;
}

/// All of it in the map's area and above the floor.
bool isInArea(const World& obstacle) {
  const UprightBox area(Vector3(0.0, -1.0, 0.1), Vector3(1.5, 1.0, 2.0));
  for (const SceneObject& part : obstacle) {
    if (!area.contains(bounds(part.shape, part.T_fixed_shape))) return false;
  }
  return true;
}

/// Nothing where there is no room for it.
std::optional<World> obstacleFor(ObstacleKind kind, const Model& model, RobotPart& robot,
                                 const std::vector<Pose>& links, double clearance_m, Draw& draw) {
  constexpr double kSpacing = 0.02;  // [m]
  const Vector3 sensor = laserOrigin(model, TiltMotion().mean_rad);
  const Vector3 goal = goalOn(*model, links, draw);
  World obstacle = obstacleBetween(kind, sensor, goal);
  const Vector3 further = draw.between(-0.25, 0.2) * (goal - sensor);
  for (SceneObject& part : obstacle) part.T_fixed_shape.pretranslate(further);
  robot.moveTo(links);
  const SampledBody body(bodyOf(obstacle), kSpacing);
  if (!isInArea(obstacle) || clearance(robot.body(), body) < clearance_m) return std::nullopt;
  return obstacle;
}

}  // namespace

void LinksThatCount::validate() const {
  requireInRange("in_range_min", in_range_min, 0.0, 1.0);
  requireInRange("silhouette_min_pixels", silhouette_min_pixels, 0.0, 1e4);
}

VisibilityScene visibilityScene(const Model& model, double clearance_m, std::uint64_t seed) {
  constexpr int kAttempts = 1000;
  static const std::array<const char*, 4> kObstacles = {"none", "pole", "arm", "box"};
  Draw draw(seed);
  std::mt19937_64 random(seed);
  Kinematics kinematics(model);
  RobotPart robot(model, {"left_*", "right_*", "head_*", "chest_link", "laser_link"}, 0.03);
  const std::string obstacle = draw.of(kObstacles);
  for (int i = 0; i < kAttempts; ++i) {
    VisibilityScene scene{draw.of(sceneNames()), obstacle, {}, {}};
    scene.joints = freePosture(model, tccm::simulation::scene(scene.scene), clearance_m, random);
    if (obstacle == "none") return scene;
    kinematics.update(scene.joints, {Pose::Identity()});
    const auto objects = obstacleFor(obstacleKind(obstacle), model, robot, kinematics.linkPoses(),
                                     clearance_m, draw);
    if (!objects) continue;
    scene.objects = *objects;
    return scene;
  }
  throw ConfigError("clearance_m: no obstacle keeps a clearance of " + std::to_string(clearance_m) +
                    " m");
}

ArmPath standing(const Model& model, const std::vector<double>& joints) {
  std::vector<double> beside = joints;
  beside[variableIndex(*model, "left_elbow_joint")] -= 1e-4;
  beside[variableIndex(*model, "right_elbow_joint")] -= 1e-4;
  return ArmPath(model, {joints, beside});
}

std::vector<TrueLinkVisibility> trueVisibility(const Model& model, const CheckedRobot::Config& pose,
                                               const std::vector<double>& joints, Body things,
                                               bool rest_hides, double resolution_rad) {
  const UsedShapes used = model->shapesFor(pose.occlusion_use, kOcclusionKeys);
  Kinematics kinematics(model);
  kinematics.update(joints, {Pose::Identity()});
  Body links;
  std::vector<std::uint32_t> link_of_shape;
  for (std::size_t shape = 0; shape < model->shapes().size(); ++shape) {
    const LinkShape& described = model->shapes()[shape];
    const auto drawn = std::find(used.shapes.begin(), used.shapes.end(), shape);
    if (drawn == used.shapes.end() && !rest_hides) continue;
    Body& body = drawn == used.shapes.end() ? things : links;
    body.poses.push_back(kinematics.shapePoses()[shape]);
    if (drawn == used.shapes.end()) {
      body.shapes.push_back(described.shape);
      continue;
    }
    const auto i = static_cast<std::size_t>(drawn - used.shapes.begin());
    body.shapes.push_back(expanded(described.shape, used.expansions[i]));
    link_of_shape.push_back(static_cast<std::uint32_t>(described.link));
  }
  TrueVisibility::Config config;
  config.resolution_rad = resolution_rad;
  config.margin_m = pose.occlusion.margin_m;
  return TrueVisibility(config).find(laserOrigin(model, TiltMotion().mean_rad), links,
                                     link_of_shape, things);
}

}  // namespace tccm::simulation
