#include "map/return_counts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "support/random.h"

namespace tccm {
namespace {

Grid smallGrid() {
  Grid::Config config;
  config.size_x_m = 0.06;
  config.size_y_m = 0.04;
  config.height_min_m = -0.105;
  config.height_max_m = 0.2;
  return Grid(config);
}

TEST(ReturnCountsTest, AReturnCountsInItsLayerUntilItIsRemoved) {
  ReturnCounts counts(smallGrid(), 10);
  counts.add(2, 50);
  counts.add(2, 51);
  EXPECT_EQ(counts.sum(2, 50, 51), 2U);
  EXPECT_EQ(counts.sum(1, 50, 51), 0U);
  counts.remove(2, 50);
  EXPECT_EQ(counts.sum(2, 50, 51), 1U);
  counts.remove(2, 51);
  EXPECT_EQ(counts.sum(2, -105, 200), 0U);
}

TEST(ReturnCountsTest, TheLowestAndTheHighestHeightOfTheAreaHaveALayer) {
  ReturnCounts counts(smallGrid(), 10);
  counts.add(0, -105);
  counts.add(5, 200);
  EXPECT_EQ(counts.sum(0, -105, -105), 1U);
  EXPECT_EQ(counts.sum(5, 200, 200), 1U);
}

TEST(ReturnCountsTest, ClearingForgetsAll) {
  ReturnCounts counts(smallGrid(), 10);
  counts.add(3, 20);
  counts.clear();
  EXPECT_EQ(counts.sum(3, -105, 200), 0U);
}

TEST(ReturnCountsTest, RandomSumsAreThoseOfAllReturnsInTheLayersTouched) {
  test::Random random(33);
  const Grid grid = smallGrid();
  for (const Height layer : std::initializer_list<Height>{1, 7, 10, 500}) {
    ReturnCounts counts(grid, layer);
    std::vector<std::pair<CellIndex, Height>> returns;
    for (int step = 0; step < 3000; ++step) {
      if (!returns.empty() && random.chance(0.45)) {
        const auto k =
            static_cast<std::ptrdiff_t>(random.integer(0, static_cast<int>(returns.size()) - 1));
        counts.remove(returns[static_cast<std::size_t>(k)].first,
                      returns[static_cast<std::size_t>(k)].second);
        returns.erase(returns.begin() + k);
      } else {
        returns.emplace_back(random.integer(0, static_cast<int>(grid.cells()) - 1),
                             random.integer(-105, 200));
        counts.add(returns.back().first, returns.back().second);
      }
      const auto cell = static_cast<CellIndex>(random.integer(0, 5));
      const int low = random.integer(-105, 200), high = random.integer(low, 200);
      const auto layerOf = [&](int height) { return (height + 105) / layer; };
      const auto expected = std::count_if(returns.begin(), returns.end(), [&](const auto& entry) {
        return entry.first == cell && layerOf(entry.second) >= layerOf(low) &&
               layerOf(entry.second) <= layerOf(high);
      });
      ASSERT_EQ(counts.sum(cell, static_cast<Height>(low), static_cast<Height>(high)), expected);
    }
  }
}

}  // namespace
}  // namespace tccm
