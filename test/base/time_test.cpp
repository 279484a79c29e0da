#include "tccm_monitor/time.h"

#include <gtest/gtest.h>

namespace tccm {
namespace {

TEST(TimeTest, SecondsBecomeTheNearestNanosecond) {
  EXPECT_EQ(fromSeconds(1.5), Duration(1500000000));
  EXPECT_EQ(fromSeconds(0.0), Duration(0));
  EXPECT_EQ(fromSeconds(-0.25), Duration(-250000000));
  EXPECT_EQ(fromSeconds(1.4e-9), Duration(1));
  EXPECT_EQ(fromSeconds(1.6e-9), Duration(2));
  EXPECT_EQ(fromSeconds(0.028), Duration(28000000));
}

TEST(TimeTest, DurationsComeBackAsSeconds) {
  for (const double seconds : {0.0, 1e-9, 0.028, 1.575, -3.25, 86400.0}) {
    EXPECT_NEAR(toSeconds(fromSeconds(seconds)), seconds, 1e-9);
  }
}

TEST(TimeTest, AWallClockStampIsSecondsSinceTheEpochToAMicrosecond) {
  const Time time(Duration(1700000000123456789LL));
  EXPECT_NEAR(toSeconds(time), 1700000000.123456789, 1e-6);
}

TEST(TimeTest, StampsKeepTheirNanosecondsThroughArithmetic) {
  const Time time(Duration(1700000000123456789LL));
  EXPECT_EQ((time + fromSeconds(0.1)) - time, Duration(100000000));
  EXPECT_LT(time, time + Duration(1));
}

}  // namespace
}  // namespace tccm
