#include "experiments/reaching_about.h"

#include <gtest/gtest.h>

#include "robot/kinematics.h"
#include "simulation/robot/dual_arm.h"

namespace tccm::simulation {
namespace {

TEST(ReachingAboutTest, ThePalmStaysAheadOfTheRobotForTheLengthAskedFor) {
  const auto model = dualArm();
  const ArmPath path = reachingAbout(model, 5.0, 1);
  EXPECT_GE(path.length(), 5.0);
  Kinematics kinematics(model);
  for (double way = 0.0; way < path.length(); way += 0.01) {
    kinematics.update(path.positions(way), {Pose::Identity()});
    const Vector3 palm = kinematics.linkPoses()[linkIndex(*model, "right_palm_link")].translation();
    EXPECT_GT(palm.x(), 0.4);
    EXPECT_LT(palm.x(), 0.72);
    EXPECT_GT(palm.z(), 0.83);
    EXPECT_LT(palm.z(), 1.12);
  }
}

TEST(ReachingAboutTest, TheSameSeedGivesTheSamePathAndAnotherDoesNot) {
  const auto model = dualArm();
  const ArmPath once = reachingAbout(model, 2.0, 1);
  EXPECT_EQ(once.positions(1.0), reachingAbout(model, 2.0, 1).positions(1.0));
  EXPECT_NE(once.positions(1.0), reachingAbout(model, 2.0, 2).positions(1.0));
}

}  // namespace
}  // namespace tccm::simulation
