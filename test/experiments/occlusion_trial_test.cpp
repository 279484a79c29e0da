#include "experiments/occlusion_trial.h"

#include <gtest/gtest.h>

#include "simulation/robot/dual_arm.h"
#include "support/trial_config.h"
#include "tccm_monitor/config_error.h"

namespace tccm::simulation {
namespace {

OcclusionTrial::Config watching() {
  OcclusionTrial::Config config = test::watchingTrialConfig<OcclusionTrial>();
  config.resolution_rad = 0.02;
  return config;
}

TEST(OcclusionTrialTest, WhatAnOccluderHidesIsFoundWithinATiltAndNothingElseWithout) {
  std::size_t hidden = 0;
  std::size_t without = 0;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    const OcclusionTrial::Result result = OcclusionTrial(watching(), dualArm(), seed).run();
    if (result.obstacle == "none") {
      ++without;
      EXPECT_FALSE(result.link) << seed;
      EXPECT_FALSE(result.false_flag) << seed;
      EXPECT_FALSE(result.beam_s) << seed;
    }
    if (!result.link) continue;
    ++hidden;
    EXPECT_GT(result.link->hidden, 0.2) << seed;
    ASSERT_TRUE(result.link->found_s) << seed << ": " << result.link->hidden;
    ASSERT_TRUE(result.beam_s) << seed;
    EXPECT_GT(*result.link->found_s, *result.beam_s) << seed;
    EXPECT_LT(*result.link->found_s, 1.65) << seed;
  }
  EXPECT_GT(hidden, 2U);
  EXPECT_GT(without, 0U);
}

TEST(OcclusionTrialTest, AMonitorThatTakesNothingForHiddenMissesIt) {
  OcclusionTrial::Config blind = watching();
  blind.monitor.checker.pose.occlusion.silhouette_min_pixels = 1000.0;
  std::size_t missed = 0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const OcclusionTrial::Result result = OcclusionTrial(blind, dualArm(), seed).run();
    if (result.link && !result.link->found_s) ++missed;
  }
  EXPECT_GT(missed, 0U);
}

TEST(OcclusionTrialTest, WhatIsBroughtInIsFoundAndWhatMakesNoSenseIsRefused) {
  OcclusionTrial::Config config = watching();
  config.obstacle_speed_mps = 0.3;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const OcclusionTrial::Result result = OcclusionTrial(config, dualArm(), seed).run();
    if (!result.link) continue;
    EXPECT_TRUE(result.link->found_s) << seed;
  }
  config.hidden_min = 1.5;
  EXPECT_THROW(OcclusionTrial(config, dualArm(), 1), ConfigError);
}

}  // namespace
}  // namespace tccm::simulation
