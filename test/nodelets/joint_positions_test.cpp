#include "nodelets/joint_positions.h"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

namespace tccm {
namespace {

Time at(double seconds) { return Time(fromSeconds(seconds)); }

class JointPositionsTest : public ::testing::Test {
 protected:
  void hear(double stamp_s, double position, double now_s) {
    message_.position = {position};
    joints_.hear(message_, at(stamp_s), at(now_s));
  }
  void hear(double stamp_s, double position) { hear(stamp_s, position, stamp_s); }

  JointPositionsTest() { message_.name = {"elbow"}; }

  sensor_msgs::JointState message_;
  JointPositions joints_;
  const JointPositions::Joint& elbow_ = *joints_.watch("elbow");
};

TEST_F(JointPositionsTest, AJointWithItsVelocityIsKnownAtOnce) {
  EXPECT_FALSE(elbow_.is_known);
  message_.velocity = {0.3};
  hear(10.0, 1.0);
  EXPECT_TRUE(elbow_.is_known && elbow_.tells_velocity);
  EXPECT_EQ(elbow_.position, 1.0);
  EXPECT_EQ(elbow_.velocity, 0.3);
  EXPECT_EQ(elbow_.stamp, at(10.0));
}

TEST_F(JointPositionsTest, WithoutAVelocityItIsKnownWithItsSecondPosition) {
  hear(10.0, 1.0);
  EXPECT_FALSE(elbow_.is_known) << "it may move";
  hear(10.1, 1.05);
  EXPECT_TRUE(elbow_.is_known);
  EXPECT_FALSE(elbow_.tells_velocity);
  EXPECT_NEAR(elbow_.velocity, 0.5, 1e-9);
}

TEST_F(JointPositionsTest, AStampOfTheFutureNeitherCountsNorKeepsLaterOnesOut) {
  message_.velocity = {0.0};
  hear(10.0, 1.0);
  hear(20.0, 2.0, 10.01);
  EXPECT_EQ(elbow_.stamp, at(10.0));
  hear(10.02, 1.5);
  EXPECT_EQ(elbow_.position, 1.5);
  hear(10.06, 1.6, 10.03);  // clocks may differ by a little
  EXPECT_EQ(elbow_.position, 1.6);
}

TEST_F(JointPositionsTest, WhatIsOldOrNoNumberSaysNothing) {
  message_.velocity = {0.0};
  hear(10.0, 1.0);
  hear(9.9, 2.0, 10.01);
  hear(10.1, std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(elbow_.position, 1.0);
  EXPECT_EQ(elbow_.stamp, at(10.0));
}

TEST_F(JointPositionsTest, AfterAClearNothingIsKnown) {
  message_.velocity = {0.0};
  hear(10.0, 1.0);
  joints_.clear();
  EXPECT_FALSE(elbow_.is_known);
  message_.velocity.clear();
  hear(5.0, 1.0);
  EXPECT_FALSE(elbow_.is_known) << "the velocity before time jumped is none";
}

TEST_F(JointPositionsTest, WhereJointsAreNowIsOnlyKnownFromWhatIsFresh) {
  message_.velocity = {0.5};
  hear(10.0, 1.0);
  std::vector<double> positions, velocities;
  EXPECT_TRUE(JointPositions::expect({&elbow_}, at(10.08), 0.1, positions, velocities));
  ASSERT_EQ(positions.size(), 1U);
  EXPECT_NEAR(positions[0], 1.04, 1e-9) << "it went on";
  EXPECT_EQ(velocities, std::vector<double>{0.5});
  EXPECT_TRUE(JointPositions::expect({&elbow_}, at(9.98), 0.1, positions, velocities));
  EXPECT_EQ(positions, std::vector<double>{1.0}) << "stamped a little later than now";
  EXPECT_FALSE(JointPositions::expect({&elbow_}, at(10.12), 0.1, positions, velocities));
  EXPECT_TRUE(positions.empty() && velocities.empty());
  const JointPositions::Joint& never_heard_of = *joints_.watch("wrist");
  EXPECT_FALSE(
      JointPositions::expect({&elbow_, &never_heard_of}, at(10.0), 0.1, positions, velocities));
  EXPECT_TRUE(positions.empty() && velocities.empty());
}

}  // namespace
}  // namespace tccm
