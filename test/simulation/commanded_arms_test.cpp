#include "simulation/commanded_arms.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "simulation/robot/dual_arm.h"
#include "tccm_monitor/config_error.h"

namespace tccm::simulation {
namespace {

constexpr Duration kStep = std::chrono::milliseconds(1);
constexpr char kElbow[] = "right_elbow_joint";

ArmCommand::Point point(double seconds, double position) {
  return {fromSeconds(seconds), {position}, {}};
}
ArmCommand::Point point(double seconds, double position, double velocity) {
  return {fromSeconds(seconds), {position}, {velocity}};
}

class CommandedArmsTest : public ::testing::Test {
 protected:
  CommandedArmsTest()
      : model_(dualArm()),
        elbow_(variableIndex(*model_, kElbow)),
        arms_({}, model_, bent(), now_) {}

  [[nodiscard]] std::vector<double> bent() const {
    std::vector<double> positions(model_->variables().size(), 0.0);
    positions[elbow_] = -1.0;
    return positions;
  }
  [[nodiscard]] std::string command(const std::vector<ArmCommand::Point>& points) {
    return arms_.command({now_, {kElbow}, points});
  }
  void run(double seconds) {
    const Time end = now_ + fromSeconds(seconds);
    while (now_ < end) arms_.step(now_ += kStep);
  }
  [[nodiscard]] double position() const { return arms_.positions()[elbow_]; }
  [[nodiscard]] double velocity() const { return arms_.velocities()[elbow_]; }

  std::shared_ptr<const RobotModel> model_;
  std::size_t elbow_;
  Time now_{std::chrono::seconds(1000)};
  CommandedArms arms_;
};

TEST_F(CommandedArmsTest, HoldWhatTheyBeginWith) {
  run(1.0);
  EXPECT_EQ(arms_.positions(), bent());
  EXPECT_TRUE(arms_.holds());
  EXPECT_FALSE(arms_.moves());
}

TEST_F(CommandedArmsTest, GoStraightWithoutVelocities) {
  EXPECT_EQ(command({point(1.0, -0.8), point(2.0, -1.0)}), "");
  run(0.5);
  EXPECT_NEAR(position(), -0.9, 1e-9);
  EXPECT_NEAR(velocity(), 0.2, 1e-9);
  run(1.0);
  EXPECT_NEAR(position(), -0.9, 1e-9);
  EXPECT_NEAR(velocity(), -0.2, 1e-9);
}

TEST_F(CommandedArmsTest, FollowTheCubicThatPointsWithVelocitiesLieOn) {
  const auto cubic = [](double t) { return -1.0 - 0.1 * t * t * t + 0.3 * t * t; };
  const auto slope = [](double t) { return -0.3 * t * t + 0.6 * t; };
  EXPECT_EQ(command({point(0.7, cubic(0.7), slope(0.7)), point(2.0, cubic(2.0), 0.0)}), "");
  for (double t = 0.1; t < 2.0; t += 0.1) {
    run(0.1);
    EXPECT_NEAR(position(), cubic(t), 1e-9);
    EXPECT_NEAR(velocity(), slope(t), 1e-9);
  }
}

TEST_F(CommandedArmsTest, AreBrakedByAnEmptyCommandAndStay) {
  EXPECT_EQ(command({point(2.0, 0.0)}), "");
  run(1.0);
  const double before = position();
  EXPECT_EQ(command({}), "");
  EXPECT_TRUE(arms_.holds());
  run(0.5 / 6.0 - 0.002);
  EXPECT_TRUE(arms_.moves());
  run(0.004);
  EXPECT_FALSE(arms_.moves());
  EXPECT_NEAR(position() - before, 0.5 * 0.5 * 0.5 / 6.0, 1e-9);
  const double rest = position();
  run(5.0);
  EXPECT_EQ(position(), rest);
}

TEST_F(CommandedArmsTest, AreBrakedWhereACommandEndsInMotion) {
  EXPECT_EQ(command({point(1.0, -0.5)}), "");
  run(1.5);
  EXPECT_TRUE(arms_.holds());
  EXPECT_FALSE(arms_.moves());
  EXPECT_NEAR(position(), -0.5 + 0.5 * 0.5 * 0.5 / 6.0, 1e-9);
}

TEST_F(CommandedArmsTest, ANewCommandReplacesTheOneBeforeFromWhereTheyAre) {
  EXPECT_EQ(command({point(1.0, 0.0)}), "");
  run(0.5);
  EXPECT_EQ(command({point(1.0, -1.0)}), "");
  double last = position();
  for (int i = 0; i < 1000; ++i) {
    run(0.001);
    EXPECT_LE(std::abs(position() - last), 0.6e-3);
    last = position();
  }
  EXPECT_NEAR(position(), -1.0, 1e-9);
}

TEST_F(CommandedArmsTest, FollowSetpointsThatComeOneByOne) {
  const auto wanted = [](double t) { return -1.0 + 0.3 * std::sin(t); };
  double t = 0.0;
  for (int i = 0; i < 1000; ++i, t += 0.005) {
    const double ahead = t + 0.04;
    ASSERT_EQ(command({point(0.04, wanted(ahead), 0.3 * std::cos(ahead))}), "");
    run(0.005);
    if (t > 1.0) {
      EXPECT_NEAR(position(), wanted(t + 0.005), 1e-4);
    }
  }
}

TEST_F(CommandedArmsTest, JointsThatACommandLeavesOutAreBraked) {
  EXPECT_EQ(command({point(2.0, 0.0)}), "");
  run(0.5);
  EXPECT_EQ(arms_.command({now_, {"left_elbow_joint"}, {point(1.0, -0.5)}}), "");
  run(1.0);
  EXPECT_EQ(velocity(), 0.0);
  EXPECT_NEAR(position(), -0.75 + 0.5 * 0.5 * 0.5 / 6.0, 1e-9);
}

TEST_F(CommandedArmsTest, WhatCannotBeDoneIsNotTakenAndTheOneBeforeGoesOn) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(command({point(1.0, 0.0)}), "");
  run(0.1);
  EXPECT_NE(command({point(1.0, nan)}), "");
  EXPECT_NE(command({point(1.0, 0.0, nan)}), "");
  EXPECT_NE(command({point(1.0, 0.0), point(1.0, 0.0)}), "");
  EXPECT_NE(command({point(-1.0, 0.0)}), "");
  EXPECT_NE(command({point(0.0, 0.0)}), "");
  for (const std::string joint : {"laser_tilt_joint", "torso_yaw_joint", "no_joint"}) {
    EXPECT_NE(arms_.command({now_, {joint}, {point(1.0, 0.0)}}), "") << joint;
  }
  EXPECT_NE(arms_.command({now_, {kElbow, kElbow}, {point(1.0, 0.0)}}), "");
  run(0.4);
  EXPECT_NEAR(position(), -0.5, 1e-9);
}

TEST_F(CommandedArmsTest, PointsThatHavePassedDoNotCount) {
  const ArmCommand late{now_ - fromSeconds(1.0), {kElbow}, {point(0.5, -2.0), point(2.0, -0.5)}};
  EXPECT_EQ(arms_.command(late), "");
  run(0.5);
  EXPECT_NEAR(position(), -0.75, 1e-9);
}

TEST_F(CommandedArmsTest, StayWithinTheLimitsOfTheirJoints) {
  EXPECT_EQ(command({point(1.0, 3.0)}), "");
  run(2.0);
  EXPECT_EQ(position(), 0.0);
  EXPECT_FALSE(arms_.moves());
}

ControlledArm::Config controllerOf(const std::vector<std::string>& joints) {
  ControlledArm::Config config;
  config.controller.rules.joints = joints;
  config.controller.stop_duration_s = 0.2;
  return config;
}

TrajectoryGoal goalTo(const std::string& joint, double position, double seconds) {
  TrajectoryGoal goal;
  goal.trajectory = {{joint}, {{seconds, {position}, {}, {}}}};
  return goal;
}

TEST_F(CommandedArmsTest, ArmsWithControllersObeyTheseAndOthersTheCommand) {
  CommandedArms::Config config;
  config.controlled = {controllerOf({kElbow}), controllerOf({"left_elbow_joint"})};
  arms_ = CommandedArms(config, model_, bent(), now_);
  const std::size_t left = variableIndex(*model_, "left_elbow_joint");
  const std::size_t roll = variableIndex(*model_, "left_wrist_roll_joint");
  EXPECT_NE(command({point(1.0, 0.0)}), "") << "it has a controller";
  EXPECT_TRUE(arms_.holds());
  ASSERT_EQ(arms_.controlled()[0].controller().command(goalTo(kElbow, 0.0, 2.0)), "");
  ASSERT_EQ(arms_.controlled()[1].controller().command(goalTo("left_elbow_joint", -0.5, 1.0)), "");
  ASSERT_EQ(arms_.command({now_, {"left_wrist_roll_joint"}, {point(1.0, 1.0)}}), "");
  EXPECT_FALSE(arms_.holds());
  run(0.5);
  EXPECT_NEAR(position(), -0.75, 1e-9);
  EXPECT_NEAR(arms_.positions()[left], -0.25, 1e-9);
  EXPECT_NEAR(arms_.positions()[roll], 0.5, 1e-9);
  ASSERT_EQ(arms_.command({now_, {}, {}}), "");
  ASSERT_EQ(arms_.controlled()[1].controller().command({}), "");
  EXPECT_FALSE(arms_.holds());
  run(0.3);
  EXPECT_NEAR(position(), -0.6, 1e-9) << "it does not hear what the others are told";
  EXPECT_NEAR(arms_.positions()[left], -0.25 - 0.625 * 0.5 * 0.2, 1e-9);
  EXPECT_EQ(arms_.velocities()[roll], 0.0);
  ASSERT_EQ(arms_.controlled()[0].controller().command({}), "");
  EXPECT_TRUE(arms_.holds());
  EXPECT_TRUE(arms_.moves());
}

TEST_F(CommandedArmsTest, AJointHasOneControllerAtMostAndIsOneOfAnArm) {
  for (const auto& controlled : std::vector<std::vector<ControlledArm::Config>>{
           {controllerOf({kElbow}), controllerOf({kElbow})},
           {controllerOf({"laser_tilt_joint"})},
           {controllerOf({"no_joint"})}}) {
    CommandedArms::Config config;
    config.controlled = controlled;
    EXPECT_THROW(CommandedArms(config, model_, bent(), now_), ConfigError);
  }
}

}  // namespace
}  // namespace tccm::simulation
