#include "experiments/robot_part.h"

#include <gtest/gtest.h>

#include "robot/kinematics.h"
#include "simulation/robot/dual_arm.h"

namespace tccm::simulation {
namespace {

TEST(RobotPartTest, ItsShapesAreWhereKinematicsHasThem) {
  const auto model = dualArm();
  Kinematics kinematics(model);
  std::vector<double> joints(model->variables().size(), 0.1);
  kinematics.update(joints, {Pose::Identity()});
  RobotPart palm(model, {"right_palm_link"}, 0.02);
  palm.moveTo(kinematics.linkPoses());
  ASSERT_EQ(palm.body().body().shapes.size(), 1U);
  for (std::size_t i = 0; i < model->shapes().size(); ++i) {
    if (model->linkOf(i) != "right_palm_link") continue;
    EXPECT_TRUE(palm.body().body().poses[0].isApprox(kinematics.shapePoses()[i]));
  }
}

TEST(RobotPartTest, ALinkThatTheRobotLacksIsRefused) {
  EXPECT_ANY_THROW(RobotPart(dualArm(), {"tail_link"}, 0.02));
}

}  // namespace
}  // namespace tccm::simulation
