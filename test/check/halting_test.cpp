#include "check/halting.h"

#include <gtest/gtest.h>

#include "support/random.h"

namespace tccm {
namespace {

const Halting kHalting{0.5, 0.3, 0.1, 0.02, 2.0};

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
    const double time_s = random.uniform(0.0, 0.6), speed = random.uniform(0.0, 3.0);
    const double sooner = random.uniform(0.0, time_s), faster = speed * random.uniform(1.0, 3.0);
    EXPECT_LE(kHalting.scale(sooner, faster), kHalting.scale(time_s, speed));
    EXPECT_GE(kHalting.haltTime(faster), kHalting.haltTime(speed));
    EXPECT_GE(kHalting.lookTime(faster), kHalting.lookTime(speed));
    EXPECT_LE(kHalting.scaleWithin(0.3, faster), kHalting.scaleWithin(0.3, speed));
  }
}

}  // namespace
}  // namespace tccm
