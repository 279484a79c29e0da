#include "ros/controller_parameters.h"

#include <gtest/gtest.h>

#include "simulation/robot/dual_arm.h"
#include "support/error_of.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

const char kJoints[] = "joints: [left_elbow_joint, right_elbow_joint]\n";

ControllerParameters read(const std::string& text) {
  return ControllerParameters::from(YAML::Load(text), "arm", *simulation::dualArm());
}

TEST(ControllerParametersTest, WhatIsNotThereIsAsTheControllerHasItByDefault) {
  const ControllerParameters parameters = read(kJoints);
  EXPECT_EQ(parameters.stop_duration_s, 0.0);
  EXPECT_FALSE(parameters.rules.allow_partial_joints_goal);
  EXPECT_EQ(parameters.rules.turn_freely, (std::vector<bool>{false, false}));
  const GoalTolerances& tolerances = parameters.rules.tolerances;
  ASSERT_EQ(tolerances.path.size(), 2U);
  ASSERT_EQ(tolerances.end.size(), 2U);
  EXPECT_EQ(tolerances.path[0].position, 0.0);
  EXPECT_EQ(tolerances.end[1].position, 0.0);
  EXPECT_EQ(tolerances.end[1].velocity, 0.01);
  EXPECT_EQ(tolerances.end_time_s, 0.0);
}

TEST(ControllerParametersTest, ConstraintsAreReadJointByJoint) {
  const ControllerParameters parameters = read(
      "type: position_controllers/JointTrajectoryController\n"
      "joints: [left_elbow_joint, right_elbow_joint]\n"
      "stop_trajectory_duration: 1\n"
      "allow_partial_joints_goal: true\n"
      "constraints:\n"
      "  goal_time: 0.6\n"
      "  stopped_velocity_tolerance: 0.05\n"
      "  right_elbow_joint: {trajectory: 0.1, goal: 0.2}\n"
      "  nobody: {trajectory: 0.3}\n");
  EXPECT_EQ(parameters.stop_duration_s, 1.0);
  EXPECT_TRUE(parameters.rules.allow_partial_joints_goal);
  const GoalTolerances& tolerances = parameters.rules.tolerances;
  EXPECT_EQ(tolerances.end_time_s, 0.6);
  EXPECT_EQ(tolerances.path[0].position, 0.0);
  EXPECT_EQ(tolerances.path[1].position, 0.1);
  EXPECT_EQ(tolerances.path[1].velocity, 0.0);
  EXPECT_EQ(tolerances.end[0].position, 0.0);
  EXPECT_EQ(tolerances.end[1].position, 0.2);
  EXPECT_EQ(tolerances.end[0].velocity, 0.05);
}

TEST(ControllerParametersTest, WhatCannotBeMeantIsRefusedByItsKey) {
  const std::string joints = kJoints;
  for (const auto& [text, key] : std::vector<std::pair<std::string, std::string>>{
           {"", "arm/joints"},
           {"joints: []", "arm/joints"},
           {"joints: left_elbow_joint", "arm/joints"},
           {"joints: [left_elbow_joint, left_elbow_joint]", "arm/joints"},
           {"joints: [no_joint]", "arm/joints"},
           {joints + "stop_trajectory_duration: -1", "arm/stop_trajectory_duration"},
           {joints + "stop_trajectory_duration: long", "arm/stop_trajectory_duration"},
           {joints + "allow_partial_joints_goal: 3", "arm/allow_partial_joints_goal"},
           {joints + "constraints: 1", "arm/constraints"},
           {joints + "constraints: {left_elbow_joint: 0.1}", "arm/constraints/left_elbow_joint"},
           {joints + "constraints: {goal_time: .nan}", "arm/constraints/goal_time"},
           {joints + "constraints: {left_elbow_joint: {goal: -0.1}}",
            "arm/constraints/left_elbow_joint/goal"}}) {
    const std::string error = test::errorOf([&text = text] { static_cast<void>(read(text)); });
    EXPECT_EQ(error.find(key + ":"), 0U) << text << ": " << error;
  }
}

}  // namespace
}  // namespace tccm
