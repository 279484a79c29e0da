#include "ros/stop_cause.h"

#include <gtest/gtest.h>

namespace tccm {
namespace {

Verdict at(double time_s, Level level, Reason reason) {
  Verdict verdict;
  verdict.stamp = Time(fromSeconds(time_s));
  verdict.level = level;
  verdict.reason = reason;
  verdict.stop = level >= Level::kStop;
  return verdict;
}

bool isNews(ToldChanges& told, double time_s, Level level, Reason reason) {
  return told.isNews(at(time_s, level, reason));
}

TEST(ToldChangesTest, AStopForWhatSlowedTheRobotBeforeIsTold) {
  ToldChanges told;
  EXPECT_TRUE(isNews(told, 1.00, Level::kOk, Reason::kClear));
  EXPECT_FALSE(isNews(told, 1.01, Level::kOk, Reason::kClear));
  EXPECT_TRUE(isNews(told, 1.02, Level::kSlow, Reason::kCollisionAhead));
  EXPECT_TRUE(isNews(told, 1.03, Level::kStop, Reason::kCollisionAhead));
  EXPECT_FALSE(isNews(told, 1.04, Level::kStop, Reason::kCollisionAhead));
  EXPECT_TRUE(isNews(told, 1.05, Level::kStop, Reason::kReleasing));
  EXPECT_TRUE(isNews(told, 1.06, Level::kOk, Reason::kClear));
}

TEST(ToldChangesTest, AContactThatComesAndGoesIsToldOncePerStop) {
  ToldChanges told;
  int count = 0;
  for (int i = 0; i < 1000; ++i) {
    const Reason reason = i % 4 < 2 ? Reason::kCollision : Reason::kAwaitingReset;
    count += isNews(told, 1.0 + 0.1 * i, Level::kStop, reason) ? 1 : 0;
  }
  EXPECT_EQ(count, 2);
  EXPECT_TRUE(isNews(told, 102.0, Level::kOk, Reason::kClear));
  EXPECT_TRUE(isNews(told, 102.1, Level::kStop, Reason::kCollision)) << "another stop";
}

TEST(ToldChangesTest, WhatFlickersIsToldOnceAndWhatStaysIsTold) {
  ToldChanges told;
  int count = 0;
  for (int i = 0; i < 100; ++i) {
    const bool is_slow = i % 2 == 1;
    count += isNews(told, 1.0 + 0.02 * i, is_slow ? Level::kSlow : Level::kOk,
                    is_slow ? Reason::kUnseenAhead : Reason::kClear)
                 ? 1
                 : 0;
  }
  EXPECT_EQ(count, 2);
  EXPECT_FALSE(isNews(told, 3.0, Level::kOk, Reason::kClear));
  EXPECT_FALSE(isNews(told, 3.9, Level::kOk, Reason::kClear));
  EXPECT_TRUE(isNews(told, 4.1, Level::kOk, Reason::kClear)) << "the last line is true";
  EXPECT_TRUE(isNews(told, 9.0, Level::kSlow, Reason::kUnseenAhead));
}

TEST(ToldChangesTest, WhatComesBackAfterASecondIsToldAnew) {
  ToldChanges told;
  EXPECT_TRUE(isNews(told, 1.0, Level::kFault, Reason::kNoJoints));
  for (int i = 0; i < 20; ++i) {
    EXPECT_EQ(isNews(told, 1.1 + 0.1 * i, Level::kStop, Reason::kAwaitingReset), i == 0);
  }
  EXPECT_TRUE(isNews(told, 3.1, Level::kFault, Reason::kNoJoints));
}

TEST(ToldChangesTest, TimeThatJumpsBackHidesNothing) {
  ToldChanges told;
  EXPECT_TRUE(isNews(told, 100.0, Level::kFault, Reason::kNoMap));
  EXPECT_TRUE(isNews(told, 100.1, Level::kStop, Reason::kReleasing));
  EXPECT_TRUE(isNews(told, 1.0, Level::kFault, Reason::kNoMap));
}

}  // namespace
}  // namespace tccm
