#include "experiments/visibility_trial.h"

#include <gtest/gtest.h>

#include <cmath>

#include "simulation/robot/dual_arm.h"
#include "support/trial_config.h"

namespace tccm::simulation {
namespace {

VisibilityTrial::Config shipped() { return test::watchingTrialConfig<VisibilityTrial>(); }

class VisibilityTrialTest : public ::testing::TestWithParam<VisibilityTrial::Robot> {};

TEST_P(VisibilityTrialTest, LinksInPlainSightAreSeenAndHiddenOnesAreNot) {
  VisibilityTrial::Config config = shipped();
  config.robot = GetParam();
  int plain = 0;
  int hidden = 0;
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    for (const LinkComparison& link : VisibilityTrial(config, dualArm(), seed).run().links) {
      if (link.in_range < 1.0 || link.silhouette_pixels < 2.0) continue;
      if (link.true_fraction == 0.0) {
        EXPECT_LT(link.visible_fraction, 0.1) << seed << " " << link.link;
        ++hidden;
      }
      if (link.true_fraction == 1.0) {
        EXPECT_GT(link.visible_fraction, 0.3) << seed << " " << link.link;
        ++plain;
      }
    }
  }
  EXPECT_GT(plain, 10);
  EXPECT_GT(hidden, 3);
}

INSTANTIATE_TEST_SUITE_P(InPoseAndAway, VisibilityTrialTest,
                         ::testing::Values(VisibilityTrial::Robot::kInPose,
                                           VisibilityTrial::Robot::kAway));

TEST(VisibilityTrialTest, TheSameSeedGivesTheSame) {
  const auto once = VisibilityTrial(shipped(), dualArm(), 3).run();
  const auto again = VisibilityTrial(shipped(), dualArm(), 3).run();
  ASSERT_EQ(once.links.size(), 6U);
  for (std::size_t i = 0; i < once.links.size(); ++i) {
    EXPECT_EQ(once.links[i].visible_fraction, again.links[i].visible_fraction);
    EXPECT_EQ(once.links[i].true_fraction, again.links[i].true_fraction);
  }
}

TEST(VisibilityTrialTest, AnUnknownPlaceForTheRobotIsRefused) {
  EXPECT_EQ(visibilityRobot("in_pose"), VisibilityTrial::Robot::kInPose);
  EXPECT_EQ(visibilityRobot("away"), VisibilityTrial::Robot::kAway);
  EXPECT_ANY_THROW((void)visibilityRobot("elsewhere"));
}

}  // namespace
}  // namespace tccm::simulation
