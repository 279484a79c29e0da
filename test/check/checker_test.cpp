#include "check/checker_config.h"
#include "support/checker_fixture.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

using test::at;
using test::kScanPeriod;
using test::kStart;

using CheckerTest = test::CheckerFixture;

TEST_F(CheckerTest, WithEverythingFreshAndNothingNearItIsClear) {
  const Verdict& verdict = feedAndCheck(kStart, clear_);
  EXPECT_EQ(verdict.reason, Reason::kClear);
  EXPECT_TRUE(verdict.known);
  EXPECT_EQ(verdict.stamp, at(kStart));
  EXPECT_EQ(verdict.joints_stamp, at(kStart));
  EXPECT_EQ(verdict.serial, 1U);
  EXPECT_TRUE(verdict.link.empty());
}

/// Every subset of map, joints and root.
TEST_F(CheckerTest, AtTheStartItIsInitWhateverIsMissingAndNeverClear) {
  for (int given = 0; given < 7; ++given) {
    remakeWith(given);
    const Verdict& verdict = check(kStart);
    EXPECT_EQ(verdict.reason, Reason::kInit) << given;
    EXPECT_TRUE(verdict.stop) << given;
    EXPECT_FALSE(verdict.known) << given;
  }
}

TEST_F(CheckerTest, WhatStaysMissingBecomesAFaultOfItsOwn) {
  const auto reasonWithout = [this](bool map, bool joints, bool root) {
    remake();
    check(kStart);
    for (double now = kStart; now < kStart + 0.8; now += kScanPeriod) {
      if (map) setMap(now, clear_);
      if (joints) addJoints(now, 0.0);
      if (root) setRoot(now);
    }
    return reasonAt(kStart + 0.8);
  };
  EXPECT_EQ(reasonWithout(false, true, true), Reason::kNoMap);
  EXPECT_EQ(reasonWithout(true, false, true), Reason::kNoJoints);
  EXPECT_EQ(reasonWithout(true, true, false), Reason::kNoTransform);
  EXPECT_EQ(reasonWithout(false, false, false), Reason::kNoTransform) << "the worst of them";
}

TEST_F(CheckerTest, InitLastsAsLongAsEachTimeout) {
  check(kStart);
  setRoot(kStart, true);
  setMap(kStart + 0.1, clear_);
  EXPECT_EQ(reasonAt(kStart + 0.100), Reason::kInit);
  EXPECT_EQ(reasonAt(kStart + 0.101), Reason::kNoJoints);
}

TEST_F(CheckerTest, AJointThatIsNeverNamedIsNamedInTheDetail) {
  check(kStart);
  setRoot(kStart, true);
  for (double now = kStart; now < kStart + 0.3; now += 0.01) {
    checker_->addJoints(at(now), at(now), {"slide"}, {0.0}, {});
    setMap(now, clear_);
  }
  const Verdict& verdict = check(kStart + 0.3);
  EXPECT_EQ(verdict.reason, Reason::kNoJoints);
  EXPECT_NE(verdict.detail.find("'glide'"), std::string::npos) << verdict.detail;
}

TEST_F(CheckerTest, JointsMayBeAsOldAsTheirTimeoutAndNoOlder) {
  run(kStart, kStart + 0.1, clear_);
  const double last = kStart + 0.1;
  setMap(last + 0.1, clear_);
  EXPECT_EQ(reasonAt(last + 0.100), Reason::kClear);
  EXPECT_EQ(reasonAt(last + 0.1001), Reason::kNoJoints);
}

TEST_F(CheckerTest, OneJointThatFallsSilentIsEnough) {
  run(kStart, kStart + 0.1, clear_);
  for (double now = kStart + 0.11; now < kStart + 0.25; now += 0.01) {
    checker_->addJoints(at(now), at(now), {"slide"}, {0.0}, {});
    setMap(now, clear_);
  }
  EXPECT_EQ(reasonAt(kStart + 0.25), Reason::kNoJoints);
}

TEST_F(CheckerTest, ARootThatMovesMayBeAsOldAsItsTimeoutAndNoOlder) {
  feed(kStart, clear_);
  feedAllButRoot(kStart + 0.5, clear_);
  EXPECT_EQ(reasonAt(kStart + 0.5), Reason::kClear);
  EXPECT_EQ(reasonAt(kStart + 0.5001), Reason::kNoTransform);
}

TEST_F(CheckerTest, AStaticRootNeverGrowsOld) {
  setRoot(kStart, true);
  feedAllButRoot(kStart + 1000.0, clear_);
  EXPECT_EQ(reasonAt(kStart + 1000.0), Reason::kClear);
}

TEST_F(CheckerTest, ARootThatIsNoPoseIsNotTaken) {
  Pose broken = Pose::Identity();
  broken.translation().x() = std::numeric_limits<double>::quiet_NaN();
  checker_->setRootPose(0, at(kStart), broken, true);
  feedAllButRoot(kStart, clear_);
  EXPECT_EQ(reasonAt(kStart), Reason::kInit);
}

TEST_F(CheckerTest, TheMapMayBeSilentForThreeScanPeriodsAndNoLonger) {
  run(kStart, kStart + 0.5, clear_);
  const double last = kStart + 0.5;
  addJoints(last + 0.07, 0.0);
  setRoot(last + 0.07);
  EXPECT_EQ(reasonAt(last + 0.07), Reason::kClear);
  EXPECT_EQ(reasonAt(last + 0.08), Reason::kNoMap);
}

TEST_F(CheckerTest, BeforeTwoMapsTheirGreatestAgeIsTheLimitOfSilence) {
  feed(kStart, clear_);
  setRoot(kStart + 0.5);
  addJoints(kStart + 0.5, 0.0);
  EXPECT_EQ(reasonAt(kStart + 0.5), Reason::kClear);
  EXPECT_EQ(reasonAt(kStart + 0.501), Reason::kNoMap);
}

TEST_F(CheckerTest, MapsThatComeButAreTooOldAreLate) {
  feed(kStart, clear_);
  setMap(kStart, clear_, kStart - 0.5);
  EXPECT_EQ(reasonAt(kStart), Reason::kClear);
  setMap(kStart, clear_, kStart - 0.501);
  EXPECT_EQ(reasonAt(kStart), Reason::kMapLate);
}

TEST_F(CheckerTest, AMapThatLeftPointsOutIsNotTrusted) {
  clear_.overflowed = true;
  EXPECT_EQ(feedAndCheck(kStart, clear_).reason, Reason::kMapOverflow);
}

TEST_F(CheckerTest, AMapThatIsNotWholeIsInitHoweverLongItTakes) {
  clear_.complete = false;
  EXPECT_EQ(run(kStart, kStart + 5.0, clear_).reason, Reason::kInit);
}

TEST_F(CheckerTest, StampsMayLeadByALittleAndNoMore) {
  feed(kStart, clear_);
  setMap(kStart, clear_, kStart + 0.1);
  EXPECT_EQ(reasonAt(kStart), Reason::kClear);
  setMap(kStart, clear_, kStart + 0.101);
  EXPECT_EQ(reasonAt(kStart), Reason::kFuture);
  remake();
  feed(kStart, clear_);
  addJoints(kStart + 0.1, 0.0);
  EXPECT_EQ(reasonAt(kStart), Reason::kClear);
}

TEST_F(CheckerTest, AJointStateFromTheFutureIsDroppedAndTheNextOneCounts) {
  feed(kStart, clear_);
  checker_->addJoints(at(kStart), at(kStart + 7.0), {"slide"}, {0.9}, {0.0});
  EXPECT_EQ(reasonAt(kStart), Reason::kClear);
  EXPECT_EQ(checker_->inputs().futureJoints(), 1U);
  run(kStart + 0.02, kStart + 1.0, clear_);
  EXPECT_EQ(reasonAt(kStart + 1.0), Reason::kClear);
}

TEST_F(CheckerTest, OneOfTwoPublishersStampingAheadIsNoticed) {
  run(kStart, kStart + 0.5, clear_);
  for (double now = kStart + 0.51; now < kStart + 0.7; now += 0.01) {
    checker_->addJoints(at(now), at(now + 7.0), {"glide"}, {0.0}, {0.0});
    checker_->addJoints(at(now), at(now), {"slide"}, {0.0}, {0.0});
    setMap(now, clear_);
    check(now);
  }
  const Verdict& verdict = check(kStart + 0.7);
  EXPECT_EQ(verdict.reason, Reason::kFuture);
  EXPECT_EQ(verdict.reasons.front(), Reason::kFuture);
}

TEST_F(CheckerTest, AClockThatStandsStillIsAFaultUntilItGoesOn) {
  run(kStart, kStart + 0.5, clear_);
  checker_->inputs().setClockStalls(true);
  EXPECT_EQ(reasonAt(kStart + 0.5), Reason::kNoClock);
  EXPECT_NE(checker_->checkState(at(kStart + 0.5), {"slide"}, {0.0}).cause.reason, Reason::kClear);
  checker_->inputs().setClockStalls(false);
  EXPECT_EQ(run(kStart + 0.51, kStart + 1.4, clear_).reason, Reason::kReleasing);
  EXPECT_EQ(run(kStart + 1.41, kStart + 1.6, clear_).reason, Reason::kClear);
}

TEST_F(CheckerTest, AClockSetBackByALittleDoesNotEndARelease) {
  run(kStart, kStart + 0.5, post_, 0.8);
  EXPECT_EQ(feedAndCheck(kStart + 0.51, clear_).reason, Reason::kReleasing);
  EXPECT_EQ(reasonAt(kStart + 0.509), Reason::kReleasing);
  EXPECT_EQ(feedAndCheck(kStart + 0.52, clear_).reason, Reason::kReleasing);
}

TEST_F(CheckerTest, TimeThatIsNotKnownToBeClearDoesNotCountTowardsTheRelease) {
  run(kStart, kStart + 0.5, post_, 0.8);
  CuboidMap filling = clear_;
  filling.complete = false;
  EXPECT_EQ(run(kStart + 0.51, kStart + 3.0, filling).reason, Reason::kInit);
  EXPECT_EQ(feedAndCheck(kStart + 3.01, clear_).reason, Reason::kReleasing);
}

TEST_F(CheckerTest, TouchingNowIsACollisionThatNamesTheLink) {
  const Verdict& verdict = feedAndCheck(kStart, post_, 0.75);
  EXPECT_EQ(verdict.reason, Reason::kCollision);
  EXPECT_EQ(verdict.link, "hand");
  EXPECT_TRUE(verdict.collision);
  EXPECT_TRUE(verdict.known);
  EXPECT_TRUE(verdict.now.collision);
}

TEST_F(CheckerTest, HiddenNowIsAnOcclusionThatNamesTheLink) {
  const Verdict& verdict = feedAndCheck(kStart, shelf_, 0.6);
  EXPECT_EQ(verdict.reason, Reason::kOcclusion);
  EXPECT_EQ(verdict.link, "hand");
  EXPECT_TRUE(verdict.occlusion);
  EXPECT_FALSE(verdict.collision);
}

TEST_F(CheckerTest, AVelocityThatLeadsIntoThePostIsACollisionAhead) {
  const Verdict& slow = feedAndCheck(kStart, post_, 0.4, 0.60);  // to 0.70 m in 0.5 s
  EXPECT_EQ(slow.reason, Reason::kClear);
  remake();
  const Verdict& fast = feedAndCheck(kStart, post_, 0.4, 0.64);  // to 0.72 m
  EXPECT_EQ(fast.reason, Reason::kCollisionAhead);
  EXPECT_EQ(fast.link, "hand");
  EXPECT_FALSE(fast.now.collision);
  EXPECT_TRUE(fast.ahead.collision);
}

TEST_F(CheckerTest, PositionsThatChangeCountAsAVelocityEvenIfZeroIsReported) {
  setRoot(kStart, true);
  for (int i = 0; i <= 10; ++i) addJoints(kStart + 0.01 * i, 0.3 + 0.01 * i, 0.0);  // 1 m/s
  setMap(kStart + 0.1, post_);
  EXPECT_EQ(reasonAt(kStart + 0.1), Reason::kCollisionAhead);
}

TEST_F(CheckerTest, AVelocityThatLeadsBehindTheShelfIsAnOcclusionAhead) {
  CuboidMap map = clear_;
  test::addBlock(map, {Vector3(0.40, -0.3, 0.78), Vector3(1.2, 0.3, 0.80)});
  test::lookAround(map);
  EXPECT_EQ(feedAndCheck(kStart, map, 0.1).reason, Reason::kClear);
  EXPECT_EQ(feedAndCheck(kStart + 0.01, map, 0.1, 1.4).reason, Reason::kOcclusionAhead);
}

/// The hand is hidden as far as 0.49 m, the other from 0.5 m on.
TEST_F(CheckerTest, WhileOneLinkComesOutOfItsHidingPlaceNoOtherMayBeHidden) {
  CuboidMap map = clear_;
  test::addBlock(map, {Vector3(-0.2, -0.2, 0.78), Vector3(0.35, 0.2, 0.80)});
  test::addBlock(map, {Vector3(0.36, 0.22, 0.78), Vector3(1.2, 0.5, 0.80)});
  test::lookAround(map);
  const auto judged = [&](double other_speed) {
    remake();
    setRoot(kStart);
    checker_->addJoints(at(kStart), at(kStart), {"slide", "glide"}, {0.3, 0.2}, {1.2, other_speed});
    setMap(kStart, map);
    return check(kStart);
  };
  EXPECT_EQ(judged(0.0).reason, Reason::kMovingOut);
  EXPECT_EQ(judged(1.2).reason, Reason::kOcclusion);
}

TEST_F(CheckerTest, ThePoseAheadIsClampedToTheJointsLimits) {
  CuboidMap map = clear_;
  test::addBlock(map, {Vector3(1.2, -0.2, 0.3), Vector3(1.4, 0.2, 0.7)});
  // The slide ends at 1.0 m; the padded ball would touch from 1.11 m on.
  EXPECT_EQ(feedAndCheck(kStart, map, 0.8, 2.0).reason, Reason::kClear);
}

TEST_F(CheckerTest, AJointMeasuredBeyondItsLimitIsNotMovedBackIn) {
  CuboidMap map = clear_;
  test::addBlock(map, {Vector3(1.2, -0.2, 0.3), Vector3(1.4, 0.2, 0.7)});
  const Verdict& verdict = feedAndCheck(kStart, map, 1.15, 0.0);
  EXPECT_EQ(verdict.reason, Reason::kCollision);
  EXPECT_TRUE(verdict.ahead.collision);
}

TEST_F(CheckerTest, OfSeveralReasonsTheWorstIsGiven) {
  CuboidMap both = shelf_;
  test::addBlock(both, {Vector3(0.8, -0.2, 0.0), Vector3(0.9, 0.2, 0.7)});
  EXPECT_EQ(feedAndCheck(kStart, both, 0.75).reason, Reason::kCollision);
  both.overflowed = true;
  const Verdict& verdict = feedAndCheck(kStart + 0.01, both, 0.75);
  EXPECT_EQ(verdict.reason, Reason::kMapOverflow);
  EXPECT_TRUE(verdict.collision) << "what is found is told all the same";
}

TEST_F(CheckerTest, AStopIsReleasedAfterAWholeWindowThatIsClear) {
  run(kStart, kStart + 0.5, post_, 0.75);
  const double last_stop = kStart + 0.5;
  EXPECT_EQ(run(last_stop + 0.1, last_stop + 0.99, clear_).reason, Reason::kReleasing);
  EXPECT_EQ(feedAndCheck(last_stop + 1.0, clear_).reason, Reason::kClear);
  EXPECT_EQ(feedAndCheck(last_stop + 1.1, clear_).reason, Reason::kClear);
}

TEST_F(CheckerTest, AStopDuringTheReleaseStartsItAnew) {
  feedAndCheck(kStart, post_, 0.75);
  run(kStart + 0.1, kStart + 0.8, clear_);
  feedAndCheck(kStart + 0.82, post_, 0.75);
  EXPECT_EQ(run(kStart + 0.9, kStart + 1.8, clear_).reason, Reason::kReleasing);
  EXPECT_EQ(feedAndCheck(kStart + 1.82, clear_).reason, Reason::kClear);
}

TEST_F(CheckerTest, ALongerReleaseThanTheWindowIsKept) {
  config_.permission.release_s = 3.0;
  remake();
  feedAndCheck(kStart, post_, 0.75);
  EXPECT_EQ(run(kStart + 0.1, kStart + 2.9, clear_).reason, Reason::kReleasing);
  EXPECT_EQ(feedAndCheck(kStart + 3.0, clear_).reason, Reason::kClear);
}

TEST_F(CheckerTest, AFaultIsReleasedAsSlowlyAsAStop) {
  run(kStart, kStart + 0.1, clear_);
  EXPECT_NE(check(kStart + 1.0).level, Level::kOk);
  EXPECT_EQ(feedAndCheck(kStart + 1.1, clear_).reason, Reason::kReleasing);
  EXPECT_EQ(run(kStart + 1.2, kStart + 2.2, clear_).reason, Reason::kClear);
}

TEST_F(CheckerTest, AFaultBeforeAnythingWasKnownNeedsNoRelease) {
  EXPECT_EQ(reasonAt(kStart), Reason::kInit);
  EXPECT_EQ(levelOf(reasonAt(kStart + 5.0)), Level::kFault);
  EXPECT_EQ(feedAndCheck(kStart + 5.1, clear_).reason, Reason::kClear);
}

TEST_F(CheckerTest, AfterTheStartNothingNeedsToBeReleased) {
  check(kStart);
  EXPECT_EQ(feedAndCheck(kStart + 0.05, clear_).reason, Reason::kClear);
}

TEST_F(CheckerTest, WhenTimeJumpsBackEverythingStartsAnew) {
  run(kStart, kStart + 0.5, clear_);
  EXPECT_EQ(reasonAt(kStart - 50.0), Reason::kInit);
  EXPECT_EQ(checker_->map(), nullptr);
  EXPECT_EQ(feedAndCheck(kStart - 49.9, clear_).reason, Reason::kClear);
}

TEST_F(CheckerTest, AfterResetNothingIsKnown) {
  feedAndCheck(kStart, clear_);
  checker_->startAnew();
  const Verdict& verdict = check(kStart + 0.01);
  EXPECT_EQ(verdict.reason, Reason::kInit);
  EXPECT_EQ(verdict.serial, 0U);
  EXPECT_TRUE(verdict.now.links.empty());
}

/// A position or velocity that is not finite never reaches the check.
TEST_F(CheckerTest, NumbersThatAreNoneAgeLikeSilence) {
  run(kStart, kStart + 0.1, clear_);
  for (double now = kStart + 0.11; now < kStart + 0.3; now += 0.01) {
    addJoints(now, std::numeric_limits<double>::quiet_NaN());
    setMap(now, clear_);
  }
  EXPECT_EQ(reasonAt(kStart + 0.3), Reason::kNoJoints);
}

/// Sensors look everywhere with each scan, so that the braking alone limits the speed.
TEST_F(CheckerTest, TheGovernedSpeedFollowsABrakingThatIsTunedWhileItRuns) {
  config_.governed_speed.appear_distance_m = 0.15;
  remake();
  clear_.look_period = fromSeconds(0.1);
  double now = kStart, slide = 0.0;
  const auto governedScale = [&] {
    constexpr double kSpeed = 0.5;
    for (int i = 0; i < 20; ++i, now += 0.025, slide += 0.025 * kSpeed) {
      feedAndCheck(now, clear_, slide, kSpeed);
    }
    return checker_->check(at(now - 0.025)).governed_scale;
  };
  run(kStart, kStart + 0.5, clear_);
  now = kStart + 0.525;
  const double braking_well = governedScale();
  config_.braking.deceleration_mps2 = 0.5;
  config_.braking.reaction_time_s = 0.2;
  checker_->reconfigure(config_);
  const double braking_badly = governedScale();
  EXPECT_LT(braking_badly, 0.7 * braking_well);
  EXPECT_GT(braking_badly, 0.0);
}

TEST(CheckerConfigTest, ValuesOutOfRangeAreRefused) {
  const auto refused = [](auto part, auto member, double value) {
    Checker::Config config;
    config.*part.*member = value;
    EXPECT_THROW(Checker(test::sliderModel(), config), ConfigError) << value;
  };
  using Config = Checker::Config;
  refused(&Config::way, &ContactJudge::Config::horizon_s, -0.1);
  refused(&Config::inputs, &CheckInputs::Config::joint_timeout_s, 0.0);
  refused(&Config::inputs, &CheckInputs::Config::transform_timeout_s, 0.0);
  refused(&Config::inputs, &CheckInputs::Config::scan_timeout_periods, 0.5);
  refused(&Config::inputs, &CheckInputs::Config::map_age_max_s,
          std::numeric_limits<double>::infinity());
  refused(&Config::inputs, &CheckInputs::Config::future_max_s, -1.0);
  refused(&Config::permission, &Permission::Config::release_s,
          std::numeric_limits<double>::quiet_NaN());
}

}  // namespace
}  // namespace tccm
