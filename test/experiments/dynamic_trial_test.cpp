#include "experiments/dynamic_trial.h"

#include <gtest/gtest.h>

#include "simulation/robot/dual_arm.h"
#include "support/trial_config.h"

namespace tccm::simulation {
namespace {

DynamicTrial::Config brief() {
  DynamicTrial::Config config = test::trialConfig<DynamicTrial>();
  config.judge_s = 2.0;
  return config;
}

TEST(DynamicTrialTest, ACuboidIsWhatMostOfItsReturnsComeFrom) {
  EXPECT_EQ(sourceOf(ReturnSources{3, 0, 9}), CuboidSource::kStanding);
  EXPECT_EQ(sourceOf(ReturnSources{1, 2, 0}), CuboidSource::kMoving);
  EXPECT_EQ(sourceOf(ReturnSources{2, 2, 0}), CuboidSource::kBoth);
  EXPECT_EQ(sourceOf(ReturnSources{0, 0, 4}), CuboidSource::kMixed);
}

TEST(DynamicTrialTest, ATallyGivesRecallPrecisionAndWhatMovesAndIsCalledStatic) {
  DynamicTally tally;
  for (int i = 0; i < 9; ++i) tally.add(CuboidSource::kStanding, true);
  tally.add(CuboidSource::kStanding, false);
  tally.add(CuboidSource::kMoving, true);
  for (int i = 0; i < 3; ++i) tally.add(CuboidSource::kMoving, false);
  tally.add(CuboidSource::kBoth, true);
  tally.add(CuboidSource::kMixed, true);
  EXPECT_DOUBLE_EQ(tally.staticRecall(), 0.9);
  EXPECT_DOUBLE_EQ(tally.staticPrecision(), 0.9);
  EXPECT_DOUBLE_EQ(tally.movingStatic(), 0.25);
}

TEST(DynamicTrialTest, WhatStandsIsStaticAndWhatMovesIsNot) {
  for (const char* scene : {"paper", "box"}) {
    DynamicTally tally;
    for (std::uint64_t seed = 1; seed <= 2; ++seed) {
      tally.add(DynamicTrial(brief(), scene, dualArm(), seed).run().tally);
    }
    EXPECT_GT(tally.standing, 5000U) << scene;
    EXPECT_GT(tally.moving, 200U) << scene;
    EXPECT_GT(tally.staticRecall(), 0.92) << scene;
    EXPECT_LT(tally.movingStatic(), 0.08) << scene;
  }
}

TEST(DynamicTrialTest, TheSameSeedGivesTheSame) {
  DynamicTrial::Config config = brief();
  config.settle_s = 1.0;
  const DynamicTrial::Result result = DynamicTrial(config, "paper", dualArm(), 5).run();
  const DynamicTrial::Result again = DynamicTrial(config, "paper", dualArm(), 5).run();
  EXPECT_EQ(again.tally.standing_static, result.tally.standing_static);
  EXPECT_EQ(again.tally.moving_static, result.tally.moving_static);
}

TEST(DynamicTrialTest, AnUnknownSceneIsRefused) { EXPECT_ANY_THROW((void)dynamicScene("cat", 1)); }

}  // namespace
}  // namespace tccm::simulation
