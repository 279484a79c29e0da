#include "gate/permission_gate.h"

#include <gtest/gtest.h>

#include <limits>

namespace tccm {
namespace {

constexpr double kStart = 1000.0;     // on the clock of stamps [s]
constexpr double kSteady = 5.0;       // on the steady clock, at the same time
constexpr double kValidity = 0.05;    // [s]
constexpr double kFutureMax = 0.025;  // [s]

Instant at(double stamp_s, double steady_s) {
  return {Time(fromSeconds(kStart + stamp_s)), fromSeconds(kSteady + steady_s)};
}
Instant at(double elapsed_s) { return at(elapsed_s, elapsed_s); }

HeardPermission permission(std::uint32_t sequence, double elapsed_s) {
  HeardPermission heard;
  heard.stamp = at(elapsed_s).stamp;
  heard.valid_until = at(elapsed_s + kValidity).stamp;
  heard.sequence = sequence;
  heard.permitted = true;
  heard.speed_scale = 1.0;
  return heard;
}

class PermissionGateTest : public ::testing::Test {
 protected:
  void hear(const HeardPermission& heard, double elapsed_s) { gate_.hear(heard, at(elapsed_s)); }
  [[nodiscard]] bool permits(double elapsed_s) const {
    return gate_.objection(at(elapsed_s)).empty();
  }
  /// Once that permission is heard, as fresh as it can be.
  [[nodiscard]] bool permitsAfter(std::uint32_t sequence, double elapsed_s) {
    hear(permission(sequence, elapsed_s), elapsed_s);
    return permits(elapsed_s);
  }

  PermissionGate gate_{fromSeconds(kFutureMax)};
};

TEST_F(PermissionGateTest, NothingIsPermittedBeforeAPermissionIsHeard) {
  EXPECT_FALSE(permits(0.0));
  hear(permission(1, 0.0), 0.0);
  EXPECT_TRUE(permits(0.0));
  EXPECT_EQ(gate_.speedScale(), 1.0);
}

TEST_F(PermissionGateTest, WhatIsNotPermittedIsToldWithItsReason) {
  HeardPermission heard = permission(1, 0.0);
  heard.permitted = false;
  heard.why = "COLLISION, hand touches the map";
  hear(heard, 0.0);
  EXPECT_EQ(gate_.objection(at(0.0)), "not permitted: COLLISION, hand touches the map");
}

TEST_F(PermissionGateTest, APermissionExpiresOnTheClockOfStamps) {
  hear(permission(1, 0.0), 0.0);
  EXPECT_EQ(gate_.objection(at(0.051, 0.001)), "the permission has expired");
  EXPECT_TRUE(gate_.objection(at(0.05, 0.001)).empty());
}

TEST_F(PermissionGateTest, SilenceCountsWhereTheClockOfStampsStandsStill) {
  hear(permission(1, 0.0), 0.0);
  EXPECT_TRUE(gate_.objection(at(0.0, 0.049)).empty());
  EXPECT_EQ(gate_.objection(at(0.0, 0.051)), "no new permission is heard");
}

TEST_F(PermissionGateTest, TheSameStampAgainIsNoNews) {
  for (std::uint32_t i = 1; i <= 5; ++i) {
    const Instant now = at(0.0, 0.02 * i);
    gate_.hear(permission(i, 0.0), now);
    EXPECT_EQ(gate_.objection(now).empty(), i <= 3) << i;  // 0.06 s after the first
  }
}

TEST_F(PermissionGateTest, ASequenceThatStandsStillOrFallsPermitsNothing) {
  hear(permission(7, 0.0), 0.0);
  EXPECT_FALSE(permitsAfter(7, 0.02));
  EXPECT_TRUE(permitsAfter(8, 0.04));
  EXPECT_FALSE(permitsAfter(1, 0.06));
}

TEST_F(PermissionGateTest, ACheckerThatBeganAnewPermitsFromItsSecondMessageOn) {
  hear(permission(4000, 0.0), 0.0);
  EXPECT_FALSE(permitsAfter(1, 0.02));
  EXPECT_TRUE(permitsAfter(2, 0.04));
}

TEST_F(PermissionGateTest, TheSequenceMayLeaveOutNumbersAndWrapAround) {
  hear(permission(std::numeric_limits<std::uint32_t>::max() - 1, 0.0), 0.0);
  EXPECT_TRUE(permitsAfter(3, 0.02));
}

TEST_F(PermissionGateTest, AStampThatGoesBackPermitsNothing) {
  hear(permission(1, 0.03), 0.03);
  hear(permission(2, 0.01), 0.04);
  EXPECT_EQ(gate_.objection(at(0.04)), "the permission's stamp goes back");
}

TEST_F(PermissionGateTest, AStampMayBeALittleAheadAndNoMore) {
  hear(permission(1, 0.024), 0.0);
  EXPECT_TRUE(permits(0.0));
  hear(permission(2, 0.026), 0.0);
  EXPECT_EQ(gate_.objection(at(0.0)), "the permission's stamp lies in the future");
}

TEST_F(PermissionGateTest, OnlyAScaleAbove0AndUpTo1Permits) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  std::uint32_t sequence = 0;
  for (const double scale : {0.0, -0.5, 1.01, nan, 0.01, 1.0}) {
    HeardPermission heard = permission(++sequence, 0.0);
    heard.speed_scale = scale;
    hear(heard, 0.0);
    EXPECT_EQ(permits(0.0), scale == 0.01 || scale == 1.0) << scale;
  }
}

}  // namespace
}  // namespace tccm
