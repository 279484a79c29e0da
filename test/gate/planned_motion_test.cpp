#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <string>

#include "support/gated_motion_fixture.h"

namespace tccm {
namespace {

using test::GatedMotionTest;
using test::kCycle;
using test::smoothTenRadians;
using test::tenRadians;
using End = GatedMotion::End;

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

}  // namespace
}  // namespace tccm
