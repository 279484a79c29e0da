#include <gtest/gtest.h>

#include <algorithm>

#include "check/checker_config.h"
#include "check/pose_check.h"
#include "simulation/robot/dual_arm.h"
#include "support/checked_robot.h"
#include "support/tiny_robot.h"

namespace tccm {
namespace {

using namespace test::urdf_text;

using Links = std::vector<std::string>;

/// Takes in the virtual cuboid, which lies in the middle of the fixed frame.
const PlacedShape kAroundTheCuboid{Sphere{0.1}};

/// Robots differ in where their primitives are, what kind they are and what moves them.
class SelfTestTest : public ::testing::Test {
 protected:
  explicit SelfTestTest(std::shared_ptr<const RobotModel> model = test::sliderModel())
      : model_(std::move(model)) {
    config_.check_occlusion = false;
  }
  /// Of a check in which the shapes of some links may touch what lies in a region.
  Links missed(const Links& exempt = {}, const PlacedShape& region = kAroundTheCuboid) {
    const auto robot = test::checked(model_, config_);
    PoseCheck check(robot, 1.5);
    ExemptRegions regions{{{region, {}}}, {}};
    regions.of_shapes.resize(robot->collision_body.shapes.size());
    for (std::size_t i = 0; i < regions.of_shapes.size(); ++i) {
      const std::string& link = model_->linkOf(robot->collision_body.shapes[i]);
      if (std::find(exempt.begin(), exempt.end(), link) != exempt.end()) regions.of_shapes[i] = {0};
    }
    robot->collision.exempt(regions);
    return selfTest(*robot, check);
  }
  void take(const std::string& urdf, const RobotModel::Config& config = {}) {
    model_ = test::modelOf(urdf, config);
  }

  std::shared_ptr<const RobotModel> model_;
  CheckedRobot::Config config_;
};

TEST_F(SelfTestTest, SmallRobotsPass) {
  EXPECT_EQ(missed(), Links{});
  take(robotOf(ballLink("base")));
  EXPECT_EQ(missed(), Links{}) << "without joints";
}

TEST_F(SelfTestTest, TheDualArmRobotPasses) {
  model_ = simulation::dualArm();
  EXPECT_EQ(missed(), Links{});
  config_.check_occlusion = true;
  EXPECT_EQ(missed(), Links{});
}

TEST_F(SelfTestTest, EveryKindOfPrimitiveHoweverSmallOrFarAwayPasses) {
  RobotModel::Config config;
  config.capsule_links = {"rod"};
  take(robotOf(linkOf("base", collisionOf("<box size=\"0.001 0.002 2\"/>", "5 -7 30")) +
               linkOf("rod", collisionOf("<cylinder radius=\"0.001\" length=\"1\"/>", "0 0 0.5")) +
               linkOf("disc", collisionOf("<cylinder radius=\"0.5\" length=\"0.001\"/>")) +
               linkOf("dust", collisionOf(test::sphereOf("0.0001"))) +
               jointOf("spin", "continuous", "base", "rod", axisOf("1 1 1")) +
               jointOf("weld", "fixed", "rod", "disc", "<origin xyz=\"9 9 9\"/>") +
               jointOf("slide", "prismatic", "disc", "dust", axisOf("1 0 0") + limitOf("7", "9"))),
       config);
  config_.collision_use.expansion = {1.0, 0.0};
  EXPECT_EQ(missed(), Links{});
}

TEST_F(SelfTestTest, ARobotOnSeveralRootsPasses) {
  take(robotOf(ballLink("base") + ballLink("trailer") + ballLink("mast") +
               jointOf("hitch", "planar", "base", "trailer") +
               jointOf("weld", "fixed", "trailer", "mast", "<origin xyz=\"0 0 1\"/>")));
  EXPECT_EQ(missed(), Links{});
  EXPECT_EQ(missed({"mast"}), Links{"mast"});
}

TEST_F(SelfTestTest, WhateverSupportACuboidNeedsItHas) {
  for (const int points : {1, 3, 20}) {
    config_.collision.support_points = points;
    EXPECT_EQ(missed(), Links{}) << points;
  }
}

TEST_F(SelfTestTest, ALinkWhoseContactsAreNotSeenIsNamed) {
  EXPECT_EQ(missed({"hand"}), Links{"hand"});
  EXPECT_EQ(missed({"other"}), Links{"other"});
  EXPECT_EQ(missed({"hand", "other"}).size(), 2U);
}

TEST_F(SelfTestTest, OfTheDualArmRobotEachBlindLinkIsNamedAlone) {
  model_ = simulation::dualArm();
  for (std::size_t i = 0; i < model_->shapes().size(); ++i) {
    const std::string& link = model_->linkOf(i);
    EXPECT_EQ(missed({link}), Links{link});
  }
}

TEST_F(SelfTestTest, ARegionThatLeavesPartOfTheCuboidOutBlindsNobody) {
  EXPECT_EQ(missed({"hand"}, {Box{{0.1, 0.1, 0.009}}}), Links{});
  EXPECT_EQ(missed({"hand"}, {Sphere{0.1}, Pose(Eigen::Translation3d(0.2, 0.0, 0.0))}), Links{});
}

TEST_F(SelfTestTest, ALinkIsNamedOnceAlthoughAllItsPrimitivesAreBlind) {
  take(robotOf(linkOf("base", collisionOf(test::sphereOf("0.05"), "0 0 0") +
                                  collisionOf(test::sphereOf("0.05"), "1 0 0") +
                                  collisionOf(test::sphereOf("0.05"), "2 0 0")) +
               ballLink("hand") + jointOf("weld", "fixed", "base", "hand")));
  EXPECT_EQ(missed({"base"}), Links{"base"});
}

TEST_F(SelfTestTest, OneBlindPrimitiveOfSeveralIsEnough) {
  take(robotOf(linkOf("base", collisionOf(test::sphereOf("0.05"), "0 0 0") +
                                  collisionOf(test::sphereOf("0.05"), "0.01 0 0"))));
  const auto robot = test::checked(model_, config_);
  PoseCheck check(robot, 1.5);
  robot->collision.exempt({{{kAroundTheCuboid, {}}}, {{0}, {}}});
  EXPECT_EQ(selfTest(*robot, check), Links{"base"}) << "its neighbour touches all the same";
}

TEST_F(SelfTestTest, LinksThatAreNotToBeCheckedAreNotAskedFor) {
  config_.collision_use.ignored = {"other"};
  EXPECT_EQ(missed(), Links{});
  EXPECT_EQ(missed({"hand"}), Links{"hand"});
}

/// The check is made for fewer links than are to be checked.
TEST_F(SelfTestTest, ALinkThatTheCheckWasNotMadeForIsNamed) {
  CheckedRobot::Config fewer = config_;
  fewer.collision_use.ignored = {"other"};
  PoseCheck check(test::checked(model_, fewer), 1.5);
  EXPECT_EQ(selfTest(*test::checked(model_, config_), check), Links{"other"});
}

/// Both primitives touch the cuboid wherever the robot is put, and only one contact is listed.
TEST_F(SelfTestTest, WhereTheListOfContactsIsFullALinkIsNotMissed) {
  take(robotOf(ballLink("base") + ballLink("hand") + jointOf("weld", "fixed", "base", "hand")));
  config_.collision.contacts_max = 1;
  EXPECT_EQ(missed(), Links{});
  EXPECT_EQ(missed({"base", "hand"}).size(), 2U);
}

TEST_F(SelfTestTest, ACheckerThatIsMadeHasPassed) {
  Checker::Config config;
  config.pose = config_;
  EXPECT_NO_THROW(Checker(simulation::dualArm(), config));
  EXPECT_NO_THROW(Checker(model_, config));
}

}  // namespace
}  // namespace tccm
