#include "simulation/wander.h"

#include <gtest/gtest.h>

#include "simulation/clearance.h"
#include "simulation/robot/dual_arm.h"
#include "tccm_monitor/config_error.h"

namespace tccm::simulation {
namespace {

bool isArm(const std::string& link) {
  return link.compare(0, 5, "left_") == 0 || link.compare(0, 6, "right_") == 0;
}

SampledBody armsAt(const std::shared_ptr<const RobotModel>& model,
                   const std::vector<double>& joints) {
  Kinematics kinematics(model);
  kinematics.update(joints, {Pose::Identity()});
  Body arms;
  for (std::size_t i = 0; i < model->shapes().size(); ++i) {
    if (!isArm(model->linkOf(i))) continue;
    arms.shapes.push_back(model->shapes()[i].shape);
    arms.poses.push_back(kinematics.shapePoses()[i]);
  }
  return {arms, 0.02};
}

SampledBody withoutFloor(const World& world) {
  Body body;
  for (const SceneObject& object : world) {
    if (object.name == "floor") continue;
    body.shapes.push_back(object.shape);
    body.poses.push_back(object.T_fixed_shape);
  }
  return {body, 0.02};
}

TEST(WanderTest, ArmsKeepClearOfTheSceneAlsoHalfASecondAhead) {
  const auto model = dualArm();
  const World world = scene("table");
  const SampledBody table = withoutFloor(world);
  WanderConfig config;
  config.length_m = 6.0;
  const ArmPath path = wanderPath(model, world, config);
  EXPECT_GE(path.length(), 5.5);
  for (double s = 0.0; s < path.length(); s += 0.2) {
    const std::vector<double> here = path.positions(s);
    const std::vector<double> slopes = path.slopes(s);
    for (const double ahead_s : {-config.horizon_s, 0.0, config.horizon_s}) {
      std::vector<double> joints = here;
      for (std::size_t j = 0; j < joints.size(); ++j) {
        joints[j] += ahead_s * config.speed_mps * slopes[j];
      }
      EXPECT_GT(clearance(armsAt(model, joints), table), config.clearance_m - 0.02) << s;
    }
  }
}

TEST(WanderTest, JointsStayWithinTheirLimits) {
  const auto model = dualArm();
  WanderConfig config;
  config.length_m = 6.0;
  const ArmPath path = wanderPath(model, scene("empty"), config);
  for (double s = 0.0; s < path.length(); s += 0.05) {
    const std::vector<double> joints = path.positions(s);
    for (std::size_t j = 0; j < joints.size(); ++j) {
      EXPECT_GE(joints[j], *model->variables()[j].lower);
      EXPECT_LE(joints[j], *model->variables()[j].upper);
    }
  }
}

TEST(WanderTest, ASceneThatFillsTheSpaceLeavesNoWay) {
  const World block = {{"block", Box{Vector3(2.0, 2.0, 2.0)}, at(0.0, 0.0, 1.0), {}}};
  EXPECT_THROW(wanderPath(dualArm(), block, {}), ConfigError);
}

}  // namespace
}  // namespace tccm::simulation
