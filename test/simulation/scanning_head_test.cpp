#include "simulation/scanning_head.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace tccm::simulation {
namespace {

constexpr Duration kStep = std::chrono::milliseconds(1);
constexpr Time kStart{std::chrono::seconds(1000)};

struct Range {
  double least = 1e9;
  double most = -1e9;

  void add(double value) {
    least = std::min(least, value);
    most = std::max(most, value);
  }
};

/// A head and its clock.
class ScanningHeadTest : public ::testing::Test {
 protected:
  /// Goes on for so long. @return the tilts passed.
  Range pass(ScanningHead& head, int ms) {
    Range tilts;
    for (int i = 0; i < ms; ++i) {
      head.step(now_ += kStep);
      tilts.add(head.tilt());
    }
    return tilts;
  }

  Time now_ = kStart;
};

TEST_F(ScanningHeadTest, WithoutAFaultItNodsAsTiltMotionSaysAndLooksAhead) {
  ScanningHead head({}, kStart);
  const TiltMotion motion;
  for (int i = 0; i < 5000; ++i) {
    head.step(now_ += kStep);
    ASSERT_NEAR(head.tilt(), motion.position(now_ - kStart), 1e-12);
    ASSERT_NEAR(head.tiltVelocity(), motion.velocity(now_ - kStart), 1e-12);
    ASSERT_EQ(head.yaw(), 0.0);
  }
}

TEST_F(ScanningHeadTest, AFrozenTiltStandsStillAndThenGoesOnFromThere) {
  ScanningHead::Config config;
  config.faults = {{TiltFault::kFrozen, 1.0, 2.0}};
  ScanningHead head(config, kStart);
  pass(head, 1150);
  const double where = head.tilt();
  const Range tilts = pass(head, 1800);
  EXPECT_EQ(tilts.least, where);
  EXPECT_EQ(tilts.most, where);
  EXPECT_EQ(head.tiltVelocity(), 0.0);
  pass(head, 60);
  EXPECT_NEAR(head.tilt(), where, 0.01);
  const Range after = pass(head, 1800);
  EXPECT_NEAR(after.least, M_PI / 12.0, 1e-3);
  EXPECT_NEAR(after.most, 5.0 * M_PI / 12.0, 1e-3);
}

TEST_F(ScanningHeadTest, ANarrowedTiltKeepsToAFifthOfItsRange) {
  ScanningHead head({}, kStart);
  head.setFault(TiltFault::kNarrowed);
  pass(head, 600);
  const Range tilts = pass(head, 1600);
  EXPECT_NEAR(tilts.least, M_PI / 4.0 - M_PI / 30.0, 1e-3);
  EXPECT_NEAR(tilts.most, M_PI / 4.0 + M_PI / 30.0, 1e-3);
}

TEST_F(ScanningHeadTest, AHeadTurnedAwayStaysThereUntilTheFaultIsOver) {
  ScanningHead head({}, kStart);
  head.setFault(TiltFault::kTurnedAway);
  pass(head, 1000);
  EXPECT_NEAR(head.yaw(), 1.4, 1e-9);
  EXPECT_EQ(head.yawVelocity(), 0.0);
  head.setFault(TiltFault::kNone);
  pass(head, 1000);
  EXPECT_NEAR(head.yaw(), 0.0, 1e-9);
}

TEST_F(ScanningHeadTest, PositionsNeverJumpAndVelocitiesAreTheirDerivatives) {
  ScanningHead::Config config;
  config.faults = {{TiltFault::kFrozen, 1.0, 1.0},
                   {TiltFault::kNarrowed, 2.5, 1.0},
                   {TiltFault::kTurnedAway, 4.0, 1.0}};
  ScanningHead head(config, kStart);
  double tilt = head.tilt();
  double yaw = head.yaw();
  for (int i = 0; i < 7000; ++i) {
    head.step(now_ += kStep);
    ASSERT_NEAR((head.tilt() - tilt) / 1e-3, head.tiltVelocity(), 0.05) << i;
    ASSERT_NEAR((head.yaw() - yaw) / 1e-3, head.yawVelocity(), 1e-9) << i;
    tilt = head.tilt();
    yaw = head.yaw();
  }
}

TEST_F(ScanningHeadTest, AFaultOfTheScheduleOutweighsOneThatWasSet) {
  ScanningHead::Config config;
  config.faults = {{TiltFault::kFrozen, 1.0, 1.0}};
  ScanningHead head(config, kStart);
  head.setFault(TiltFault::kNarrowed);
  pass(head, 500);
  EXPECT_EQ(head.fault(), TiltFault::kNarrowed);
  pass(head, 1000);
  EXPECT_EQ(head.fault(), TiltFault::kFrozen);
  pass(head, 1000);
  EXPECT_EQ(head.fault(), TiltFault::kNarrowed);
}

TEST_F(ScanningHeadTest, FaultsHaveNamesAndUnknownOnesAreRefused) {
  EXPECT_EQ(tiltFault("none"), TiltFault::kNone);
  EXPECT_EQ(tiltFault("frozen"), TiltFault::kFrozen);
  EXPECT_EQ(tiltFault("narrowed"), TiltFault::kNarrowed);
  EXPECT_EQ(tiltFault("turned_away"), TiltFault::kTurnedAway);
  EXPECT_ANY_THROW((void)tiltFault("broken"));
}

}  // namespace
}  // namespace tccm::simulation
