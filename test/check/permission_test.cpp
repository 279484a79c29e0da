#include "check/permission.h"

#include <gtest/gtest.h>

#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

Time at(double seconds) { return Time(fromSeconds(seconds)); }

const Cause kNoJoints{Reason::kNoJoints, "no joint states"};
const Cause kTouches{Reason::kCollision, "hand touches the map", "hand"};
const Cause kAhead{Reason::kCollisionAhead, "hand touches the map ahead", "hand"};
const Cause kFar =
    Cause::slowing(Reason::kCollisionAhead, 1.0, "hand touches the map ahead", "hand");
const Cause kInRegion{Reason::kKeepOut, "hand is in keep-out region 'wall'", "hand"};
const Cause kRegionAhead{Reason::kKeepOutAhead, "hand enters keep-out region 'wall'", "hand"};
const Cause kInit{Reason::kInit, "the map does not hold a whole sweep yet"};
const Cause kMovesOut{Reason::kMovingOut, "hand moves out of contact", "hand"};

class PermissionTest : public ::testing::Test {
 protected:
  /// One check every 20 ms up to a time. @return the last decision.
  const Permission::Decision& decideUntil(double to, const std::vector<Cause>& causes,
                                          double speed_scale = 1.0) {
    const Permission::Decision* last = nullptr;
    for (; now_ <= to + 1e-9; now_ += 0.02) last = &decide(causes, speed_scale);
    return *last;
  }
  const Permission::Decision& decide(const std::vector<Cause>& causes, double speed_scale = 1.0) {
    Permission::Findings findings;
    findings.causes = causes;
    findings.known = true;
    for (const Cause& cause : causes) {
      if (cause.level == Level::kFault || cause.reason == Reason::kInit) findings.known = false;
      const bool touches = cause.reason == Reason::kCollision || cause.reason == Reason::kKeepOut;
      if (touches) findings.touching = cause;
      if (cause.reason == Reason::kMovingOut) findings.touching = moved_out_of_;
    }
    for (Cause& cause : findings.causes) {
      if (cause.level == Level::kSlow) cause.speed_scale = speed_scale;
    }
    findings.window = fromSeconds(1.0);
    return permission_.decide(at(now_), findings);
  }
  Reason reasonUntil(double to, const std::vector<Cause>& causes) {
    return decideUntil(to, causes).worst.reason;
  }

  Permission::Config config_;
  Permission permission_{config_};
  Cause moved_out_of_ = kTouches;
  double now_ = 100.0;
};

TEST_F(PermissionTest, BeginsWithNothingPermittedAndNothingHeld) {
  const auto& init = decide({kInit});
  EXPECT_EQ(init.worst.reason, Reason::kInit);
  EXPECT_EQ(init.worst.level, Level::kStop);
  EXPECT_EQ(init.speed_scale, 0.0);
  EXPECT_EQ(init.latched, Reason::kClear);
  now_ += 0.02;
  EXPECT_EQ(decide({}).worst.level, Level::kOk);
}

TEST_F(PermissionTest, TheScaleRisesSlowlyAndFallsAtOnce) {
  decide({});
  now_ = 100.5;
  EXPECT_NEAR(decide({}).speed_scale, 0.25, 1e-9);
  now_ = 101.0;
  EXPECT_NEAR(decide({}).speed_scale, 0.5, 1e-9);
  now_ = 101.01;
  EXPECT_EQ(decide({kFar}, 0.2).speed_scale, 0.2);
  now_ = 101.02;
  EXPECT_EQ(decide({kAhead}, 0.0).speed_scale, 0.0);
  decideUntil(103.0, {});
  now_ = 300.0;
  EXPECT_EQ(decide({}).speed_scale, 1.0) << "and no higher";
}

TEST_F(PermissionTest, AFarContactSlowsDownAndNeedsNoRelease) {
  decideUntil(104.0, {});
  const auto& slow = decideUntil(104.5, {kFar}, 0.4);
  EXPECT_EQ(slow.worst.level, Level::kSlow);
  EXPECT_EQ(slow.speed_scale, 0.4);
  EXPECT_EQ(decide({}).worst.reason, Reason::kClear);
}

TEST_F(PermissionTest, TheWorstLevelWinsAndAllReasonsAreNamedTheGravestFirst) {
  decide({});
  now_ += 0.02;
  const auto& decision = decide({kFar, kInit, kNoJoints, kTouches});
  EXPECT_EQ(decision.worst.reason, Reason::kNoJoints);
  EXPECT_EQ(decision.worst.detail, kNoJoints.detail);
  const std::vector<Reason> expected{Reason::kNoJoints, Reason::kCollision, Reason::kInit,
                                     Reason::kCollisionAhead};
  EXPECT_EQ(decision.reasons, expected);
}

TEST_F(PermissionTest, AContactAheadReleasesAfterAWholeWindowThatIsClear) {
  decideUntil(100.5, {kAhead});
  EXPECT_EQ(reasonUntil(101.46, {}), Reason::kReleasing);
  EXPECT_EQ(reasonUntil(101.52, {}), Reason::kClear);
}

TEST_F(PermissionTest, AndAfterSoManyClearChecksInARow) {
  decide({kAhead});
  now_ = 110.0;
  for (int i = 1; i < config_.release_checks; ++i, now_ += 0.001) {
    EXPECT_EQ(decide({}).worst.reason, Reason::kReleasing) << i;
  }
  EXPECT_EQ(decide({}).worst.reason, Reason::kClear);
}

TEST_F(PermissionTest, WhatOnlySlowsDownCountsAsClearForTheRelease) {
  decideUntil(100.5, {kAhead});
  EXPECT_EQ(reasonUntil(101.4, {kFar}), Reason::kReleasing);
  EXPECT_EQ(reasonUntil(101.6, {kFar}), Reason::kCollisionAhead);
}

TEST_F(PermissionTest, ACollisionAtThePresentPoseHoldsUntilItIsReset) {
  decideUntil(100.5, {kTouches});
  EXPECT_EQ(reasonUntil(130.0, {}), Reason::kAwaitingReset);
  const auto& held = decide({});
  EXPECT_EQ(held.latched, Reason::kCollision);
  EXPECT_NE(held.worst.detail.find(kTouches.detail), std::string::npos);
  EXPECT_EQ(held.worst.link, "hand");
  EXPECT_EQ(permission_.reset(), "");
  EXPECT_EQ(decide({}).worst.reason, Reason::kClear) << "clear for long enough already";
}

TEST_F(PermissionTest, AResetRightAfterTheContactStillWaitsForTheRelease) {
  decideUntil(100.5, {kTouches});
  decide({});
  EXPECT_EQ(permission_.reset(), "");
  EXPECT_EQ(reasonUntil(101.4, {}), Reason::kReleasing);
  EXPECT_EQ(reasonUntil(101.6, {}), Reason::kClear);
}

TEST_F(PermissionTest, ResetIsRefusedWhileTheCauseLasts) {
  decide({});
  now_ += 0.02;
  for (const Cause& cause : {kTouches, kNoJoints}) {
    decideUntil(now_, {cause});
    EXPECT_NE(permission_.reset().find(name(cause.reason)), std::string::npos);
    decideUntil(now_, {});
    EXPECT_EQ(permission_.reset(), "");
  }
  EXPECT_EQ(permission_.reset(), "");
}

TEST_F(PermissionTest, AFaultHoldsOnceAnythingWasKnownAndNotBefore) {
  decideUntil(101.0, {kNoJoints});
  EXPECT_EQ(decide({}).worst.reason, Reason::kClear) << "the other nodes had not started yet";
  now_ += 0.02;
  decide({kNoJoints});
  now_ += 10.0;
  EXPECT_EQ(reasonUntil(now_ + 1.0, {}), Reason::kAwaitingReset);
}

TEST_F(PermissionTest, OfTwoThatHoldTheGraverIsNamed) {
  decide({});
  now_ += 0.02;
  decide({kNoJoints});
  now_ += 0.02;
  decide({kTouches});
  now_ += 0.02;
  EXPECT_EQ(decide({}).latched, Reason::kNoJoints);
}

TEST_F(PermissionTest, MovingOutOfAContactIsPermittedSlowlyAndStillHasToBeReset) {
  decide({});
  now_ += 0.02;
  decide({kTouches});
  const auto& out = decideUntil(105.0, {kMovesOut}, 0.2);
  EXPECT_EQ(out.worst.reason, Reason::kMovingOut);
  EXPECT_EQ(out.worst.level, Level::kSlow);
  EXPECT_NEAR(out.speed_scale, 0.2, 1e-9);
  EXPECT_NE(permission_.reset(), "") << "it still touches";
  EXPECT_EQ(decide({}).worst.reason, Reason::kAwaitingReset);
  EXPECT_EQ(permission_.reset(), "");
}

TEST_F(PermissionTest, MovingOutDoesNotHideAFaultNorLiftOneThatHolds) {
  decide({});
  now_ += 0.02;
  EXPECT_EQ(decide({kMovesOut, kNoJoints}).worst.reason, Reason::kNoJoints);
  now_ += 0.02;
  EXPECT_EQ(decide({kMovesOut}).worst.reason, Reason::kAwaitingReset);
}

TEST_F(PermissionTest, ComingOutOfAHidingPlaceDoesNotLiftACollisionThatHolds) {
  decide({});
  now_ += 0.02;
  decide({kTouches});
  now_ += 0.02;
  decide({});
  Permission::Findings findings;
  findings.causes = {{Reason::kMovingOut, "hand comes out of where it is hidden", "hand"}};
  findings.known = true;
  findings.window = fromSeconds(1.0);
  EXPECT_EQ(permission_.decide(at(now_ + 0.02), findings).worst.reason, Reason::kAwaitingReset);
}

TEST_F(PermissionTest, ComingOutOfAHidingPlaceDoesNotCutTheReleaseOfAContactAheadShort) {
  const Cause comes_out{Reason::kMovingOut, "hand comes out of where it is hidden", "hand"};
  const auto decideOnWayOut = [&] {
    Permission::Findings findings;
    findings.causes = {comes_out};
    findings.known = true;
    findings.window = fromSeconds(1.0);
    return permission_.decide(at(now_), findings).worst.reason;
  };
  decideUntil(100.5, {kAhead});
  EXPECT_EQ(decideOnWayOut(), Reason::kReleasing);
  permission_.startAnew();
  decideUntil(now_ + 0.5, {{Reason::kOcclusion, "hand is hidden", "hand"}});
  EXPECT_EQ(decideOnWayOut(), Reason::kMovingOut) << "out of what stopped it";
}

TEST_F(PermissionTest, ComingOutOfAHidingPlaceCutsTheReleaseOfNoOtherStopShort) {
  moved_out_of_ = {};
  Permission::Config config;
  config.hold_until_reset = false;
  for (const Reason reason : {Reason::kApproached, Reason::kEvidenceOld, Reason::kBadTrajectory,
                              Reason::kCollision, Reason::kKeepOut, Reason::kNoJoints}) {
    permission_ = Permission(config);
    decide({});
    decideUntil(now_ + 0.2, {Cause(reason, "it stops", "hand")});
    EXPECT_EQ(decide({kMovesOut}).worst.reason, Reason::kReleasing) << name(reason);
  }
}

TEST_F(PermissionTest, AFaultThatIsOverIsResetInContactSoThatTheRobotCanMoveOut) {
  decide({});
  now_ += 0.02;
  decide({kTouches});
  now_ += 0.02;
  decide({kTouches, kNoJoints});
  EXPECT_NE(permission_.reset(), "");
  now_ += 0.02;
  EXPECT_EQ(decide({kTouches}).latched, Reason::kNoJoints);
  EXPECT_EQ(permission_.reset(), "");
  now_ += 0.02;
  EXPECT_EQ(decide({kMovesOut}, 0.2).worst.reason, Reason::kMovingOut);
  now_ += 0.02;
  EXPECT_EQ(decide({}).latched, Reason::kCollision) << "which holds all the same";
}

TEST_F(PermissionTest, BeingInARegionToKeepOutOfHoldsAsACollisionDoes) {
  moved_out_of_ = kInRegion;
  decideUntil(100.1, {kInRegion});
  EXPECT_EQ(permission_.reset(), "KEEP_OUT lasts");
  EXPECT_EQ(decideUntil(100.2, {kMovesOut}).worst.reason, Reason::kMovingOut);
  EXPECT_EQ(decideUntil(103.0, {}).worst.reason, Reason::kAwaitingReset);
  EXPECT_EQ(decide({}).latched, Reason::kKeepOut);
  EXPECT_EQ(permission_.reset(), "");
  EXPECT_EQ(decide({}).worst.reason, Reason::kClear);
}

/// Else it could neither move nor be reset.
TEST_F(PermissionTest, ARobotThatCameOutOfACollisionAndIsStillInARegionMayMoveOnOut) {
  decideUntil(100.1, {kTouches, kInRegion});
  moved_out_of_ = kInRegion;
  const auto& decision = decideUntil(100.2, {kMovesOut});
  EXPECT_EQ(decision.worst.reason, Reason::kMovingOut);
  EXPECT_EQ(decision.latched, Reason::kCollision);
}

TEST_F(PermissionTest, AFaultThatIsOverIsResetInARegionToo) {
  moved_out_of_ = kInRegion;
  decide({});
  decideUntil(100.1, {kNoJoints});
  decideUntil(100.2, {kInRegion});
  EXPECT_EQ(permission_.reset(), "");
  EXPECT_EQ(decide({kMovesOut}).worst.reason, Reason::kMovingOut);
  EXPECT_EQ(decide({}).latched, Reason::kKeepOut);
}

TEST_F(PermissionTest, ComingOutOfAHidingPlaceDoesNotCutTheReleaseOfARegionAheadShort) {
  moved_out_of_ = {};
  decideUntil(100.5, {kRegionAhead});
  EXPECT_EQ(reasonUntil(100.7, {kMovesOut}), Reason::kReleasing);
}

TEST_F(PermissionTest, WhatTouchesWhileTheRobotMovesAwayHoldsAsWell) {
  decideUntil(100.5, {kMovesOut}, 0.2);
  EXPECT_EQ(decide({}).worst.reason, Reason::kAwaitingReset);
}

TEST_F(PermissionTest, WithoutHoldingACollisionReleasesLikeAContactAhead) {
  config_.hold_until_reset = false;
  permission_.reconfigure(config_);
  decideUntil(100.5, {kTouches});
  EXPECT_EQ(reasonUntil(101.4, {}), Reason::kReleasing);
  EXPECT_EQ(reasonUntil(101.6, {}), Reason::kClear);
}

TEST_F(PermissionTest, TheReleaseBeginsOnceTheRobotHasMovedOut) {
  config_.hold_until_reset = false;
  permission_.reconfigure(config_);
  decideUntil(100.5, {kTouches});
  decideUntil(105.0, {kMovesOut}, 0.2);
  EXPECT_EQ(reasonUntil(105.9, {}), Reason::kReleasing);
  EXPECT_EQ(reasonUntil(106.1, {}), Reason::kClear);
}

TEST_F(PermissionTest, InitNeedsNoResetAndDoesNotCountTowardsTheRelease) {
  decideUntil(100.5, {kAhead});
  decideUntil(105.0, {kInit});
  EXPECT_EQ(decide({}).worst.reason, Reason::kReleasing);
  permission_.startAnew();
  decideUntil(110.0, {kInit});
  EXPECT_EQ(decide({}).worst.reason, Reason::kClear);
}

TEST_F(PermissionTest, ValuesOutOfRangeAreRefused) {
  config_.release_s = -1.0;
  EXPECT_THROW(permission_.reconfigure(config_), ConfigError);
  config_ = {};
  config_.release_checks = 0;
  EXPECT_THROW(permission_.reconfigure(config_), ConfigError);
  config_ = {};
  config_.speed_scale_rise_per_s = 0.0;
  EXPECT_THROW(permission_.reconfigure(config_), ConfigError);
}

}  // namespace
}  // namespace tccm
