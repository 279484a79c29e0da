#include "permission_gate.h"

#include <gtest/gtest.h>

#include <limits>

namespace tccm::example {
namespace {

using tccm_monitor::MotionPermission;

constexpr double kStart = 1000.0;     // on the clock of stamps [s]
constexpr double kSteady = 5.0;       // on the steady clock, at the same time
constexpr double kValidity = 0.05;    // [s]
constexpr double kFutureMax = 0.025;  // [s]

Instant at(double elapsed) {
  return {ros::Time(kStart + elapsed), ros::SteadyTime(kSteady + elapsed)};
}

MotionPermission permission(std::uint32_t sequence, double elapsed) {
  MotionPermission message;
  message.header.stamp = ros::Time(kStart + elapsed);
  message.sequence = sequence;
  message.valid_until = ros::Time(kStart + elapsed + kValidity);
  message.level = MotionPermission::OK;
  message.permitted = true;
  message.speed_scale = 1.0;
  return message;
}

class PermissionGateTest : public ::testing::Test {
 protected:
  void hear(const MotionPermission& message, double elapsed) { gate_.hear(message, at(elapsed)); }
  [[nodiscard]] bool permits(double elapsed) const { return gate_.objection(at(elapsed)).empty(); }
  /// Once that permission is heard, as fresh as it can be.
  [[nodiscard]] bool permitsAfter(std::uint32_t sequence, double elapsed) {
    hear(permission(sequence, elapsed), elapsed);
    return permits(elapsed);
  }

  PermissionGate gate_{kFutureMax};
};

TEST_F(PermissionGateTest, NothingIsPermittedBeforeAPermissionIsHeard) {
  EXPECT_FALSE(permits(0.0));
  hear(permission(1, 0.0), 0.0);
  EXPECT_TRUE(permits(0.0));
  EXPECT_EQ(gate_.speedScale(), 1.0);
}

TEST_F(PermissionGateTest, OKAndSLOWPermitAndNothingElseDoes) {
  for (std::uint8_t level = 0; level <= MotionPermission::FAULT + 1; ++level) {
    for (const bool permitted : {false, true}) {
      PermissionGate gate;
      MotionPermission message = permission(1, 0.0);
      message.level = level;
      message.permitted = permitted;
      gate.hear(message, at(0.0));
      EXPECT_EQ(gate.objection(at(0.0)).empty(), permitted && level <= MotionPermission::SLOW)
          << int{level};
    }
  }
}

TEST_F(PermissionGateTest, TheObjectionNamesTheGravestReason) {
  MotionPermission message = permission(1, 0.0);
  message.permitted = false;
  message.reasons = {"COLLISION", "OCCLUSION"};
  message.detail = "hand touches the map";
  hear(message, 0.0);
  EXPECT_EQ(gate_.objection(at(0.0)), "not permitted: COLLISION, hand touches the map");
}

TEST_F(PermissionGateTest, APermissionExpiresOnTheClockOfStamps) {
  hear(permission(1, 0.0), 0.0);
  const Instant fast{ros::Time(kStart + 0.051), ros::SteadyTime(kSteady + 0.001)};
  EXPECT_FALSE(gate_.objection(fast).empty());
  const Instant in_time{ros::Time(kStart + 0.05), ros::SteadyTime(kSteady + 0.001)};
  EXPECT_TRUE(gate_.objection(in_time).empty());
}

TEST_F(PermissionGateTest, SilenceCountsWhereTheClockOfStampsStandsStill) {
  hear(permission(1, 0.0), 0.0);
  EXPECT_TRUE(gate_.objection({ros::Time(kStart), ros::SteadyTime(kSteady + 0.049)}).empty());
  EXPECT_FALSE(gate_.objection({ros::Time(kStart), ros::SteadyTime(kSteady + 0.051)}).empty());
}

TEST_F(PermissionGateTest, TheSameStampAgainIsNoNews) {
  for (std::uint32_t i = 1; i <= 5; ++i) {
    const Instant now{ros::Time(kStart), ros::SteadyTime(kSteady + 0.02 * i)};
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
  EXPECT_FALSE(permits(0.04));
}

TEST_F(PermissionGateTest, AStampMayBeAheadByAsMuchAsClocksDiffer) {
  hear(permission(1, 0.02), 0.0);
  EXPECT_TRUE(permits(0.0));
  hear(permission(2, 0.05), 0.02);
  EXPECT_FALSE(permits(0.02));
}

TEST_F(PermissionGateTest, AStampFromTheFuturePermitsNothingForLonger) {
  hear(permission(1, 0.02), 0.0);
  EXPECT_FALSE(permits(0.051));
}

TEST_F(PermissionGateTest, ASpeedScaleThatIsNoSharePermitsNothing) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double scale : {0.0, -0.5, 1.01, nan, std::numeric_limits<double>::infinity()}) {
    PermissionGate gate;
    MotionPermission message = permission(1, 0.0);
    message.speed_scale = scale;
    gate.hear(message, at(0.0));
    EXPECT_FALSE(gate.objection(at(0.0)).empty()) << scale;
  }
}

TEST_F(PermissionGateTest, APermissionThatEndsBeforeItBeginsPermitsNothing) {
  MotionPermission message = permission(1, 0.0);
  message.valid_until = ros::Time();
  hear(message, 0.0);
  EXPECT_FALSE(permits(0.0));
  message.valid_until = ros::TIME_MAX;
  message.header.stamp = ros::Time();  // a difference that no ros::Duration holds
  PermissionGate other;
  other.hear(message, at(0.0));
  EXPECT_NO_THROW((void)other.objection(at(0.0)));
}

}  // namespace
}  // namespace tccm::example
