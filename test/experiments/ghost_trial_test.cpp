#include "experiments/ghost_trial.h"

#include <gtest/gtest.h>

#include "simulation/robot/dual_arm.h"
#include "support/trial_config.h"

namespace tccm::simulation {
namespace {

GhostTrial::Config shipped() { return test::trialConfig<GhostTrial>(); }

TEST(GhostTrialTest, AHandThatLeftBehindTheArmIsHeldAndGoneTwoTiltsAfterItsPlaceIsInViewAgain) {
  std::size_t held = 0;
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    const GhostTrial::Result result = GhostTrial(shipped(), dualArm(), seed).run();
    EXPECT_GT(result.seen_max, 20U) << seed;
    EXPECT_GT(result.hidden_s, 2.5) << seed;
    EXPECT_EQ(result.left, 0U) << seed;
    ASSERT_TRUE(result.gone_after_s) << seed;
    EXPECT_LE(*result.gone_after_s, 2.0 * 1.575) << seed;
    held += result.held_max;
  }
  EXPECT_GT(held, 0U);
}

TEST(GhostTrialTest, WithoutHoldingNothingIsHeld) {
  GhostTrial::Config config = shipped();
  config.monitor.sensors.front().mapper.hold.longest_s = 0.0;
  const GhostTrial::Result result = GhostTrial(config, dualArm(), 1).run();
  EXPECT_GT(result.seen_max, 20U);
  EXPECT_EQ(result.held_max, 0U);
  EXPECT_EQ(result.left, 0U);
}

TEST(GhostTrialTest, NoiseThatIsNoneIsRefused) {
  GhostTrial::Config config = shipped();
  config.noise_m = -1.0;
  EXPECT_ANY_THROW(GhostTrial(config, dualArm(), 1));
}

}  // namespace
}  // namespace tccm::simulation
