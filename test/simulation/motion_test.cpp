#include "simulation/motion.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "simulation/arm_path.h"
#include "simulation/robot/dual_arm.h"

namespace tccm::simulation {
namespace {

constexpr Duration kStep = std::chrono::milliseconds(1);

TEST(TiltMotionTest, Covers15To75DegreesDownInOnePeriodOf1575Ms) {
  const TiltMotion tilt;
  double lowest = 10.0;
  double highest = -10.0;
  for (int ms = 0; ms <= 1575; ++ms) {
    lowest = std::min(lowest, tilt.position(ms * kStep));
    highest = std::max(highest, tilt.position(ms * kStep));
  }
  EXPECT_NEAR(lowest, 15.0 * M_PI / 180.0, 1e-4);
  EXPECT_NEAR(highest, 75.0 * M_PI / 180.0, 1e-4);
  EXPECT_NEAR(tilt.position(1575 * kStep), tilt.position(Duration::zero()), 1e-9);
}

TEST(TiltMotionTest, VelocityIsTheDerivativeOfPosition) {
  const TiltMotion tilt;
  for (int ms = 0; ms < 1575; ms += 37) {
    const double slope = (tilt.position((ms + 1) * kStep) - tilt.position((ms - 1) * kStep)) / 2e-3;
    EXPECT_NEAR(tilt.velocity(ms * kStep), slope, 1e-4);
  }
}

/// 0.3 m of 2 m behind it.
PathController onItsWay(Time& now, const PathController::Config& config = {}) {
  PathController controller(config, 2.0);
  while (controller.distance() < 0.3) controller.step(now += kStep, false);
  return controller;
}

TEST(PathControllerTest, BrakesWithinLatencyAndDeceleration) {
  for (const double speed : {0.1, 0.25, 0.4}) {
    PathController::Config config;
    config.speed_mps = speed;
    PathController controller(config, 1.0);
    Time now{};
    while (controller.distance() < 0.3) controller.step(now += kStep, false);
    ASSERT_NEAR(controller.speed(), speed, 1e-9);
    const double before = controller.distance();
    const Time asserted = now + kStep;
    while (controller.speed() > 0.0) controller.step(now += kStep, true);
    EXPECT_NEAR(controller.distance() - before, 0.02 * speed + speed * speed / 4.0, 1e-3);
    EXPECT_NEAR(toSeconds(now - asserted), 0.02 + speed / 2.0, 2e-3);
    const double rest = controller.distance();
    for (int i = 0; i < 5000; ++i) controller.step(now += kStep, true);
    EXPECT_EQ(controller.distance(), rest);
  }
}

TEST(PathControllerTest, GoesOutAndBackWithinItsSpeedAndAcceleration) {
  const PathController::Config config;
  PathController controller(config, 0.4);
  Time now{};
  controller.step(now, false);
  double last = 0.0;
  int turns = 0;
  bool outbound = true;
  for (int i = 0; i < 20000; ++i) {
    controller.step(now += kStep, false);
    EXPECT_LE(std::abs(controller.speed()), config.speed_mps);
    EXPECT_LE(std::abs(controller.speed() - last), 0.005);
    last = controller.speed();
    turns += controller.outbound() != outbound ? 1 : 0;
    outbound = controller.outbound();
  }
  EXPECT_GE(turns, 8);
}

TEST(PathControllerTest, SetsOffSlowlyAndOnlyAfterRelease) {
  const PathController::Config config;
  PathController controller(config, 1.0);
  Time now{};
  while (controller.distance() < 0.3) controller.step(now += kStep, false);
  for (int i = 0; i < 1000; ++i) controller.step(now += kStep, true);
  for (int i = 0; i < 290; ++i) controller.step(now += kStep, false);
  EXPECT_EQ(controller.speed(), 0.0);
  for (int i = 0; i < 1010; ++i) controller.step(now += kStep, false);
  EXPECT_NEAR(controller.speed(), config.resume_mps2 * 1.0, 0.01);
}

TEST(PathControllerTest, ASpeedScaleTakesEffectAfterTheLatencyWithTheAccelerationOfBraking) {
  PathController::Config config;
  config.speed_mps = 0.4;
  Time now{};
  PathController controller = onItsWay(now, config);
  controller.setSpeedScale(0.25);
  for (int i = 0; i < 20; ++i) controller.step(now += kStep, false);
  EXPECT_NEAR(controller.speed(), 0.4, 1e-9);
  for (int i = 0; i < 75; ++i) controller.step(now += kStep, false);
  EXPECT_NEAR(controller.speed(), 0.25, 1e-9);
  for (int i = 0; i < 500; ++i) controller.step(now += kStep, false);
  EXPECT_NEAR(controller.speed(), 0.1, 1e-9);
  controller.setSpeedScale(1.0);
  for (int i = 0; i < 20 + 100; ++i) controller.step(now += kStep, false);
  EXPECT_NEAR(controller.speed(), 0.3, 1e-9);
  for (int i = 0; i < 500; ++i) controller.step(now += kStep, false);
  EXPECT_NEAR(controller.speed(), 0.4, 1e-9);
}

TEST(PathControllerTest, AtASpeedScaleOf0TheHandStandsAndAStopOutweighsAnyScale) {
  Time now{};
  PathController controller = onItsWay(now);
  controller.setSpeedScale(0.0);
  for (int i = 0; i < 1000; ++i) controller.step(now += kStep, false);
  const double rest = controller.distance();
  for (int i = 0; i < 1000; ++i) controller.step(now += kStep, false);
  EXPECT_EQ(controller.distance(), rest);
  EXPECT_EQ(controller.speed(), 0.0);
  controller.setSpeedScale(1.0);
  for (int i = 0; i < 1000; ++i) controller.step(now += kStep, true);
  EXPECT_EQ(controller.distance(), rest);
}

TEST(PathControllerTest, AHandThatMayHardlyMoveAfterAStopGoesNoFasterThanItsScale) {
  Time now{};
  PathController controller = onItsWay(now);
  controller.setSpeedScale(0.2);
  for (int i = 0; i < 500; ++i) controller.step(now += kStep, true);
  for (int i = 0; i < 3000; ++i) {
    controller.step(now += kStep, false);
    ASSERT_LE(controller.speed(), 0.05 + 1e-9);
  }
  EXPECT_NEAR(controller.speed(), 0.05, 1e-9);
}

TEST(PathControllerTest, InStagesTheHandWaitsAtEachEndAndStaysAtTheLast) {
  PathController::Config config;
  config.stages = {{0.0, 0.1, 1.0}, {0.3, 0.25, 2.0}, {0.4, 0.1, 0.0}};
  PathController controller(config, 0.5);
  Time now{};
  controller.step(now, false);
  const auto goOn = [&](int ms) {
    double fastest = 0.0;
    for (int i = 0; i < ms; ++i) {
      controller.step(now += kStep, false);
      fastest = std::max(fastest, controller.speed());
    }
    return fastest;
  };
  EXPECT_EQ(goOn(990), 0.0);
  EXPECT_EQ(controller.stagesDone(), 0U);
  EXPECT_NEAR(goOn(1700), 0.25, 1e-9);
  EXPECT_NEAR(controller.distance(), 0.3, 1e-5);
  EXPECT_EQ(controller.stagesDone(), 1U);
  EXPECT_EQ(goOn(1400), 0.0);
  EXPECT_NEAR(goOn(2000), 0.1, 1e-9);
  EXPECT_EQ(controller.stagesDone(), 3U);
  EXPECT_NEAR(controller.distance(), 0.4, 1e-5);
  EXPECT_EQ(goOn(2000), 0.0);
}

TEST(PathControllerTest, AStopHoldsTheHandBetweenStagesToo) {
  PathController::Config config;
  config.stages = {{0.1, 0.1, 0.5}, {0.4, 0.1, 0.0}};
  PathController controller(config, 0.5);
  Time now{};
  for (int i = 0; i < 1300; ++i) controller.step(now += kStep, false);
  for (int i = 0; i < 3000; ++i) controller.step(now += kStep, true);
  EXPECT_NEAR(controller.distance(), 0.1, 1e-5);
}

TEST(PathControllerTest, StagesThatLeadBackAreRefused) {
  PathController::Config config;
  config.stages = {{0.3, 0.1, 1.0}, {0.2, 0.25, 2.0}};
  EXPECT_ANY_THROW(PathController(config, 0.5));
}

TEST(ArmPathTest, ReachMovesThePalmForwardByTheLengthItStates) {
  const auto model = dualArm();
  const ArmPath path = armPath(model, "reach");
  Kinematics kinematics(model);
  const std::size_t palm = linkIndex(*model, "right_palm_link");
  kinematics.update(path.positions(0.0), {Pose::Identity()});
  const Vector3 start = kinematics.linkPoses()[palm].translation();
  kinematics.update(path.positions(path.length()), {Pose::Identity()});
  const Vector3 end = kinematics.linkPoses()[palm].translation();
  EXPECT_NEAR((end - start).norm(), path.length(), 1e-3);
  EXPECT_NEAR((end - start).x(), 0.46, 1e-3);
}

TEST(ArmPathTest, SlopesAreTheDerivativesOfPositionsAndTheHandKeepsItsPace) {
  const auto model = dualArm();
  constexpr double kWay = 1e-4;
  for (const std::string& name : motionNames()) {
    const ArmPath path = armPath(model, name);
    Kinematics kinematics(model);
    const std::size_t palm = linkIndex(*model, "right_palm_link");
    for (double s = 0.01; s < path.length() - 0.01; s += 0.007) {
      const auto before = path.positions(s - kWay);
      const auto after = path.positions(s + kWay);
      const auto slopes = path.slopes(s);
      for (std::size_t j = 0; j < slopes.size(); ++j) {
        EXPECT_NEAR(slopes[j], (after[j] - before[j]) / (2.0 * kWay), 1e-2) << name << " " << j;
      }
      kinematics.update(before, {Pose::Identity()});
      const Vector3 from = kinematics.linkPoses()[palm].translation();
      kinematics.update(after, {Pose::Identity()});
      const double way = (kinematics.linkPoses()[palm].translation() - from).norm();
      EXPECT_NEAR(way / (2.0 * kWay), 1.0, 0.05) << name << " at " << s;
    }
  }
}

TEST(ArmPathTest, AnUnknownMotionIsRefused) { EXPECT_ANY_THROW((void)armPath(dualArm(), "dance")); }

}  // namespace
}  // namespace tccm::simulation
