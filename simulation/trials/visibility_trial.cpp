#include "simulation/trials/visibility_trial.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "simulation/robot/dual_arm.h"
#include "simulation/trials/visibility_scene.h"
#include "tccm_monitor/config_error.h"

namespace tccm::simulation {
namespace {

VisibilityTrial::Config validated(const VisibilityTrial::Config& config) {
  config.validate();
  return config;
}

/// A path that stays where it is, but for a hair.
ArmPath standing(const std::shared_ptr<const RobotModel>& model,
                 const std::vector<double>& joints) {
  std::vector<double> beside = joints;
  beside[variableIndex(*model, "left_elbow_joint")] -= 1e-4;
  beside[variableIndex(*model, "right_elbow_joint")] -= 1e-4;
  return ArmPath(model, {joints, beside});
}

Simulator::Config settingOf(const VisibilityTrial::Config& config,
                            const std::shared_ptr<const RobotModel>& model,
                            const VisibilityScene& scene, std::uint64_t seed) {
  Simulator::Config simulator;
  simulator.scene = scene.scene;
  simulator.objects = scene.objects;
  std::vector<double> joints = scene.joints;
  if (config.robot == VisibilityTrial::Robot::kAway) {
    std::fill(joints.begin(), joints.end(), 0.0);
    joints[variableIndex(*model, "left_elbow_joint")] = -0.01;
    joints[variableIndex(*model, "right_elbow_joint")] = -0.01;
  }
  simulator.path = standing(model, joints);
  simulator.scanner.noise_m = config.noise_m;
  simulator.seed = seed;
  return simulator;
}

}  // namespace

VisibilityTrial::Robot visibilityRobot(const std::string& name) {
  if (name == "in_pose") return VisibilityTrial::Robot::kInPose;
  if (name == "away") return VisibilityTrial::Robot::kAway;
  throw ConfigError("robot: " + name + " is none of in_pose, away");
}

void VisibilityTrial::Config::validate() const {
  requireInRange("noise_m", noise_m, 0.0, 0.1);
  requireInRange("clearance_m", clearance_m, 0.0, 0.2);
  requireInRange("resolution_rad", resolution_rad, 1e-3, 0.1);
}

VisibilityTrial::VisibilityTrial(const Config& config, std::shared_ptr<const RobotModel> model,
                                 std::uint64_t seed)
    : config_(validated(config)),
      model_(std::move(model)),
      scene_(visibilityScene(model_, config_.clearance_m, seed)),
      simulation_(settingOf(config_, model_, scene_, seed), config_.monitor, model_) {
  result_.seed = seed;
  result_.scene = scene_.scene;
  result_.obstacle = scene_.obstacle;
  // The arms stand.
  simulation_.simulator().setStop(true);
}

/// Until the map holds a whole window.
void VisibilityTrial::waitForMap() {
  constexpr double kLongest = 20.0;  // [s]
  const Time start = simulation_.simulator().now();
  const auto complete = [this] {
    return simulation_.monitor().map() != nullptr && simulation_.monitor().map()->complete;
  };
  while (!complete()) {
    simulation_.step();
    if (simulation_.simulator().now() - start > fromSeconds(kLongest)) {
      throw std::runtime_error("the map does not fill");
    }
  }
  result_.simulated_s = toSeconds(simulation_.simulator().now() - start);
}

/// Of a robot that stood in its pose while the map filled, what is not drawn hides links too.
std::vector<TrueLinkVisibility> VisibilityTrial::truth() const {
  const PoseCheck::Config& pose = simulation_.monitor().checker().config().pose;
  const UsedShapes used = model_->shapesFor(pose.occlusion_use, kOcclusionKeys);
  Kinematics kinematics(model_);
  kinematics.update(scene_.joints, {Pose::Identity()});
  Body links;
  Body things = bodyOf(simulation_.simulator().world());
  std::vector<std::uint32_t> link_of_shape;
  for (std::size_t shape = 0; shape < model_->shapes().size(); ++shape) {
    const LinkShape& described = model_->shapes()[shape];
    const auto drawn = std::find(used.shapes.begin(), used.shapes.end(), shape);
    if (drawn == used.shapes.end() && config_.robot == Robot::kAway) continue;
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
  config.resolution_rad = config_.resolution_rad;
  config.margin_m = pose.occlusion.margin_m;
  return TrueVisibility(config).find(laserOrigin(model_, TiltMotion().mean_rad), links,
                                     link_of_shape, things);
}

VisibilityTrial::Result VisibilityTrial::run() {
  waitForMap();
  std::vector<std::string> joints;
  for (const JointVariable& variable : model_->variables()) joints.push_back(variable.name);
  const Checker::StateAnswer answer = simulation_.monitor().checker().checkState(
      simulation_.simulator().now(), joints, scene_.joints);
  const std::vector<TrueLinkVisibility> links = truth();
  for (const LinkVisibility& found : answer.findings.links) {
    const auto real = std::find_if(links.begin(), links.end(),
                                   [&found](const auto& link) { return link.link == found.link; });
    if (real == links.end()) continue;
    result_.links.push_back({model_->links()[found.link], found.silhouette, real->in_range,
                             real->visible_fraction, found.visible_fraction,
                             found.occluded_fraction, found.unseen_fraction});
  }
  return result_;
}

}  // namespace tccm::simulation
