#include "robot/joint_track.h"

#include <gtest/gtest.h>

#include <cmath>

namespace tccm {
namespace {

Time at(double seconds) { return Time(fromSeconds(seconds)); }

TEST(JointTrackTest, TheUsualSpeedOfTwoThatTakeTurnsIsThatOfEach) {
  JointTrack track(100, false);
  EXPECT_EQ(track.usualSpeed(), 0.0);
  for (int k = 0; k < 20; ++k) {
    track.add({at(0.01 * k), k % 2 == 0 ? 0.0 : 1.0 + 0.003 * k, 0.0, 0});
  }
  EXPECT_LT(track.usualSpeed(), 0.31);
}

TEST(JointTrackTest, TheUsualSpeedOfOneIsItsSpeedWhateverItsDirection) {
  JointTrack track(100, false);
  for (int k = 0; k < 20; ++k) track.add({at(0.01 * k), -0.02 * k, 0.0, 0});
  EXPECT_NEAR(track.usualSpeed(), 2.0, 1e-9);
}

TEST(JointTrackTest, OneSampleHasNoSlope) {
  JointTrack track(10, false);
  track.add({at(1.0), 0.5, 0.0, 0});
  EXPECT_EQ(track.differentiate(0.03, 0.1).over_s, 0.0);
  EXPECT_EQ(track.before(at(0.9)), nullptr);
  ASSERT_NE(track.before(at(1.5)), nullptr);
  EXPECT_EQ(track.before(at(1.5))->position, 0.5);
}

TEST(JointTrackTest, WhatTurnsFreelyMovesTheShortWay) {
  JointTrack free(10, true);
  const JointTrack limited(10, false);
  EXPECT_NEAR(free.moved(3.1, -3.1), 2.0 * M_PI - 6.2, 1e-12);
  EXPECT_NEAR(limited.moved(3.1, -3.1), -6.2, 1e-12);
  free.add({at(1.0), 3.1, 0.0, 0});
  free.add({at(1.1), -3.1, 0.0, 0});
  EXPECT_NEAR(std::abs(*free.at(at(1.05), 0.2)), M_PI, 1e-9);
  EXPECT_FALSE(free.at(at(1.05), 0.05));
}

}  // namespace
}  // namespace tccm
