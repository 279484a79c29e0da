#include "experiments/governed_trial.h"

#include <gtest/gtest.h>

#include "experiments/reaching_about.h"
#include "simulation/robot/dual_arm.h"
#include "support/trial_config.h"

namespace tccm::simulation {
namespace {

/// What nothing governs but the speed that is commanded.
GovernedTrial::Result reachingAt(double speed_mps) {
  GovernedTrial::Config config = test::trialConfig<GovernedTrial>();
  config.motion = kReachingAbout;
  config.speed_mps = speed_mps;
  return GovernedTrial(config, dualArm(), 1).run();
}

TEST(GovernedTrialTest, AFastArmRunsIntoWhatAppears) {
  const GovernedTrial::Result result = reachingAt(0.4);
  EXPECT_GT(result.cases, 1000U);
  EXPECT_GT(result.violations, 100U);
  EXPECT_GT(result.worst.way_m, 0.2);
  EXPECT_GT(result.reached, 50U);
  EXPECT_GT(result.way_m / result.permitted_s, 0.1);
}

TEST(GovernedTrialTest, ASlowerArmDoesSoMoreSeldom) {
  const GovernedTrial::Result fast = reachingAt(0.4);
  const GovernedTrial::Result slow = reachingAt(0.05);
  EXPECT_LT(slow.violations * fast.cases, fast.violations * slow.cases / 2);
  EXPECT_LT(slow.worst.way_m, fast.worst.way_m);
  EXPECT_LT(slow.reached, fast.reached / 2);
}

TEST(GovernedTrialTest, TheSameSeedGivesTheSame) {
  const GovernedTrial::Result once = reachingAt(0.2);
  const GovernedTrial::Result again = reachingAt(0.2);
  EXPECT_EQ(once.worst.way_m, again.worst.way_m);
  EXPECT_EQ(once.violations, again.violations);
  EXPECT_EQ(once.way_m, again.way_m);
}

TEST(GovernedTrialTest, ADistanceThatIsNoneIsRefused) {
  GovernedTrial::Config config;
  config.distance_m = 0.0;
  EXPECT_ANY_THROW(GovernedTrial(config, dualArm(), 1));
}

}  // namespace
}  // namespace tccm::simulation
