#include "simulation/standing_arm.h"

#include <algorithm>
#include <utility>

#include "base/line_of.h"
#include "tccm_monitor/config_error.h"

namespace tccm::simulation {
namespace {

constexpr Duration kStep = std::chrono::milliseconds(1);
constexpr Duration kRobotPeriod = std::chrono::milliseconds(10);

/// Of the model's variables.
std::vector<double> begin(const RobotModel& model, std::map<std::string, double> posture) {
  std::vector<double> positions;
  for (const JointVariable& variable : model.variables()) {
    const auto told = posture.find(variable.name);
    double position =
        variable.lower && variable.upper ? 0.5 * (*variable.lower + *variable.upper) : 0.0;
    if (told != posture.end()) {
      position = told->second;
      requireInRange("posture/" + variable.name, position, variable.lower.value_or(-1e3),
                     variable.upper.value_or(1e3));
      posture.erase(told);
    }
    positions.push_back(position);
  }
  if (posture.empty()) return positions;
  throw ConfigError(
      lineOf("posture: the robot has no joint '%.100s'", posture.begin()->first.c_str()));
}

World floorAt(double height_m) {
  World world = scene("empty");
  for (SceneObject& part : world) part.T_fixed_shape.pretranslate(Vector3(0.0, 0.0, height_m));
  return world;
}

}  // namespace

void StandingArm::Config::validate() const {
  arm.validate();
  camera.validate();
  for (int i = 0; i < 3; ++i) {
    requireInRange("camera", camera_m[i], -10.0, 10.0);
    requireInRange("look_at", look_at_m[i], -10.0, 10.0);
  }
  if ((look_at_m - camera_m).cross(Vector3::UnitZ()).norm() < 1e-3) {
    throw ConfigError("look_at: the camera may not look straight up or down");
  }
  requireInRange("floor_m", floor_m, -10.0, 10.0);
  requireInRange("box_m", box_m, 0.01, 2.0);
}

StandingArm::StandingArm(const Config& config, std::shared_ptr<const RobotModel> model)
    : config_((config.validate(), config)),
      model_(std::move(model)),
      positions_(begin(*model_, config.posture)),
      velocities_(positions_.size(), 0.0),
      arm_(config.arm, model_, positions_, config.start),
      kinematics_(model_),
      mount_{model_->rootFrames().front(),
             lookingAt(config.camera_m, config.look_at_m, Vector3::UnitZ())},
      camera_(config.camera, config.seed),
      world_(floorAt(config.floor_m)),
      bare_(world_.size()),
      now_(config.start),
      next_frame_(config.start) {}

StandingArm::Output StandingArm::step() {
  now_ += kStep;
  arm_.step(now_, positions_, velocities_);
  const bool is_robot_due = (now_ - config_.start) % kRobotPeriod == Duration::zero();
  const bool is_frame_due = now_ >= next_frame_;
  if (!is_robot_due && !is_frame_due) return {};
  kinematics_.update(positions_, {Pose::Identity()});
  Output output;
  if (is_robot_due) {
    output.robot = RobotSample{now_, positions_, velocities_, kinematics_.linkPoses()};
  }
  if (is_frame_due) {
    next_frame_ += fromSeconds(config_.camera.period_s);
    output.cloud = camera_.measure(snapshot());
  }
  return output;
}

Snapshot StandingArm::snapshot() const {
  Snapshot result;
  result.stamp = now_;
  result.T_fixed_sensor = mount_.T_link_sensor;
  for (const LinkShape& shape : model_->shapes()) result.targets.shapes.push_back(shape.shape);
  result.targets.poses = kinematics_.shapePoses();
  for (const SceneObject& object : world_) {
    result.targets.shapes.push_back(object.shape);
    result.targets.poses.push_back(object.T_fixed_shape);
  }
  for (std::size_t i = 0; i < result.targets.shapes.size(); ++i) result.labels.push_back(i);
  return result;
}

void StandingArm::putBox(const Vector3& p_root) {
  world_.push_back({"box", Box{Vector3::Constant(0.5 * config_.box_m)},
                    at(p_root.x(), p_root.y(), p_root.z()), Eigen::Vector3f(0.90F, 0.75F, 0.25F)});
}

void StandingArm::takeBoxes() {
  world_.erase(world_.begin() + static_cast<std::ptrdiff_t>(bare_), world_.end());
}

}  // namespace tccm::simulation
