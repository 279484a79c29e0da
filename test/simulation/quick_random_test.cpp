#include "simulation/quick_random.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace tccm::simulation {
namespace {

TEST(QuickRandomTest, IsTheGeneratorPublished) {
  // The state that the reference's splitmix64 makes of the seed 0 begins with 0xe220a8397b1dcdaf.
  QuickRandom random(0);
  const std::uint64_t a = 0xe220a8397b1dcdafULL, d = 0xf88bb8a8724c81ecULL;
  const std::uint64_t sum = a + d;
  EXPECT_EQ(random(), (sum << 23 | sum >> 41) + a);
}

TEST(QuickRandomTest, TheSameSeedGivesTheSameNumbersAndAnotherOthers) {
  QuickRandom one(7), same(7), other(8);
  for (int i = 0; i < 100; ++i) {
    const std::uint64_t number = one();
    EXPECT_EQ(number, same());
    EXPECT_NE(number, other());
  }
}

TEST(QuickRandomTest, UniformNumbersFillTheirRangeEvenly) {
  QuickRandom random(1);
  std::array<int, 10> counts{};
  for (int i = 0; i < 100000; ++i) {
    const double number = random.uniform();
    ASSERT_GE(number, 0.0);
    ASSERT_LT(number, 1.0);
    ++counts[static_cast<std::size_t>(10.0 * number)];
  }
  for (const int count : counts) EXPECT_NEAR(count, 10000, 400);
}

TEST(QuickNormalTest, HasTheMomentsAndTheTailsOfANormalDistribution) {
  QuickRandom random(2);
  const QuickNormal normal;
  constexpr int kCount = 2000000;
  double sum = 0.0, squares = 0.0, fourths = 0.0;
  std::array<int, 5> beyond{};  // 0 to 4 deviations
  for (int i = 0; i < kCount; ++i) {
    const double x = static_cast<double>(normal(random));
    sum += x;
    squares += x * x;
    fourths += x * x * x * x;
    for (std::size_t k = 0; k < beyond.size(); ++k) {
      beyond[k] += x > static_cast<double>(k) ? 1 : 0;
    }
  }
  EXPECT_NEAR(sum / kCount, 0.0, 0.003);
  EXPECT_NEAR(squares / kCount, 1.0, 0.005);
  EXPECT_NEAR(fourths / kCount, 3.0, 0.05);
  for (std::size_t k = 0; k < beyond.size(); ++k) {
    const double expected = 0.5 * std::erfc(static_cast<double>(k) / std::sqrt(2.0)) * kCount;
    EXPECT_NEAR(beyond[k], expected, 5.0 * std::sqrt(expected) + 1.0) << k;
  }
}

}  // namespace
}  // namespace tccm::simulation
