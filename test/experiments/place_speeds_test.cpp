#include "experiments/place_speeds.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "simulation/robot/dual_arm.h"
#include "support/trial_config.h"

namespace tccm::simulation {
namespace {

constexpr double kDegree = M_PI / 180.0;

PlaceSpeeds::Config ungoverned() {
  PlaceSpeeds::Config config = test::trialConfig<PlaceSpeeds>();
  config.monitor.checker.evidence.unseen_fraction_max = 1.0;
  config.duration_s = 12.0;
  return config;
}

TEST(PlaceSpeedsTest, WhereNothingGovernsTheCommandedSpeedIsAllowedAtEveryPhase) {
  for (const double tilt_deg : {15.0, 45.0, 75.0}) {
    const PlaceSpeeds::Result result =
        PlaceSpeeds(ungoverned(), dualArm(), tilt_deg * kDegree, 1).run();
    ASSERT_EQ(result.allowed_mps.size(), 12U);
    for (const double allowed : result.allowed_mps) EXPECT_NEAR(allowed, 0.4, 1e-9) << tilt_deg;
    EXPECT_NEAR(result.mean_mps, 0.4, 1e-9);
    EXPECT_GT(result.travelled_mps, 0.2);
    EXPECT_LT(result.travelled_mps, 0.4);
  }
}

TEST(PlaceSpeedsTest, AHandsPartsLieAroundItsPlace) {
  PlaceSpeeds::Config config = ungoverned();
  config.duration_s = 9.5;
  config.links = {"*_palm_link", "*_finger_link"};
  const auto tilts = PlaceSpeeds(config, dualArm(), 45.0 * kDegree, 1).run().part_tilts_rad;
  ASSERT_GE(tilts.size(), 3U) << "of the hand that moves alone";
  ASSERT_LE(tilts.size(), 6U);
  for (const double tilt : tilts) {
    EXPECT_GT(tilt, 35.0 * kDegree) << "fingers are ahead of the palm";
    EXPECT_LT(tilt, 45.0 * kDegree);
  }
  EXPECT_NE(*std::min_element(tilts.begin(), tilts.end()),
            *std::max_element(tilts.begin(), tilts.end()));
}

TEST(PlaceSpeedsTest, ATiltThatLooksLevelOrStraightDownIsRefused) {
  EXPECT_ANY_THROW(PlaceSpeeds(ungoverned(), dualArm(), 1.55, 1));
  EXPECT_ANY_THROW(PlaceSpeeds(ungoverned(), dualArm(), 0.0, 1));
}

}  // namespace
}  // namespace tccm::simulation
