#include "base/duration_text.h"

#include <gtest/gtest.h>

namespace tccm {
namespace {

std::string text(double seconds) { return durationText(fromSeconds(seconds)); }

TEST(DurationTextTest, TwoOrThreeDigitsInTheUnitThatFits) {
  EXPECT_EQ(text(0.0), "0 ms");
  EXPECT_EQ(text(0.0354), "35 ms");
  EXPECT_EQ(text(1.5), "1500 ms");
  EXPECT_EQ(text(2.54), "2.5 s");
  EXPECT_EQ(text(90.0), "90 s");
  EXPECT_EQ(text(600.0), "10 min");
  EXPECT_EQ(text(3.0 * 3600.0), "3.0 h");
  EXPECT_EQ(text(4.2 * 86400.0), "4.2 days");
  EXPECT_EQ(text(1.7e9), "54 years");
}

TEST(DurationTextTest, AStampIsToldByHowFarItIsOff) {
  const Time now(fromSeconds(1.7e9));
  EXPECT_NE(stampText(Time(), now).find("is 0"), std::string::npos);
  EXPECT_EQ(stampText(now - fromSeconds(7200.0), now),
            "its stamp is 2.0 h behind the monitor's clock");
  EXPECT_EQ(stampText(now + fromSeconds(3.0), now),
            "its stamp is 3.0 s ahead of the monitor's clock");
}

}  // namespace
}  // namespace tccm
