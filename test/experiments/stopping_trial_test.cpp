#include "experiments/stopping_trial.h"

#include <gtest/gtest.h>

#include "simulation/robot/dual_arm.h"
#include "support/trial_config.h"
#include "tccm_monitor/config_error.h"

namespace tccm::simulation {
namespace {

StoppingTrial::Config reaching(double speed_mps) {
  StoppingTrial::Config config = test::trialConfig<StoppingTrial>();
  config.controller.speed_mps = speed_mps;
  config.controller.resume_mps2 = config.controller.acceleration_mps2;
  return config;
}

StoppingTrial::Result run(const StoppingTrial::Config& config, std::uint64_t seed) {
  return StoppingTrial(config, dualArm(), seed).run();
}

TEST(StoppingTrialTest, ASlowArmStopsBeforeWhatAppearsAndAllThatLeadsToItIsInItsOrder) {
  for (const auto kind : {ObstacleKind::kPole, ObstacleKind::kArm, ObstacleKind::kBox}) {
    StoppingTrial::Config config = reaching(0.1);
    config.obstacle = kind;
    const StoppingTrial::Result result = run(config, 3);
    EXPECT_EQ(result.outcome, Outcome::kStopped);
    EXPECT_EQ(result.reason, "COLLISION_AHEAD");
    ASSERT_TRUE(result.left_m);
    EXPECT_GT(*result.left_m, 0.03);
    EXPECT_LT(*result.left_m, result.gap_m);
    ASSERT_TRUE(result.beam_s && result.way_beam_s && result.support_s && result.stop_s);
    EXPECT_GT(*result.beam_s, 0.0);
    EXPECT_LE(*result.beam_s, *result.way_beam_s);
    EXPECT_LT(*result.way_beam_s, *result.support_s);
    EXPECT_LE(*result.support_s, *result.stop_s);
    EXPECT_FALSE(result.contact_s || result.cause);
    EXPECT_FALSE(result.avoidable_from_beam || result.avoidable_from_support);
  }
}

TEST(StoppingTrialTest, AnArmThatIsNotMonitoredTouchesAndItCouldHaveBeenAvoided) {
  StoppingTrial::Config config = reaching(0.1);
  config.monitor.checker.pose.collision_use.links = {"left_palm_link"};
  const StoppingTrial::Result result = run(config, 3);
  EXPECT_EQ(result.outcome, Outcome::kTouched);
  EXPECT_EQ(result.left_m, 0.0);
  ASSERT_TRUE(result.contact_s && result.due_s);
  EXPECT_NEAR(*result.contact_s, result.gap_m / config.controller.speed_mps, 0.1);
  EXPECT_NEAR(*result.contact_s - *result.due_s, config.monitor.checker.way.stop_time_s, 0.05);
  EXPECT_TRUE(result.avoidable_from_beam);
  EXPECT_TRUE(result.avoidable_from_support);
  EXPECT_EQ(result.cause, StoppingTrial::Cause::kAvoidable);
  EXPECT_FALSE(result.stop_s);
}

TEST(StoppingTrialTest, AnArmThatIsTooFastTouchesWhatNobodyCouldHaveSeenInTime) {
  std::size_t touched = 0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const StoppingTrial::Result result = run(reaching(0.4), seed);
    touched += result.outcome == Outcome::kTouched ? 1 : 0;
    EXPECT_FALSE(result.avoidable_from_support) << seed;
    EXPECT_EQ(result.cause.has_value(), result.outcome == Outcome::kTouched) << seed;
    if (result.cause == StoppingTrial::Cause::kNotLookedAt) {
      EXPECT_FALSE(result.way_beam_s) << seed;
    }
  }
  EXPECT_GT(touched, 0U);
}

TEST(StoppingTrialTest, WhatIsBroughtInIsSeenInTime) {
  StoppingTrial::Config config = reaching(0.25);
  config.obstacle_speed_mps = 0.3;
  EXPECT_EQ(run(config, 5).outcome, Outcome::kStopped);
}

TEST(StoppingTrialTest, TheSameSeedGivesTheSame) {
  const StoppingTrial::Result once = run(reaching(0.25), 9);
  const StoppingTrial::Result again = run(reaching(0.25), 9);
  EXPECT_EQ(once.outcome, again.outcome);
  EXPECT_EQ(once.left_m, again.left_m);
  EXPECT_EQ(once.support_s, again.support_s);
  EXPECT_EQ(once.stop_s, again.stop_s);
  EXPECT_EQ(once.tilt_phase, again.tilt_phase);
}

TEST(StoppingTrialTest, WhatMakesNoSenseIsRefused) {
  StoppingTrial::Config config = reaching(0.1);
  config.obstacle = ObstacleKind::kNone;
  EXPECT_THROW(StoppingTrial(config, dualArm(), 1), ConfigError);
  config = reaching(0.1);
  config.gap_max_m = 0.1;
  EXPECT_THROW(StoppingTrial(config, dualArm(), 1), ConfigError);
}

TEST(StoppingTrialTest, AHandThatReachesForTheArmComesToItAndTheArmsSpeedThenIsKept) {
  for (const double from_rad : {-M_PI_2, -2.6}) {
    StoppingTrial::Config config = reaching(0.25);
    config.obstacle = ObstacleKind::kArm;
    config.obstacle_speed_mps = 1.6;
    config.reaches_from_rad = {from_rad, from_rad};
    const StoppingTrial::Result result = run(config, 5);
    EXPECT_EQ(result.reaches_from_rad, from_rad);
    EXPECT_EQ(result.outcome, Outcome::kTouched);
    ASSERT_TRUE(result.contact_s);
    EXPECT_GT(*result.contact_s, 0.05) << "on its way of 0.4 m, less the sizes of both";
    EXPECT_LT(*result.contact_s, 0.4 / 1.6 + 0.02);
    EXPECT_TRUE(result.cause);
    if (!result.stop_s) {
      EXPECT_NEAR(result.contact_speed_mps, 0.25, 0.01);
    }
  }
}

TEST(StoppingTrialTest, WhatReachesNeedsASpeed) {
  StoppingTrial::Config config = reaching(0.25);
  config.reaches_from_rad = {-1.0, 1.0};
  EXPECT_THROW(run(config, 1), ConfigError);
  config.reaches_from_rad = {1.0, -1.0};
  config.obstacle_speed_mps = 1.0;
  EXPECT_THROW(run(config, 1), ConfigError) << "from more to less";
}

}  // namespace
}  // namespace tccm::simulation
