#include "check/column_span.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "support/random.h"

namespace tccm {
namespace {

constexpr int kColumns = 24;

/// How far apart two columns are, the shorter way round.
int between(int a, int b) {
  const int ahead = std::abs(a - b) % kColumns;
  return std::min(ahead, kColumns - ahead);
}

/// In a window of any place and width, whatever the rows before were.
TEST(ColumnSpanTest, EachRowsColumnsAreVisitedInTheOrderOfTheWindow) {
  test::Random random(1);
  for (int scene = 0; scene < 300; ++scene) {
    const bool is_round = random.chance(0.5);
    const int begin = is_round ? 0 : random.integer(0, kColumns - 1);
    const int end = is_round ? kColumns : begin + random.integer(1, kColumns / 2);
    const int middle = random.integer(begin, end - 1) % kColumns;
    ColumnSpan span(begin, end, middle, kColumns);
    for (int row = 0; row < 10; ++row) {
      const int reach = random.integer(0, kColumns / 2 + 1);  // 0: none
      const auto isNear = [&](int column) { return between(column, middle) < reach; };
      std::vector<int> expected, visited;
      for (int c = begin; c < end; ++c) {
        if (isNear(c % kColumns)) expected.push_back(c % kColumns);
      }
      span.fit(isNear);
      span.visit([&](int first, int last) {
        for (int column = first; column < last; ++column) visited.push_back(column);
      });
      EXPECT_EQ(visited, expected) << scene << ": " << row;
    }
  }
}

}  // namespace
}  // namespace tccm
