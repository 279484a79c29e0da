#include "simulation/robot/dual_arm.h"

#include <stdexcept>

#include "robot/kinematics.h"

namespace tccm::simulation {

std::vector<std::string> dualArmCapsuleLinks() {
  return {"*_shoulder_roll_link", "*_shoulder_yaw_link", "*_elbow_link", "*_wrist_yaw_link",
          "*_wrist_roll_link"};
}

std::shared_ptr<const RobotModel> dualArm() {
  RobotModel::Config config;
  config.capsule_links = dualArmCapsuleLinks();
  return std::make_shared<const RobotModel>(dualArmUrdf(), config);
}

std::size_t variableIndex(const RobotModel& model, const std::string& joint) {
  for (std::size_t i = 0; i < model.variables().size(); ++i) {
    if (model.variables()[i].name == joint) return i;
  }
  throw std::out_of_range("no joint " + joint);
}

std::size_t linkIndex(const RobotModel& model, const std::string& link) {
  for (std::size_t i = 0; i < model.links().size(); ++i) {
    if (model.links()[i] == link) return i;
  }
  throw std::out_of_range("no link " + link);
}

Vector3 laserOrigin(const std::shared_ptr<const RobotModel>& model, double tilt_rad) {
  Kinematics kinematics(model);
  std::vector<double> joints(model->variables().size(), 0.0);
  joints[variableIndex(*model, "laser_tilt_joint")] = tilt_rad;
  kinematics.update(joints, {Pose::Identity()});
  return kinematics.linkPoses()[linkIndex(*model, "laser_link")].translation();
}

}  // namespace tccm::simulation
