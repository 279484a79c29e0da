#include "check/halting.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "robot/joint_spline.h"
#include "support/random.h"

namespace tccm {
namespace {

const Halting kHalting{0.5, 0.3, 0.1, 0.02, {2.0, 0.0}};

TEST(BrakingWayTest, AControllerThatHaltsOnASplineGoesAsFarAsItIsTold) {
  for (const double speed : {0.05, 0.25, 1.0}) {
    for (const double duration_s : {0.1, 0.5, 2.0}) {
      JointTrajectory::Point from, back;
      from.positions = back.positions = {0.0};
      from.velocities = {speed};
      back.velocities = {-speed};
      from.accelerations = back.accelerations = {0.0};
      back.time_s = 2.0 * duration_s;
      const JointSpline spline(from, back, 0);
      EXPECT_NEAR(spline.at(duration_s).velocity, 0.0, 1e-12);
      const BrakingWay way{1000.0, duration_s};
      EXPECT_NEAR(speed * way.time(speed), spline.position(duration_s), 1e-12);
    }
  }
}

TEST(BrakingWayTest, TheSpeedForAWayUsesItUpWithTheDelayAndTheBraking) {
  for (const double stop_s : {0.0, 0.1, 0.5}) {
    const BrakingWay braking{2.0, stop_s};
    for (const double way_m : {0.01, 0.15, 1.0}) {
      for (const double time_s : {0.0, 0.1, 0.8, 30.0}) {
        const double v = braking.speedFor(way_m, time_s);
        EXPECT_NEAR(v * time_s + std::max(v * v / 4.0, 0.625 * v * stop_s), way_m, 1e-9);
      }
    }
    EXPECT_EQ(braking.speedFor(0.0, 0.1), 0.0);
    EXPECT_EQ(braking.speedFor(-0.1, 0.1), 0.0);
  }
}

TEST(BrakingWayTest, WhatFallsSoFastGoesTheWay) {
  for (const double stop_s : {0.0, 0.5}) {
    const BrakingWay braking{2.0, stop_s};
    for (const double speed : {0.1, 1.0, 3.0}) {
      EXPECT_NEAR(0.5 * speed / braking.fall(speed), speed * braking.time(speed), 1e-12);
    }
  }
}

TEST(HaltingTest, AWayIsLookedAlongUntilTheHorizonAndAsFarAsBrakingTakes) {
  EXPECT_DOUBLE_EQ(kHalting.lookTime(1.0), 0.5);
  EXPECT_DOUBLE_EQ(2.5 * kHalting.lookTime(2.5), 2.5 * 0.02 + 2.5 * 2.5 / (2.0 * 2.0));
}

TEST(HaltingTest, TheScaleFallsFromTheHorizonToWhereItStops) {
  EXPECT_DOUBLE_EQ(kHalting.haltTime(0.4), 0.42);
  EXPECT_DOUBLE_EQ(kHalting.scale(0.5, 0.4), 1.0);
  EXPECT_NEAR(kHalting.scale(0.46, 0.4), 0.5, 1e-12);
  EXPECT_DOUBLE_EQ(kHalting.scale(0.425, 0.4), 0.1);
  EXPECT_NEAR(kHalting.latest(0.5, 0.4), 0.46, 1e-12);
}

TEST(HaltingTest, WithinWhatIsLookedAlongItHaltsAtTheScale) {
  EXPECT_DOUBLE_EQ(kHalting.scaleWithin(2.0, 1.0), 1.0);
  const double v = 10.0 * kHalting.scaleWithin(2.0, 10.0);
  EXPECT_NEAR(v * 0.02 + v * v / 4.0, 20.0, 1e-9);
}

TEST(HaltingTest, SoonerOrFasterNeverAsksForLess) {
  test::Random random(1);
  for (int i = 0; i < 10000; ++i) {
    Halting halting = kHalting;
    if (i % 2 == 1) halting.way.stop_duration_s = random.uniform(0.0, 1.0);
    const double time_s = random.uniform(0.0, 0.6), speed = random.uniform(0.0, 3.0);
    const double sooner = random.uniform(0.0, time_s), faster = speed * random.uniform(1.0, 3.0);
    EXPECT_LE(halting.scale(sooner, faster), halting.scale(time_s, speed));
    EXPECT_GE(halting.haltTime(faster), halting.haltTime(speed));
    EXPECT_GE(halting.lookTime(faster), halting.lookTime(speed));
    EXPECT_LE(halting.scaleWithin(0.3, faster), halting.scaleWithin(0.3, speed));
  }
}

}  // namespace
}  // namespace tccm
