#include "tccm_monitor/config_error.h"

#include <gtest/gtest.h>

#include <limits>

namespace tccm {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

TEST(ConfigErrorTest, ValuesInsideAndOnTheLimitsPass) {
  EXPECT_NO_THROW(requireInRange("cell_size_m", 0.5, 0.0, 1.0));
  EXPECT_NO_THROW(requireInRange("cell_size_m", 0.0, 0.0, 1.0));
  EXPECT_NO_THROW(requireInRange("cell_size_m", 1.0, 0.0, 1.0));
}

TEST(ConfigErrorTest, ValuesOutsideNaNAndInfinityAreRefused) {
  for (const double value : {-1e-9, 1.0 + 1e-9, kNaN, kInfinity, -kInfinity}) {
    EXPECT_THROW(requireInRange("cell_size_m", value, 0.0, 1.0), ConfigError) << value;
  }
}

TEST(ConfigErrorTest, TheMessageNamesKeyValueAndRangeInOneLine) {
  try {
    requireInRange("cell_size_m", 7.0, 0.25, 1.5);
    FAIL() << "nothing was thrown";
  } catch (const ConfigError& error) {
    const std::string text = error.what();
    for (const char* part : {"cell_size_m", "7", "0.25", "1.5"}) {
      EXPECT_NE(text.find(part), std::string::npos) << part << " is missing in: " << text;
    }
    EXPECT_EQ(text.find('\n'), std::string::npos);
  }
}

}  // namespace
}  // namespace tccm
