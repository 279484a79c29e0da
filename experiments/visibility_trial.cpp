#include "experiments/visibility_trial.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "experiments/visibility_scene.h"
#include "simulation/named.h"
#include "simulation/robot/dual_arm.h"
#include "tccm_monitor/config_error.h"

namespace tccm::simulation {
namespace {

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

/// In some scenes the arms hide all else that lies inside the area: here that is no fault.
Monitor::Config settingOf(Monitor::Config monitor) {
  monitor.checker.inputs.self_filter_fraction_max = 1.0;
  return monitor;
}

}  // namespace

VisibilityTrial::Robot visibilityRobot(const std::string& name) {
  return named<VisibilityTrial::Robot>("robot", name, {"in_pose", "away"});
}

void VisibilityTrial::Config::validate() const {
  requireInRange("noise_m", noise_m, 0.0, 0.1);
  requireInRange("clearance_m", clearance_m, 0.0, 0.2);
  requireInRange("resolution_rad", resolution_rad, 1e-3, 0.1);
}

VisibilityTrial::VisibilityTrial(const Config& config, std::shared_ptr<const RobotModel> model,
                                 std::uint64_t seed)
    : config_((config.validate(), config)),
      model_(std::move(model)),
      scene_(visibilityScene(model_, config_.clearance_m, seed)),
      simulation_(settingOf(config_, model_, scene_, seed), settingOf(config_.monitor), model_) {
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

std::vector<TrueLinkVisibility> VisibilityTrial::truth() const {
  return trueVisibility(model_, simulation_.monitor().checker().config().pose, scene_.joints,
                        bodyOf(simulation_.simulator().world()), config_.robot == Robot::kInPose,
                        config_.resolution_rad);
}

VisibilityTrial::Result VisibilityTrial::run() {
  waitForMap();
  std::vector<std::string> joints;
  for (const JointVariable& variable : model_->variables()) joints.push_back(variable.name);
  const StateAnswer answer = simulation_.monitor().checker().checkState(
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
