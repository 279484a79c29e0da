#include "map/held_layer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <set>
#include <utility>
#include <vector>

#include "support/random.h"

namespace tccm {
namespace {

constexpr CellIndex kCells = 10;

HeldLayer::Interval interval(CellIndex cell, int bottom, int top) {
  HeldLayer::Interval result;
  result.cell = cell;
  result.heights = {static_cast<Height>(bottom), static_cast<Height>(top)};
  result.points = 4;
  return result;
}

std::vector<std::array<int, 3>> rows(const HeldLayer& layer) {
  std::vector<std::array<int, 3>> result;
  layer.visit(0, kCells - 1, [&](const HeldLayer::Interval& i) {
    result.push_back({static_cast<int>(i.cell), i.heights.bottom, i.heights.top});
  });
  return result;
}

using Rows = std::vector<std::array<int, 3>>;

std::uint64_t askOfAll(const Glances& /*glances*/, std::size_t /*begin*/, std::size_t /*end*/) {
  return ~std::uint64_t{0};
}

TEST(HeldLayerTest, WhatIsHeldIsListedByCellFromLowToHigh) {
  HeldLayer layer(kCells, 8);
  EXPECT_TRUE(layer.intervals().empty());
  for (const auto& i : {interval(7, 10, 20), interval(2, 50, 60), interval(2, 10, 20)}) {
    EXPECT_TRUE(layer.hold(i));
  }
  EXPECT_EQ(rows(layer), (Rows{{2, 10, 20}, {2, 50, 60}, {7, 10, 20}}));
}

TEST(HeldLayerTest, HeightsThatAreSeenAgainAreCutOut) {
  HeldLayer layer(kCells, 8);
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
  HeldLayer layer(kCells, 8);
  for (const CellIndex cell : {1U, 2U, 3U}) ASSERT_TRUE(layer.hold(interval(cell, -50, 50)));
  EXPECT_TRUE(layer.cut([](const HeldLayer::Interval& i) {
    return i.cell == 1   ? Columns::Heights{-10, 20}
           : i.cell == 2 ? Columns::Heights{0, 0}
                         : Columns::Heights{-60, 60};
  }));
  EXPECT_EQ(rows(layer), (Rows{{1, -50, -10}, {1, 20, 50}, {2, -50, 50}}));
}

TEST(HeldLayerTest, WhatIsReleasedIsGone) {
  HeldLayer layer(kCells, 8);
  for (const int bottom : {0, 20, 40}) ASSERT_TRUE(layer.hold(interval(1, bottom, bottom + 10)));
  layer.releaseIf(askOfAll,
                  [](const HeldLayer::Interval& i, Glance&) { return i.heights.bottom == 20; });
  EXPECT_EQ(rows(layer), (Rows{{1, 0, 10}, {1, 40, 50}}));
  layer.clear();
  EXPECT_TRUE(layer.intervals().empty());
  EXPECT_TRUE(layer.seen(1, {0, 100}));
}

TEST(HeldLayerTest, WhereThereIsNoRoomItSaysSo) {
  HeldLayer layer(kCells, 2);
  EXPECT_TRUE(layer.hold(interval(1, 0, 100)));
  EXPECT_TRUE(layer.hold(interval(2, 0, 100)));
  EXPECT_FALSE(layer.hold(interval(3, 0, 100)));
  EXPECT_FALSE(layer.seen(1, {40, 60})) << "one of two pieces has no room";
  EXPECT_EQ(layer.intervals().size(), 2U);
}

TEST(HeldLayerTest, OnePieceWithoutRoomIsToldWhateverElseIsCut) {
  for (const int split : {0, 200}) {
    HeldLayer layer(kCells, 2);
    ASSERT_TRUE(layer.hold(interval(1, 0, 100)));
    ASSERT_TRUE(layer.hold(interval(1, 200, 300)));
    HeldLayer other = layer;
    const Columns::Heights middle{static_cast<Height>(split + 40), static_cast<Height>(split + 60)};
    EXPECT_FALSE(layer.seen(1, middle)) << split;
    EXPECT_FALSE(other.cut([&](const HeldLayer::Interval&) { return middle; })) << split;
  }
}

TEST(HeldLayerTest, WhatIsEmptyMakesRoomForThePiecesOfACut) {
  HeldLayer layer(kCells, 2);
  ASSERT_TRUE(layer.hold(interval(1, 0, 100)));
  ASSERT_TRUE(layer.hold(interval(2, 0, 100)));
  EXPECT_TRUE(layer.seen(2, {0, 100}));
  EXPECT_TRUE(layer.seen(1, {40, 60}));
  EXPECT_EQ(rows(layer), (Rows{{1, 0, 40}, {1, 60, 100}}));
}

TEST(HeldLayerTest, OnlyWhatMayBeOverIsAskedAboutAndWhatTakesItsPlaceToo) {
  HeldLayer layer(200, 200);
  for (CellIndex cell = 0; cell < 200; ++cell) ASSERT_TRUE(layer.hold(interval(cell, 0, 100)));
  std::vector<CellIndex> asked;
  layer.releaseIf(
      [](const Glances&, std::size_t begin, std::size_t end) {
        EXPECT_LE(end - begin, HeldLayer::kBlock);
        return std::uint64_t{begin == 64 ? 5U : 0U};
      },
      [&](const HeldLayer::Interval& i, Glance&) {
        asked.push_back(i.cell);
        return i.cell != 66 && i.cell != 198;
      });
  EXPECT_EQ(asked, (std::vector<CellIndex>{64, 199, 198, 66}));
  EXPECT_EQ(layer.intervals().size(), 198U);
}

TEST(HeldLayerTest, WhatWasCutAwayOnceIsGoneFromTheList) {
  HeldLayer layer(kCells, 8);
  ASSERT_TRUE(layer.hold(interval(1, 0, 100)));
  ASSERT_TRUE(layer.hold(interval(2, 0, 100)));
  EXPECT_TRUE(layer.cut([](const HeldLayer::Interval& i) {
    return i.cell == 1 ? i.heights : Columns::Heights{0, 0};
  }));
  ASSERT_EQ(layer.intervals().size(), 1U);
  EXPECT_EQ(layer.intervals().front().cell, 2U);
}

TEST(HeldLayerTest, WhatIsKnownOfAnIntervalStaysWithItUntilItsHeightsChange) {
  HeldLayer layer(kCells, 8);
  for (const CellIndex cell : {1U, 2U, 3U, 4U}) ASSERT_TRUE(layer.hold(interval(cell, 0, 100)));
  layer.releaseIf(askOfAll, [](const HeldLayer::Interval& i, Glance& glance) {
    EXPECT_FALSE(glance.isKnown());
    glance = {Eigen::Vector3f::Ones(), 1.0F, i.cell, 0};
    return false;
  });
  EXPECT_TRUE(layer.seen(1, {0, 100}));
  EXPECT_TRUE(layer.seen(2, {40, 60}));
  EXPECT_TRUE(layer.seen(3, {100, 120}));
  int known = 0;
  layer.releaseIf(askOfAll, [&](const HeldLayer::Interval& i, Glance& glance) {
    EXPECT_EQ(glance.isKnown(), i.cell != 2);
    if (glance.isKnown()) {
      EXPECT_EQ(glance.direction, i.cell);
    }
    known += i.cell == 2 ? 0 : 1;
    return false;
  });
  EXPECT_EQ(known, 2);
}

TEST(HeldLayerTest, CellsWhereWhatIsHeldHasChangedAreToldOnce) {
  HeldLayer layer(kCells, 8);
  const auto changed = [&] {
    IndexSet cells(kCells);
    layer.takeChanged(cells);
    std::vector<std::size_t> told;
    cells.visit([&](std::size_t cell) { told.push_back(cell); });
    return told;
  };
  using Cells = std::vector<std::size_t>;
  for (const CellIndex cell : {4U, 1U, 7U}) ASSERT_TRUE(layer.hold(interval(cell, 0, 100)));
  EXPECT_EQ(changed(), (Cells{1, 4, 7}));
  EXPECT_EQ(changed(), Cells{});
  EXPECT_TRUE(layer.seen(4, {200, 300}));
  EXPECT_TRUE(layer.seen(1, {40, 60}));
  EXPECT_EQ(changed(), Cells{1});
  layer.releaseIf(askOfAll, [](const HeldLayer::Interval& i, Glance&) { return i.cell == 4; });
  EXPECT_EQ(changed(), Cells{4});
  layer.clear();
  EXPECT_EQ(changed(), (Cells{1, 7}));
}

TEST(HeldLayerTest, RandomCutsAndReleasesLeaveTheHeightsThatWereNotSeen) {
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
    if (random.chance(0.1)) {
      const int cell = random.integer(0, 3);
      layer.releaseIf(askOfAll, [&](const HeldLayer::Interval& i, Glance&) {
        const bool is_over = static_cast<int>(i.cell) == cell && i.heights.bottom % 3 == 0;
        for (int h = i.heights.bottom; is_over && h < i.heights.top; ++h) held.erase({cell, h});
        return is_over;
      });
    }
    if (random.chance(0.01)) {
      layer.clear();
      held.clear();
    }
    std::set<std::pair<int, int>> listed;
    for (const auto& i : layer.intervals()) {
      for (int h = i.heights.bottom; h < i.heights.top; ++h) {
        ASSERT_TRUE(listed.insert({static_cast<int>(i.cell), h}).second) << "held twice";
      }
    }
    ASSERT_EQ(listed, held) << step;
    const int first = random.integer(0, 3), last = random.integer(first, 3);
    std::size_t quanta = 0;
    layer.visit(static_cast<CellIndex>(first), static_cast<CellIndex>(last),
                [&](const HeldLayer::Interval& i) {
                  quanta += static_cast<std::size_t>(std::max(0, i.heights.top - i.heights.bottom));
                });
    const auto begin = held.lower_bound({first, 0}), end = held.lower_bound({last + 1, 0});
    ASSERT_EQ(quanta, static_cast<std::size_t>(std::distance(begin, end))) << step;
  }
}

}  // namespace
}  // namespace tccm
