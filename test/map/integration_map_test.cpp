#include "map/integration_map.h"

#include <gtest/gtest.h>

#include <limits>
#include <set>

#include "support/counted_allocations.h"
#include "support/part_union.h"
#include "support/random.h"
#include "support/small_map.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

using test::atScan;
using test::snapshotOf;
using Runs = std::vector<test::Run>;
using Points = std::vector<Vector3>;

IntegrationMap::Config smallConfig() { return test::sixCells(); }

/// In the first cell.
Vector3 atHeight(double z) { return {0.05, 0.05, z}; }

Runs runsIn(IntegrationMap& map) { return test::runsOf(snapshotOf(map)); }

TEST(IntegrationMapTest, AReturnOccupiesTheThicknessBelowIt) {
  IntegrationMap map(smallConfig());
  map.add(atScan(0), {atHeight(0.5)});
  EXPECT_EQ(runsIn(map), (Runs{{0, 480, 500, 1}}));
}

TEST(IntegrationMapTest, NothingIsOccupiedBelowTheLeastHeightAndAReturnAtItIsAQuantum) {
  IntegrationMap map(smallConfig());
  map.add(atScan(0), {atHeight(0.0), {0.15, 0.05, 0.005}, {0.25, 0.05, 0.020}});
  map.add(atScan(1), {{0.15, 0.05, 0.012}});
  EXPECT_EQ(runsIn(map), (Runs{{0, 0, 1, 1}, {1, 0, 12, 2}, {2, 0, 20, 1}}));
  map.expireOldest();
  EXPECT_EQ(runsIn(map), (Runs{{1, 0, 12, 1}}));
}

/// In quanta, by brute force: what each return occupies, as far as it lies in the area.
std::set<int> occupiedInArea(const Grid& grid, const Points& points, int thickness) {
  std::set<int> occupied;
  const double least = grid.config().height_min_m - 1e-9;
  for (const Vector3& p : points) {
    const int height = grid.heightOf(p.z());
    for (int h = height - thickness; h < height; ++h) {
      if (grid.metres(h) >= least) occupied.insert(h);
    }
    int first = height - thickness;
    while (grid.metres(first) < least) ++first;
    occupied.insert(first);
  }
  return occupied;
}

TEST(IntegrationMapTest, WhateverTheLeastHeightIsTheMapIsWhatReturnsOccupyAboveIt) {
  for (unsigned seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    test::Random random(seed);
    IntegrationMap::Config config = smallConfig();
    const double least = config.grid.height_min_m =
        seed % 3 == 0 ? random.uniform(-0.3, 0.3) : 0.001 * random.integer(-300, 300);
    config.thickness_m = 0.001 * random.integer(1, 40);
    IntegrationMap map(config);
    Points points = {atHeight(least + 1e-6)};
    for (int i = random.integer(0, 5); i > 0; --i) {
      points.push_back(atHeight(least + random.uniform(0.0, seed % 2 == 0 ? 0.01 : 0.3)));
    }
    ASSERT_EQ(map.add(atScan(0), points).mapped, points.size());
    std::set<int> occupied;
    std::size_t returns = 0;
    for (const Cuboid& cuboid : snapshotOf(map).cuboids) {
      EXPECT_GE(map.grid().metres(cuboid.bottom), least - 1e-9);
      for (int h = cuboid.bottom; h < cuboid.top; ++h) occupied.insert(h);
      returns += cuboid.points;
    }
    EXPECT_EQ(occupied, occupiedInArea(map.grid(), points, map.thickness()));
    EXPECT_EQ(returns, points.size()) << "each counts once";
  }
}

TEST(IntegrationMapTest, ReturnsAThicknessAboveTheLeastHeightOccupyAllOfIt) {
  test::Random random(7);
  for (int i = 0; i < 40; ++i) {
    IntegrationMap map(smallConfig());
    const int height = random.integer(20, 999);
    map.add(atScan(0), {atHeight(0.001 * height + random.uniform(-0.0004, 0.0004))});
    EXPECT_EQ(runsIn(map), (Runs{{0, height - 20, height, 1}}));
  }
}

TEST(IntegrationMapTest, ReturnsOutsideTheAreaAndNotFiniteAreCountedAndLeftOut) {
  IntegrationMap map(smallConfig());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  const auto added = map.add(atScan(0), {atHeight(0.5),
                                         atHeight(nan),
                                         {nan, 0.0, 0.5},
                                         {0.0, infinity, 0.5},
                                         {0.301, 0.0, 0.5},
                                         atHeight(1.0),
                                         atHeight(-0.000001),
                                         atHeight(0.0)});
  EXPECT_EQ(added.mapped, 2U);
  EXPECT_EQ(added.out_of_area, 6U);
}

TEST(IntegrationMapTest, TouchingReturnsOfDifferentScansAreOneCuboidAndAGapOfAQuantumParts) {
  IntegrationMap map(smallConfig());
  map.add(atScan(0), {atHeight(0.500), atHeight(0.300)});
  map.add(atScan(1), {atHeight(0.520), atHeight(0.321)});
  EXPECT_EQ(runsIn(map), (Runs{{0, 280, 300, 1}, {0, 301, 321, 1}, {0, 480, 520, 2}}));
}

TEST(IntegrationMapTest, ExpiryLeavesWhatLaterScansSaw) {
  IntegrationMap map(smallConfig());
  map.add(atScan(0), {atHeight(0.510), atHeight(0.200)});
  map.add(atScan(1), {atHeight(0.500)});
  map.expireOldest();
  EXPECT_EQ(runsIn(map), (Runs{{0, 480, 500, 1}}));
  map.expireOldest();
  EXPECT_TRUE(runsIn(map).empty());
  EXPECT_EQ(map.scans(), 0U);
}

TEST(IntegrationMapTest, TheSnapshotSaysScanWindowAndStamp) {
  IntegrationMap map(smallConfig());
  EXPECT_EQ(snapshotOf(map).serial, 0U);
  map.add(atScan(3), {atHeight(0.5)});
  map.add(atScan(4), {});
  const CuboidMap snapshot = snapshotOf(map);
  EXPECT_EQ(snapshot.serial, 2U);
  EXPECT_EQ(snapshot.window_scans, 2U);
  EXPECT_EQ(snapshot.stamp, atScan(4));
  EXPECT_EQ(snapshot.thickness, 20);
  EXPECT_TRUE(snapshot.grid == map.grid());
  EXPECT_FALSE(snapshot.overflowed);
  EXPECT_EQ(map.oldestStamp(), atScan(3));
}

TEST(IntegrationMapTest, TheSnapshotsIndexIsThatOfItsCuboids) {
  IntegrationMap map(smallConfig());
  map.add(atScan(0), {{0.15, 0.05, 0.5}, {0.25, 0.15, 0.5}, {0.25, 0.15, 0.8}});
  CuboidMap snapshot = snapshotOf(map);
  const auto written = snapshot.cell_begin;
  indexCells(snapshot);
  EXPECT_EQ(snapshot.cell_begin, written);
}

TEST(IntegrationMapTest, AFullWindowDropsItsOldestScanByItself) {
  IntegrationMap::Config config = smallConfig();
  config.scans_max = 2;
  IntegrationMap map(config);
  for (int i = 0; i < 3; ++i) map.add(atScan(i), {atHeight(0.1 * (i + 1))});
  EXPECT_EQ(map.scans(), 2U);
  EXPECT_EQ(runsIn(map), (Runs{{0, 180, 200, 1}, {0, 280, 300, 1}}));
}

TEST(IntegrationMapTest, ClearingForgetsTheScansAndSerialsGoOn) {
  IntegrationMap map(smallConfig());
  map.add(atScan(0), {atHeight(0.5)});
  map.clear();
  EXPECT_EQ(map.scans(), 0U);
  EXPECT_TRUE(runsIn(map).empty());
  map.add(atScan(1), {atHeight(0.5)});
  EXPECT_EQ(map.serial(), 2U);
  EXPECT_EQ(snapshotOf(map).cuboids[0].age_scans, 0U);
  EXPECT_EQ(snapshotOf(map).cuboids[0].points, 1U);
}

/// Adds a scan and keeps the window's length.
void step(IntegrationMap& map, const Points& points, std::size_t window) {
  map.add(atScan(static_cast<int>(map.serial())), points);
  while (map.scans() > window) map.expireOldest();
}

TEST(AgeTest, WhatIsSeenAgainAndAgainAges) {
  IntegrationMap map(smallConfig());
  for (int i = 0; i < 13; ++i) step(map, {atHeight(0.5)}, 4);
  const CuboidMap snapshot = snapshotOf(map);
  ASSERT_EQ(snapshot.cuboids.size(), 1U);
  EXPECT_EQ(snapshot.cuboids[0].age_scans, 12U);
  EXPECT_EQ(snapshot.cuboids[0].points, 4U);
}

TEST(AgeTest, WhatLeavesTheWindowAndReturnsIsNew) {
  IntegrationMap map(smallConfig());
  step(map, {atHeight(0.5)}, 3);
  for (int i = 0; i < 3; ++i) step(map, {}, 3);
  EXPECT_TRUE(runsIn(map).empty());
  step(map, {atHeight(0.5)}, 3);
  EXPECT_EQ(snapshotOf(map).cuboids[0].age_scans, 0U);
}

TEST(AgeTest, WhatIsSeenOnceAWindowKeepsItsAge) {
  IntegrationMap map(smallConfig());
  for (int i = 0; i < 10; ++i) step(map, i % 3 == 0 ? Points{atHeight(0.5)} : Points{}, 4);
  EXPECT_EQ(snapshotOf(map).cuboids[0].age_scans, 9U);
}

TEST(AgeTest, ANewNeighbourThatOnlyTouchesIsPartOfTheOlderCuboidUntilThatLeaves) {
  IntegrationMap map(smallConfig());
  step(map, {atHeight(0.500)}, 3);
  step(map, {atHeight(0.520)}, 3);
  EXPECT_EQ(snapshotOf(map).cuboids[0].age_scans, 1U);
  step(map, {}, 3);
  step(map, {}, 3);
  EXPECT_EQ(runsIn(map), (Runs{{0, 500, 520, 1}}));
  EXPECT_EQ(snapshotOf(map).cuboids[0].age_scans, 2U);  // its own, not the 3 it had touched
}

IntegrationMap filledBeyond(std::size_t returns_max, std::size_t intervals_max) {
  IntegrationMap::Config config = smallConfig();
  config.returns_max = returns_max;
  config.intervals_max = intervals_max;
  IntegrationMap map(config);
  map.add(atScan(0), {atHeight(0.1)});
  EXPECT_FALSE(map.overflowed());
  const auto added = map.add(
      atScan(1), {atHeight(0.2), atHeight(0.3), atHeight(0.4), atHeight(0.5), atHeight(0.6)});
  EXPECT_LT(added.mapped, 5U);
  EXPECT_EQ(added.out_of_area, 0U);
  return map;
}

TEST(OverflowTest, ABoundThatWasMetIsSaidUntilThatScanLeft) {
  for (const auto& [returns_max, intervals_max] : {std::pair(3, 1000), std::pair(1000, 4)}) {
    IntegrationMap map = filledBeyond(static_cast<std::size_t>(returns_max),
                                      static_cast<std::size_t>(intervals_max));
    EXPECT_TRUE(map.overflowed());
    EXPECT_TRUE(snapshotOf(map).overflowed);
    map.add(atScan(2), {});
    map.expireOldest();
    EXPECT_TRUE(map.overflowed()) << "the scan with points left out is still in the window";
    map.expireOldest();
    EXPECT_FALSE(map.overflowed());
    EXPECT_FALSE(snapshotOf(map).overflowed);
    map.add(atScan(3), {atHeight(0.2)});
    EXPECT_EQ(runsIn(map), (Runs{{0, 180, 200, 1}}));
    EXPECT_FALSE(map.overflowed());
  }
}

TEST(OverflowTest, AnEmptiedOrClearedMapIsNotOverflowed) {
  IntegrationMap map = filledBeyond(3, 1000);
  map.clear();
  EXPECT_FALSE(map.overflowed());
  map = filledBeyond(3, 1000);
  while (map.scans() > 0) map.expireOldest();
  EXPECT_FALSE(map.overflowed());
}

TEST(OverflowTest, WhatWasLeftOutLeavesNoTraceInTheCounts) {
  IntegrationMap map = filledBeyond(3, 1000);
  while (map.scans() > 0) map.expireOldest();
  map.add(atScan(5), {atHeight(0.2), atHeight(0.6)});
  EXPECT_EQ(runsIn(map), (Runs{{0, 180, 200, 1}, {0, 580, 600, 1}}));
}

TEST(MemoryTest, NothingIsAllocatedAfterTheStart) {
  test::Random random(41);
  IntegrationMap map{IntegrationMap::Config()};
  CuboidMap snapshot;
  map.reserve(snapshot);
  std::vector<Points> scans(60);
  for (Points& points : scans) {
    for (int i = 0; i < 600; ++i) {
      points.emplace_back(random.uniform(0.0, 1.5), random.uniform(-1.0, 1.0),
                          random.uniform(0.0, 1.9));
    }
  }
  map.snapshot(snapshot);
  test::is_counting = true;
  for (int i = 0; i < 300; ++i) {
    map.add(atScan(i), scans[static_cast<std::size_t>(i) % scans.size()]);
    while (map.scans() > 40) map.expireOldest();
    map.snapshot(snapshot);
  }
  map.clear();
  test::is_counting = false;
  EXPECT_EQ(test::allocations, 0);
  EXPECT_GT(snapshot.cuboids.size(), 7000U);
}

TEST(MemoryTest, MemoryIsSaidAndDoesNotGrow) {
  IntegrationMap map(smallConfig());
  const std::size_t bytes = map.memoryBytes();
  EXPECT_GT(bytes, 400000U * sizeof(MappedReturn));
  for (int i = 0; i < 100; ++i) map.add(atScan(i), {atHeight(0.005 * i)});
  EXPECT_EQ(map.memoryBytes(), bytes);
}

TEST(IntegrationMapConfigTest, BadConfigurationsAreRefused) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double thickness : {nan, 0.0, -0.02, 0.0009, 3.0}) {
    IntegrationMap::Config config = smallConfig();
    config.thickness_m = thickness;
    EXPECT_THROW(IntegrationMap{config}, ConfigError) << thickness;
  }
  for (std::size_t IntegrationMap::Config::*key :
       {&IntegrationMap::Config::scans_max, &IntegrationMap::Config::returns_max,
        &IntegrationMap::Config::intervals_max}) {
    IntegrationMap::Config config = smallConfig();
    config.*key = 0;
    EXPECT_THROW(IntegrationMap{config}, ConfigError);
  }
  IntegrationMap::Config config = smallConfig();
  config.grid.cell_size_m = nan;
  EXPECT_THROW(IntegrationMap{config}, ConfigError);
}

}  // namespace
}  // namespace tccm
