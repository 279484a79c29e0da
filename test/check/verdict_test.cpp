#include "tccm_monitor/verdict.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

namespace tccm {
namespace {

std::vector<Reason> allReasons() {
  std::vector<Reason> reasons;
  for (int i = 0; i <= static_cast<int>(Reason::kBadQuestion); ++i) {
    reasons.push_back(static_cast<Reason>(i));
  }
  return reasons;
}

TEST(VerdictTest, EveryReasonHasANameOfItsOwnInCapitals) {
  std::set<std::string> names;
  for (const Reason reason : allReasons()) {
    const std::string text = name(reason);
    EXPECT_EQ(text.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZ_"), std::string::npos) << text;
    EXPECT_NE(text, "UNKNOWN");
    EXPECT_TRUE(names.insert(text).second) << text;
  }
}

TEST(VerdictTest, NamesAreThoseOfTheirReasons) {
  EXPECT_STREQ(name(Reason::kClear), "CLEAR");
  EXPECT_STREQ(name(Reason::kUnseenAhead), "UNSEEN_AHEAD");
  EXPECT_STREQ(name(Reason::kInit), "INIT");
  EXPECT_STREQ(name(Reason::kCollision), "COLLISION");
  EXPECT_STREQ(name(Reason::kMapLate), "MAP_LATE");
  EXPECT_STREQ(name(Reason::kFuture), "FUTURE_STAMP");
  EXPECT_STREQ(name(Reason::kBadQuestion), "BAD_QUESTION");
}

TEST(VerdictTest, OnlyClearIsOk) {
  for (const Reason reason : allReasons()) {
    EXPECT_EQ(levelOf(reason) == Level::kOk, reason == Reason::kClear) << name(reason);
  }
}

TEST(VerdictTest, LaterReasonsAreNoBetterThanEarlierOnes) {
  const auto reasons = allReasons();
  for (std::size_t i = 0; i + 1 < reasons.size(); ++i) {
    EXPECT_LE(levelOf(reasons[i]), levelOf(reasons[i + 1])) << name(reasons[i]);
  }
}

TEST(VerdictTest, WhatIsFoundStopsAndWhatIsMissingIsAFault) {
  EXPECT_EQ(levelOf(Reason::kCollision), Level::kStop);
  EXPECT_EQ(levelOf(Reason::kOcclusionAhead), Level::kStop);
  EXPECT_EQ(levelOf(Reason::kInit), Level::kStop);
  EXPECT_EQ(levelOf(Reason::kNoMap), Level::kFault);
  EXPECT_EQ(levelOf(Reason::kNoJoints), Level::kFault);
  EXPECT_EQ(levelOf(Reason::kBadQuestion), Level::kFault);
}

TEST(VerdictTest, AVerdictThatNobodyFilledInStopsAndKnowsNothing) {
  const Verdict verdict;
  EXPECT_TRUE(verdict.stop);
  EXPECT_FALSE(verdict.known);
  EXPECT_NE(verdict.level, Level::kOk);
  EXPECT_NE(verdict.reason, Reason::kClear);
}

}  // namespace
}  // namespace tccm
