#include "gate/gated_motion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "support/gated_motion_fixture.h"

namespace tccm {
namespace {

using test::GatedMotionTest;
using test::kCycle;
using test::kLookahead;
using test::kPermissionPeriod;
using test::smoothTenRadians;
using test::tenRadians;
using End = GatedMotion::End;

TEST_F(GatedMotionTest, SetsOffGentlyAndReachesTheGoal) {
  setOff();
  run(0.25);  // the scale rises by 4 in a second: half of the time is lost
  EXPECT_NEAR(position(), 0.125 + kLookahead, 1e-6);
  run(1.0);
  EXPECT_NEAR(position(), 1.125 + kLookahead, 1e-6);
  EXPECT_NEAR(velocity(), 1.0, 1e-9);
  run(10.0);
  EXPECT_TRUE(endedOnceWith(End::kReached));
  EXPECT_EQ(position(), 10.0);
  EXPECT_EQ(velocity(), 0.0);
}

TEST_F(GatedMotionTest, SLOWHalvesTheSpeedAndItNeverGoesFasterThanPermitted) {
  setOff();
  run(1.0);
  run(0.1, 0.5);
  const double before = position();
  run(2.0, 0.5);
  EXPECT_NEAR(position() - before, 1.0, 1e-6);
  EXPECT_NEAR(velocity(), 0.5, 1e-9);
  EXPECT_EQ(motion_.scale(), 0.5);
}

TEST_F(GatedMotionTest, TheScaleFallsAtOnceAndRisesNoFasterThanAllowed) {
  setOff();
  run(1.0);
  permit(0.1);
  elapsed_ += kCycle;
  step();
  EXPECT_NEAR(velocity(), 0.1, 1e-9);
  double last = motion_.scale();
  for (int i = 0; i < 100; ++i) {
    elapsed_ += kCycle;
    permit(1.0);
    step();
    EXPECT_LE(motion_.scale() - last, 4.0 * kCycle + 1e-9);
    last = motion_.scale();
  }
  EXPECT_NEAR(last, 1.0, 1e-9);
}

TEST_F(GatedMotionTest, WhereHaltingTakesTimeTheScaleFallsWithinIt) {
  config_.stop_duration_s = 0.5;
  motion_ = GatedMotion(config_);
  setOff();
  run(1.0);
  const double from = elapsed_;
  while (motion_.scale() > 0.101) {
    permit(0.1);
    elapsed_ += kCycle;
    step();
    ASSERT_LT(elapsed_ - from, 0.46);
  }
  EXPECT_NEAR(elapsed_ - from, 0.45, 2.0 * kCycle);
}

TEST_F(GatedMotionTest, SetpointsAreWhereTheJointsAreToBeThenAlsoWhileTheScaleChanges) {
  config_.stop_duration_s = 0.3;
  motion_ = GatedMotion(config_);
  setOff();
  std::vector<double> setpoints, desired, velocities, scales;
  for (int i = 0; i < 400; ++i) {
    elapsed_ += kCycle;
    permit(i < 200 ? 1.0 : 0.2);
    step();
    setpoints.push_back(position());
    velocities.push_back(velocity());
    desired.push_back(motion_.desired().positions[0]);
    scales.push_back(motion_.scale());
  }
  const auto lookahead = static_cast<std::size_t>(std::lround(kLookahead / kCycle));
  for (std::size_t i = 0; i + lookahead < setpoints.size(); ++i) {
    if (i < 200 && i + lookahead >= 200) continue;  // before it is known
    EXPECT_NEAR(setpoints[i], desired[i + lookahead], 1e-3) << i;
    EXPECT_NEAR(velocities[i], scales[i + lookahead], 1e-6) << i;
  }
}

TEST_F(GatedMotionTest, WhatWasToldIsNeverFurtherOffThanAllowed) {
  setOff();
  for (const double scale : {1.0, 0.3, 0.7, 1.0}) {
    for (int i = 0; i < 300; ++i) {
      elapsed_ += kCycle;
      permit(scale);
      step();
      GoalPath::Sample sample;
      GoalPath(told_).at(elapsed_ - told_at_, sample);
      EXPECT_NEAR(sample.positions[0], motion_.desired().positions[0], 0.05 + 1e-6);
    }
  }
  EXPECT_LT(tellings_, 20);
}

TEST_F(GatedMotionTest, ASpeedOfNextToNothingIsNoError) {
  setOff();
  run(1.0);
  run(1.0, 1e-12);
  EXPECT_TRUE(motion_.active());
  EXPECT_LT(told_.points.back().time_s, 1001.0);
}

TEST_F(GatedMotionTest, WhatIsNotPermittedEndsAtOnceWithTheReason) {
  setOff();
  run(1.0);
  permit(0.0);
  step();
  EXPECT_TRUE(endedOnceWith(End::kNotPermitted));
  EXPECT_EQ(text_, "not permitted: COLLISION, told so");
}

TEST_F(GatedMotionTest, SilenceEndsWithinThreePeriods) {
  setOff();
  run(1.0);
  permit();
  run(0.05 - kCycle, -1.0);
  EXPECT_TRUE(motion_.active());
  run(2.0 * kCycle, -1.0);
  EXPECT_TRUE(endedOnceWith(End::kNotPermitted));
}

TEST_F(GatedMotionTest, AClockThatStandsStillEnds) {
  setOff();
  run(1.0);
  permit();
  const Instant last = now();
  for (double wall_s = 0.0; motion_.active() && wall_s < 0.06; wall_s += kCycle) {
    static_cast<void>(
        motion_.step({last.stamp, last.steady + fromSeconds(wall_s)}, gate_, {arm_}, {}));
  }
  EXPECT_FALSE(motion_.active());
}

TEST_F(GatedMotionTest, TimeThatJumpsBackEnds) {
  setOff();
  run(1.0);
  elapsed_ -= 0.01;
  step();
  EXPECT_TRUE(endedOnceWith(End::kTimeJumped));
}

TEST_F(GatedMotionTest, ALateCycleDoesNotCatchUp) {
  setOff();
  run(1.0);
  const double before = position();
  elapsed_ += 1.0;
  permit();
  step();
  EXPECT_NEAR(position() - before, config_.dt_max_s, 1e-6);
}

TEST_F(GatedMotionTest, NothingIsCommandedBeforeTheStart) {
  JudgedGoal goal = tenRadians();
  goal.start = now().stamp + fromSeconds(0.5);
  setOff(goal);
  run(0.49);
  EXPECT_TRUE(setpoint_.positions.empty());
  run(0.26);
  EXPECT_NEAR(position(), 0.125 + kLookahead, 0.011);
}

TEST_F(GatedMotionTest, BeyondAToleranceOnTheWayItEnds) {
  JudgedGoal goal = tenRadians();
  goal.tolerances.path[0].position = 0.1;
  setOff(goal);
  run(1.0);
  off_ = 0.08;
  run(0.1);
  EXPECT_TRUE(motion_.active());
  off_ = -0.12;
  run(0.1);
  EXPECT_TRUE(endedOnceWith(End::kOffPath));
  EXPECT_EQ(text_.rfind("a is off by 0.1", 0), 0U) << text_;
}

TEST_F(GatedMotionTest, AtTheEndToleranceHasItsTime) {
  JudgedGoal goal = tenRadians();
  goal.tolerances.end[0].position = 0.01;
  goal.tolerances.end_time_s = 0.5;
  for (const double late_s : {1.0, 2.0}) {
    arm_ = off_ = 0.0;
    setOff(goal);
    run(10.0);
    off_ = 0.02;
    run(late_s);
    EXPECT_EQ(motion_.active(), late_s == 1.0);
    off_ = 0.0;
    run(0.5);
    EXPECT_TRUE(endedOnceWith(late_s == 1.0 ? End::kReached : End::kOffGoal)) << late_s;
  }
}

TEST_F(GatedMotionTest, AnArmThatIsNowhereIsBeyondEveryTolerance) {
  JudgedGoal goal = tenRadians();
  goal.tolerances.path[0].position = 0.1;
  setOff(goal);
  run(1.0);
  off_ = std::nan("");
  run(0.1);
  EXPECT_TRUE(endedOnceWith(End::kOffPath));
}

TEST_F(GatedMotionTest, AnArmThatIsNowhereDoesNotFollowWhateverTheTolerances) {
  setOff();
  run(1.0);
  off_ = std::nan("");
  run(kCycle);
  EXPECT_TRUE(endedOnceWith(End::kOffPath));
}

TEST_F(GatedMotionTest, AnArmThatStaysBehindDoesNotFollow) {
  setOff();
  run(1.0);
  off_ = 0.29;
  run(0.1);
  EXPECT_TRUE(motion_.active());
  off_ = 0.31;
  run(0.1);
  EXPECT_TRUE(endedOnceWith(End::kOffPath));
  EXPECT_NE(text_.find("does not follow"), std::string::npos) << text_;
}

TEST_F(GatedMotionTest, WhereSomethingElseSetsThePaceTheArmTellsHowFarItIs) {
  config_.pace = GatedMotion::Pace::kMeasured;
  motion_ = GatedMotion(config_);
  setOff(smoothTenRadians());
  GoalPath path(smoothTenRadians().way);
  GoalPath::Sample sample;
  for (double along_s = 0.0; along_s < 5.0; along_s += 0.37 * kCycle) {
    elapsed_ += kCycle;
    permit(0.5);
    path.at(along_s, sample);
    const GatedMotion::Step step = motion_.step(now(), gate_, sample.positions, {});
    ASSERT_EQ(step.end, End::kNone) << step.text;
    EXPECT_NEAR(motion_.desired().positions[0], sample.positions[0], 0.02) << along_s;
  }
  EXPECT_NEAR(motion_.timeAlong(), 5.0, 0.03);
}

}  // namespace
}  // namespace tccm
