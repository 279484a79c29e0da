#include "gate/gated_motion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <vector>

namespace tccm {
namespace {

using End = GatedMotion::End;

constexpr double kCycle = 0.005;            // [s]
constexpr double kPermissionPeriod = 0.02;  // [s]
constexpr double kLookahead = 0.04;         // [s]

/// From 0 to 10 rad at 1 rad/s.
JudgedGoal tenRadians() {
  JudgedGoal goal;
  goal.way.names = {"a"};
  goal.way.points.resize(2);
  goal.way.points[0].positions = {0.0};
  goal.way.points[1].positions = {10.0};
  goal.way.points[1].time_s = 10.0;
  goal.tolerances.path.resize(1);
  goal.tolerances.end.resize(1);
  return goal;
}

/// A motion, the time, a monitor that permits as it is told, and an arm that follows.
class GatedMotionTest : public ::testing::Test {
 protected:
  [[nodiscard]] Instant now() const {
    return {Time(fromSeconds(1000.0 + elapsed_)), fromSeconds(5.0 + elapsed_)};
  }

  void permit(double scale = 1.0) {
    HeardPermission heard;
    heard.stamp = now().stamp;
    heard.valid_until = heard.stamp + fromSeconds(2.5 * kPermissionPeriod);
    heard.sequence = ++sequence_;
    heard.permitted = scale > 0.0;
    heard.speed_scale = scale;
    heard.why = "COLLISION, told so";
    gate_.hear(heard, now());
  }

  void setOff(JudgedGoal goal = tenRadians()) {
    permit();
    goal.start = std::max(goal.start, now().stamp);
    motion_.begin(goal, now(), gate_);
    ends_.clear();
    tell();
  }

  void tell() {
    told_ = motion_.rest(now());
    told_at_ = elapsed_;
    ++tellings_;
  }

  void step() {
    const GatedMotion::Step step = motion_.step(now(), gate_, {arm_ + off_}, {});
    if (step.end != End::kNone) {
      ends_.push_back(step.end);
      text_ = step.text;
      EXPECT_FALSE(motion_.active());
      EXPECT_EQ(step.setpoint, nullptr);
      return;
    }
    if (step.setpoint == nullptr) return;
    arm_ = motion_.desired().positions[0];
    setpoint_ = *step.setpoint;
    if (step.is_retimed) tell();
  }

  /// @param scale of the permissions meanwhile; below 0: silence.
  void run(double seconds, double scale = 1.0) {
    const double end = elapsed_ + seconds - 0.5 * kCycle;
    for (int cycle = 0; elapsed_ < end; ++cycle) {
      elapsed_ += kCycle;
      if (cycle % 4 == 3 && scale >= 0.0) permit(scale);
      if (motion_.active()) step();
    }
  }

  [[nodiscard]] double position() const { return setpoint_.positions.at(0); }
  [[nodiscard]] double velocity() const { return setpoint_.velocities.at(0); }
  [[nodiscard]] bool endedOnceWith(End end) const {
    return ends_ == std::vector<End>{end} && !motion_.active();
  }

  GatedMotion::Config config_;
  GatedMotion motion_{config_};
  PermissionGate gate_;
  double elapsed_ = 0.0;
  std::uint32_t sequence_ = 0;
  double arm_ = 0.0, off_ = 0.0;
  GoalPath::Sample setpoint_;
  JointTrajectory told_;
  double told_at_ = 0.0;
  int tellings_ = 0;
  std::vector<End> ends_;
  std::string text_;
};

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

/// An arm that does what it is planned to, and a way that is straight, or curved.
class PlannedMotionTest : public GatedMotionTest {
 protected:
  PlannedMotionTest() {
    config_.pace = GatedMotion::Pace::kPlans;
    config_.stop_duration_s = 0.3;
    motion_ = GatedMotion(config_);
  }
  void setOffPlanned(const JudgedGoal& goal) {
    setOff(goal);
    take();
  }
  void take() {
    plan_.emplace(motion_.plan());
    planned_at_ = elapsed_;
    ++plans_;
  }
  /// One cycle. @return the scale at which the plan goes.
  void cycle(double scale) {
    elapsed_ += kCycle;
    permit(scale);
    GoalPath::Sample sample;
    plan_->at(elapsed_ - planned_at_, sample);
    arm_ = sample.positions[0];
    velocity_ = sample.velocities[0];
    step_ = motion_.step(now(), gate_, {arm_}, {});
    if (step_.is_replanned) take();
  }

  std::optional<GoalPath> plan_;
  double planned_at_ = 0.0, velocity_ = 0.0;
  int plans_ = 0;
  GatedMotion::Step step_;
};

JudgedGoal smoothTenRadians() {
  JudgedGoal goal = tenRadians();
  goal.way.points.clear();
  for (int i = 0; i <= 10; ++i) {
    const double u = 0.1 * i;
    goal.way.points.push_back(
        {10.0 * u, {10.0 * u * u * (3.0 - 2.0 * u)}, {6.0 * u * (1.0 - u)}, {}});
  }
  return goal;
}

TEST_F(PlannedMotionTest, AtFullSpeedThePlanIsTheWay) {
  setOffPlanned(smoothTenRadians());
  EXPECT_EQ(motion_.plan().points.size(), 11U);
  for (int i = 0; i < 1000; ++i) cycle(1.0);
  EXPECT_EQ(plans_, 1);
  EXPECT_NEAR(arm_, 5.0, 1e-6);
}

TEST_F(PlannedMotionTest, ThePlanIsWhereTheMotionIsAndNeverFasterThanPermitted) {
  for (const bool is_smooth : {false, true}) {
    arm_ = 0.0;
    plans_ = 0;
    setOffPlanned(is_smooth ? smoothTenRadians() : tenRadians());
    double slow_since = 0.0, permitted = 1.0;
    for (int i = 0; i < 2000 && motion_.active(); ++i) {
      const double scale = i < 200 ? 1.0 : i < 500 ? 0.4 : i < 800 ? 0.05 : i < 1200 ? 0.7 : 0.3;
      if (scale < permitted) slow_since = elapsed_;
      permitted = scale;
      cycle(scale);
      ASSERT_NEAR(arm_, motion_.desired().positions[0], 5e-3) << i;
      if (elapsed_ - slow_since < 0.31 + kCycle) continue;
      const double full = is_smooth ? 1.5 : 1.0;
      EXPECT_LE(velocity_, full * scale * (1.0 + 1e-6)) << i;
    }
    EXPECT_LT(plans_, 8);
  }
}

TEST_F(PlannedMotionTest, AnEndThatComesWhileItSlowsDownIsReached) {
  setOffPlanned(tenRadians());
  for (int i = 0; i < 1980; ++i) cycle(1.0);
  for (int i = 0; i < 100; ++i) cycle(0.3);
  EXPECT_NEAR(arm_, 10.0, 1e-9);
  EXPECT_GE(plan_->duration(), 0.1);
}

TEST_F(PlannedMotionTest, BeyondTheEndNothingIsPlannedWhateverIsPermitted) {
  setOffPlanned(tenRadians());
  for (int i = 0; i < 2010; ++i) cycle(1.0);
  ASSERT_TRUE(motion_.active());
  const int plans = plans_;
  for (const double scale : {0.5, 0.2, 1.0}) {
    for (int i = 0; i < 10; ++i) cycle(scale);
    EXPECT_EQ(motion_.plan().points.size(), 1U) << scale;
  }
  EXPECT_EQ(plans_, plans);
}

TEST_F(PlannedMotionTest, AScaleThatTremblesMakesFewPlans) {
  setOffPlanned(tenRadians());
  for (int i = 0; i < 1000; ++i) cycle(0.8 + 0.05 * std::sin(0.3 * i));
  EXPECT_LT(plans_, 5);
}

TEST_F(PlannedMotionTest, WhoJudgesTheEndIsTheController) {
  setOffPlanned(tenRadians());
  for (int i = 0; i < 2100; ++i) cycle(1.0);
  EXPECT_TRUE(motion_.active());
  for (int i = 0; i < 400 && motion_.active(); ++i) cycle(1.0);
  EXPECT_EQ(step_.end, End::kOffGoal);
  EXPECT_NE(step_.text.find("controller does not say"), std::string::npos) << step_.text;
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
