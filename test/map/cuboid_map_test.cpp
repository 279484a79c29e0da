#include "tccm_monitor/cuboid_map.h"

#include <gtest/gtest.h>

#include <cstdlib>

#include "support/near.h"
#include "support/random.h"

namespace tccm {
namespace {

/// 5 x 4 cells of 20 mm.
CuboidMap emptyMap() {
  Grid::Config config;
  config.origin_x_m = config.origin_y_m = 0.0;
  config.size_x_m = 0.10;
  config.size_y_m = 0.08;
  CuboidMap map;
  map.grid = Grid(config);
  return map;
}

void append(CuboidMap& map, CellIndex cell, int bottom, int top, std::uint32_t points) {
  Cuboid cuboid;
  cuboid.cell = cell;
  cuboid.bottom = static_cast<Height>(bottom);
  cuboid.top = static_cast<Height>(top);
  cuboid.points = points;
  map.cuboids.push_back(cuboid);
}

TEST(CuboidMapTest, CellBeginNamesEachCellsCuboids) {
  CuboidMap map = emptyMap();
  append(map, 1, 0, 20, 1);
  append(map, 1, 30, 50, 1);
  append(map, 19, 0, 20, 1);
  indexCells(map);
  ASSERT_EQ(map.cell_begin.size(), 21U);
  EXPECT_EQ(map.cell_begin[0], 0U);
  EXPECT_EQ(map.cell_begin[1], 0U);
  EXPECT_EQ(map.cell_begin[2], 2U);
  EXPECT_EQ(map.cell_begin[19], 2U);
  EXPECT_EQ(map.cell_begin[20], 3U);
}

TEST(CuboidMapTest, AnEmptyMapHasNoCuboidsInAnyCell) {
  CuboidMap map = emptyMap();
  indexCells(map);
  EXPECT_EQ(map.cell_begin, std::vector<std::uint32_t>(21, 0));
}

TEST(CuboidMapTest, ACuboidsBoxIsItsColumnBetweenItsHeights) {
  CuboidMap map = emptyMap();
  append(map, 7, 100, 150, 1);  // third column, second row
  const UprightBox box = map.box(map.cuboids[0]);
  EXPECT_TRUE(test::isNearly(box.min(), {0.04, 0.02, 0.100}, 1e-12));
  EXPECT_TRUE(test::isNearly(box.max(), {0.06, 0.04, 0.150}, 1e-12));
}

TEST(CuboidMapTest, SupportIsOnesOwnAndTheNeighboursWithinTheHeight) {
  CuboidMap map = emptyMap();
  append(map, 0, 100, 120, 1);      // diagonal neighbour of 6
  append(map, 5, 150, 170, 10);     // beside, exactly 30 mm above
  append(map, 6, 100, 120, 100);    // the one asked about
  append(map, 7, 151, 171, 1000);   // beside, 31 mm above
  append(map, 8, 100, 120, 10000);  // two cells away
  append(map, 11, 60, 70, 100000);  // below, exactly 30 mm
  indexCells(map);
  EXPECT_EQ(supportOf(map, map.cuboids[2], 0.03), 100111U);
}

TEST(CuboidMapTest, SupportAtTheAreasEdgeDoesNotWrapToTheNextRow) {
  CuboidMap map = emptyMap();
  append(map, 4, 0, 20, 1);   // last of the first row
  append(map, 5, 0, 20, 10);  // first of the second row
  indexCells(map);
  EXPECT_EQ(supportOf(map, map.cuboids[0], 0.03), 1U);
  EXPECT_EQ(supportOf(map, map.cuboids[1], 0.03), 10U);
}

TEST(CuboidMapTest, SupportInRandomMapsIsThatOfEveryPairCompared) {
  test::Random random(34);
  for (int round = 0; round < 300; ++round) {
    CuboidMap map = emptyMap();
    for (CellIndex cell = 0; cell < map.grid.cells(); ++cell) {
      int bottom = random.integer(0, 60);
      while (random.chance(0.6)) {
        const int top = bottom + random.integer(20, 60);
        append(map, cell, bottom, top, static_cast<std::uint32_t>(random.integer(0, 9)));
        bottom = top + random.integer(1, 60);
      }
    }
    indexCells(map);
    const int reach = random.integer(0, 40);
    for (const Cuboid& cuboid : map.cuboids) {
      std::uint32_t expected = 0;
      for (const Cuboid& other : map.cuboids) {
        const int dx = static_cast<int>(other.cell % 5) - static_cast<int>(cuboid.cell % 5);
        const int dy = static_cast<int>(other.cell / 5) - static_cast<int>(cuboid.cell / 5);
        const int apart = std::max(other.bottom - cuboid.top, cuboid.bottom - other.top);
        if (std::abs(dx) <= 1 && std::abs(dy) <= 1 && apart <= reach) expected += other.points;
      }
      ASSERT_EQ(supportOf(map, cuboid, (reach + 0.5) * 0.001), expected) << "round " << round;
    }
  }
}

TEST(CuboidMapTest, WholeMillimetresOfHeightReachThatFar) {
  CuboidMap map = emptyMap();
  append(map, 0, 0, 20, 1);
  append(map, 1, 20, 40, 10);
  for (int reach = 1; reach <= 200; ++reach) {
    map.cuboids[1].bottom = static_cast<Height>(20 + reach);
    map.cuboids[1].top = static_cast<Height>(40 + reach);
    indexCells(map);
    EXPECT_EQ(supportOf(map, map.cuboids[0], reach / 1000.0), 11U) << reach << " mm";
    EXPECT_EQ(supportOf(map, map.cuboids[0], (reach - 1) / 1000.0), 1U) << reach << " mm";
  }
}

}  // namespace
}  // namespace tccm
