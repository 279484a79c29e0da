#include "experiments/look_schedule.h"

#include <gtest/gtest.h>

namespace tccm::simulation {
namespace {

/// Looks so wide that no stroke misses.
LookSchedule::Config wide() {
  LookSchedule::Config config;
  config.angle_rad = 0.031;
  return config;
}

TEST(LookScheduleTest, TheMiddleIsLookedAtEveryHalfPeriodATurningPointEveryPeriod) {
  const TiltMotion tilt;
  const LookSchedule middle(wide(), tilt.mean_rad);
  EXPECT_NEAR(middle.longestGap(), 0.5 * tilt.period_s, 0.06);
  const LookSchedule end(wide(), tilt.mean_rad - tilt.amplitude_rad);
  EXPECT_NEAR(end.longestGap(), tilt.period_s, 0.06);
}

TEST(LookScheduleTest, WhereLooksAreNarrowerThanScansAreApartStrokesMiss) {
  LookSchedule::Config config = wide();
  config.angle_rad = 0.01;
  EXPECT_GT(LookSchedule(config, config.tilt.mean_rad).longestGap(), config.tilt.period_s);
}

TEST(LookScheduleTest, APlaceThatIsNeverLookedAtIsRefused) {
  EXPECT_ANY_THROW(LookSchedule(wide(), 0.0));
}

TEST(SafeSpeedTest, WaitingAndBrakingTakeTheWholeDistance) {
  const Braking braking{0.05, 2.0};
  const double v = safeSpeed(0.15, 0.8, braking);
  EXPECT_NEAR(v * 0.85 + v * v / 4.0, 0.15, 1e-12);
  EXPECT_LT(safeSpeed(0.15, 1.6, braking), v);
  EXPECT_EQ(safeSpeed(0.0, 0.8, braking), 0.0);
}

}  // namespace
}  // namespace tccm::simulation
