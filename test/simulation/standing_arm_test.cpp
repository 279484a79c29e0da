#include "simulation/standing_arm.h"

#include <gtest/gtest.h>

#include "simulation/robot/dual_arm.h"
#include "tccm_monitor/config_error.h"

namespace tccm::simulation {
namespace {

StandingArm::Config config() {
  StandingArm::Config config;
  config.arm.controller.rules.joints = {"right_elbow_joint"};
  config.arm.controller.rules.turn_freely = {false};
  config.camera.pinhole = Pinhole::ofWidth(64);
  config.camera_m = {2.0, 0.0, 1.5};
  config.look_at_m = {0.0, 0.0, 0.8};
  return config;
}

/// How many points of its next frame show that target.
std::size_t shown(StandingArm& arm, std::size_t label) {
  for (int i = 0; i < 1000; ++i) {
    const StandingArm::Output output = arm.step();
    if (!output.cloud) continue;
    std::size_t count = 0;
    for (const PointTruth& truth : output.cloud->truth) count += truth.label == label ? 1 : 0;
    return count;
  }
  return 0;
}

TEST(StandingArmTest, TheCameraSeesRobotFloorAndBoxesWhileTheyAreThere) {
  StandingArm arm(config(), dualArm());
  const std::size_t shapes = arm.model().shapes().size();
  const std::size_t floor = shapes, box = shapes + 1;
  std::size_t robot = 0;
  for (std::size_t i = 0; i < shapes; ++i) robot += shown(arm, i);
  EXPECT_GT(robot, 100U);
  EXPECT_GT(shown(arm, floor), 100U);
  EXPECT_EQ(shown(arm, box), 0U);
  arm.putBox({0.9, 0.0, 1.1});
  EXPECT_GT(shown(arm, box), 5U);
  arm.takeBoxes();
  EXPECT_EQ(shown(arm, box), 0U);
}

TEST(StandingArmTest, JointsBeginInTheMiddleOfTheirLimitsOrWhereThePostureHasThem) {
  StandingArm::Config posed = config();
  posed.posture = {{"right_elbow_joint", -0.7}};
  StandingArm arm(posed, dualArm());
  StandingArm::Output output;
  while (!output.robot) output = arm.step();
  for (std::size_t i = 0; i < arm.model().variables().size(); ++i) {
    const JointVariable& variable = arm.model().variables()[i];
    const double position = output.robot->positions[i];
    if (variable.name == "right_elbow_joint") {
      EXPECT_DOUBLE_EQ(position, -0.7);
    } else if (variable.lower && variable.upper) {
      EXPECT_DOUBLE_EQ(position, 0.5 * (*variable.lower + *variable.upper)) << variable.name;
    }
  }
}

TEST(StandingArmTest, WhatCannotBeIsRefused) {
  StandingArm::Config wrong = config();
  wrong.posture = {{"tail_joint", 0.0}};
  EXPECT_THROW(StandingArm(wrong, dualArm()), ConfigError);
  wrong.posture = {{"right_elbow_joint", 100.0}};
  EXPECT_THROW(StandingArm(wrong, dualArm()), ConfigError);
  wrong = config();
  wrong.look_at_m = {2.0, 0.0, 0.0};  // straight down
  EXPECT_THROW(StandingArm(wrong, dualArm()), ConfigError);
}

}  // namespace
}  // namespace tccm::simulation
