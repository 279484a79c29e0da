#include "map/held_layer.h"

#include <gtest/gtest.h>

#include <array>
#include <set>
#include <utility>
#include <vector>

#include "support/random.h"

namespace tccm {
namespace {

HeldLayer::Interval interval(CellIndex cell, int bottom, int top) {
  HeldLayer::Interval result;
  result.cell = cell;
  result.heights = {static_cast<Height>(bottom), static_cast<Height>(top)};
  result.points = 4;
  return result;
}

std::vector<std::array<int, 3>> rows(HeldLayer& layer) {
  layer.sort();
  std::vector<std::array<int, 3>> result;
  for (const auto& i : layer.intervals()) {
    result.push_back({static_cast<int>(i.cell), i.heights.bottom, i.heights.top});
  }
  return result;
}

using Rows = std::vector<std::array<int, 3>>;

TEST(HeldLayerTest, WhatIsHeldIsListedByCellFromLowToHigh) {
  HeldLayer layer(10, 8);
  EXPECT_TRUE(layer.intervals().empty());
  for (const auto& i : {interval(7, 10, 20), interval(2, 50, 60), interval(2, 10, 20)}) {
    EXPECT_TRUE(layer.hold(i));
  }
  EXPECT_EQ(rows(layer), (Rows{{2, 10, 20}, {2, 50, 60}, {7, 10, 20}}));
}

TEST(HeldLayerTest, HeightsThatAreSeenAgainAreCutOut) {
  HeldLayer layer(10, 8);
  ASSERT_TRUE(layer.hold(interval(3, 0, 100)));
  ASSERT_TRUE(layer.hold(interval(4, 0, 100)));
  EXPECT_TRUE(layer.seen(3, {40, 60}));
  EXPECT_EQ(rows(layer), (Rows{{3, 0, 40}, {3, 60, 100}, {4, 0, 100}}));
  EXPECT_TRUE(layer.seen(3, {0, 10}));
  EXPECT_TRUE(layer.seen(3, {30, 70}));
  EXPECT_TRUE(layer.seen(4, {-5, 100}));
  EXPECT_TRUE(layer.seen(5, {0, 100}));
  EXPECT_EQ(rows(layer), (Rows{{3, 10, 30}, {3, 70, 100}}));
  EXPECT_EQ(layer.intervals().front().points, 4U);
}

TEST(HeldLayerTest, OfEachIntervalItsOwnHeightsAreCutOutAndWhatIsEmptyCutsNothing) {
  HeldLayer layer(10, 8);
  for (const CellIndex cell : {1U, 2U, 3U}) ASSERT_TRUE(layer.hold(interval(cell, -50, 50)));
  EXPECT_TRUE(layer.cut([](const HeldLayer::Interval& i) {
    return i.cell == 1   ? Columns::Heights{-10, 20}
           : i.cell == 2 ? Columns::Heights{0, 0}
                         : Columns::Heights{-60, 60};
  }));
  EXPECT_EQ(rows(layer), (Rows{{1, -50, -10}, {1, 20, 50}, {2, -50, 50}}));
}

TEST(HeldLayerTest, WhatIsReleasedIsGone) {
  HeldLayer layer(10, 8);
  for (const int bottom : {0, 20, 40}) ASSERT_TRUE(layer.hold(interval(1, bottom, bottom + 10)));
  layer.releaseIf([](const HeldLayer::Interval& i) { return i.heights.bottom == 20; });
  EXPECT_EQ(rows(layer), (Rows{{1, 0, 10}, {1, 40, 50}}));
  layer.clear();
  EXPECT_TRUE(layer.intervals().empty());
  EXPECT_TRUE(layer.seen(1, {0, 100}));
}

TEST(HeldLayerTest, WhereThereIsNoRoomItSaysSo) {
  HeldLayer layer(10, 2);
  EXPECT_TRUE(layer.hold(interval(1, 0, 100)));
  EXPECT_TRUE(layer.hold(interval(2, 0, 100)));
  EXPECT_FALSE(layer.hold(interval(3, 0, 100)));
  EXPECT_FALSE(layer.seen(1, {40, 60})) << "one of two pieces has no room";
  EXPECT_EQ(layer.intervals().size(), 2U);
}

TEST(HeldLayerTest, RandomCutsLeaveTheHeightsThatWereNotSeen) {
  test::Random random(3);
  HeldLayer layer(4, 1000);
  std::set<std::pair<int, int>> held;  // cell and quantum
  for (int step = 0; step < 2000; ++step) {
    const int c = random.integer(0, 3), a = random.integer(0, 200);
    const int b = a + random.integer(1, 20);
    bool is_free = true;
    for (int h = a; h < b; ++h) is_free = is_free && held.count({c, h}) == 0;
    if (step % 2 == 0 && is_free) {
      ASSERT_TRUE(layer.hold(interval(static_cast<CellIndex>(c), a, b)));
      for (int h = a; h < b; ++h) held.insert({c, h});
    } else {
      ASSERT_TRUE(
          layer.seen(static_cast<CellIndex>(c), {static_cast<Height>(a), static_cast<Height>(b)}));
      for (int h = a; h < b; ++h) held.erase({c, h});
    }
    std::set<std::pair<int, int>> listed;
    for (const auto& i : layer.intervals()) {
      for (int h = i.heights.bottom; h < i.heights.top; ++h) {
        ASSERT_TRUE(listed.insert({static_cast<int>(i.cell), h}).second) << "held twice";
      }
    }
    ASSERT_EQ(listed, held) << step;
  }
}

}  // namespace
}  // namespace tccm
