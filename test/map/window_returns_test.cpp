#include "map/window_returns.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <deque>
#include <fstream>
#include <utility>
#include <vector>

#include "support/random.h"

namespace tccm {
namespace {

Time atSeconds(double seconds) { return Time(fromSeconds(seconds)); }

std::vector<CellIndex> droppedCells(PartMapRing& ring) {
  std::vector<CellIndex> cells;
  ring.visitOldest([&](const MappedReturn& entry) { cells.push_back(entry.cell); });
  ring.dropOldest();
  return cells;
}

/// A part map that comes at so many seconds.
void begin(PartMapRing& ring, std::uint32_t serial, const std::vector<MappedReturn>& entries) {
  ring.begin(serial, atSeconds(serial));
  for (const MappedReturn& entry : entries) ring.add(entry);
}

TEST(PartMapRingTest, PartMapsLeaveInTheOrderTheyCame) {
  PartMapRing ring(3, 10);
  begin(ring, 1, {{11, 5}, {12, 5}});
  begin(ring, 2, {{21, 5}});
  EXPECT_EQ(ring.scans(), 2U);
  EXPECT_EQ(ring.oldestStamp(), atSeconds(1.0));
  EXPECT_EQ(ring.oldestSerial(), 1U);
  EXPECT_EQ(droppedCells(ring), (std::vector<CellIndex>{11, 12}));
  EXPECT_EQ(ring.oldestStamp(), atSeconds(2.0));
  EXPECT_EQ(droppedCells(ring), (std::vector<CellIndex>{21}));
  EXPECT_EQ(ring.scans(), 0U);
}

TEST(PartMapRingTest, AScanWithoutReturnsIsAPartMapToo) {
  PartMapRing ring(2, 10);
  ring.begin(1, atSeconds(1.0));
  ring.begin(2, atSeconds(2.0));
  EXPECT_TRUE(ring.full());
  EXPECT_TRUE(droppedCells(ring).empty());
  EXPECT_FALSE(ring.full());
  EXPECT_EQ(ring.oldestSerial(), 2U);
}

TEST(PartMapRingTest, RoomIsUsedUpAndComesBackWhenTheOldestLeaves) {
  PartMapRing ring(4, 3);
  begin(ring, 1, {{1, 0}, {2, 0}});
  begin(ring, 2, {{3, 0}});
  EXPECT_EQ(ring.room(), 0U);
  droppedCells(ring);
  EXPECT_GT(ring.room(), 0U);
  ring.add({4, 0});
  ring.add({5, 0});
  EXPECT_EQ(ring.room(), 0U);
  EXPECT_EQ(droppedCells(ring), (std::vector<CellIndex>{3, 4, 5}));
}

TEST(PartMapRingTest, ClearingEmptiesIt) {
  PartMapRing ring(2, 2);
  ring.begin(1, atSeconds(1.0));
  ring.add({1, 0});
  ring.clear();
  EXPECT_EQ(ring.scans(), 0U);
  EXPECT_GT(ring.room(), 0U);
  ring.begin(2, atSeconds(2.0));
  ring.add({7, 0});
  EXPECT_EQ(droppedCells(ring), std::vector<CellIndex>{7});
}

TEST(PartMapRingTest, WhatIsNotKeptLeavesItsRoomAndItsPartMapStays) {
  PartMapRing ring(3, 4);
  ring.keepIf([](const MappedReturn&) { return false; });
  begin(ring, 1, {{1, 0}, {2, 0}});
  begin(ring, 2, {{3, 0}});
  ring.add({4, 0});
  ASSERT_EQ(ring.room(), 0U);
  ring.keepIf([](const MappedReturn& entry) { return entry.cell == 4; });
  EXPECT_EQ(ring.scans(), 2U);
  EXPECT_EQ(ring.returns(), 1U);
  ring.begin(3, atSeconds(3.0));
  for (const CellIndex cell : {5U, 6U, 7U}) {
    ASSERT_GT(ring.room(), 0U);
    ring.add({cell, 0});
  }
  EXPECT_EQ(ring.room(), 0U);
  EXPECT_EQ(ring.oldestStamp(), atSeconds(1.0));
  EXPECT_TRUE(droppedCells(ring).empty());
  EXPECT_EQ(droppedCells(ring), std::vector<CellIndex>{4});
  EXPECT_EQ(droppedCells(ring), (std::vector<CellIndex>{5, 6, 7}));
}

TEST(PartMapRingTest, AVisitMeetsTheNewestScanFirst) {
  PartMapRing ring(2, 3);
  for (std::uint32_t serial = 1; serial <= 3; ++serial) {
    if (ring.full()) droppedCells(ring);
    ring.begin(serial, atSeconds(serial));
    ring.add({10 * serial, 0});
  }
  std::vector<std::pair<CellIndex, std::uint32_t>> visits;
  ring.visitNewestFirst([&](const MappedReturn& entry, std::uint32_t serial) {
    visits.emplace_back(entry.cell, serial);
  });
  EXPECT_EQ(visits, (std::vector<std::pair<CellIndex, std::uint32_t>>{{30, 3}, {20, 2}}));
}

/// @param room of the ring, where each scan brings up to so many returns.
void expectARandomStreamToComeOutAsItWentIn(std::size_t room, int returns_max) {
  test::Random random(32);
  PartMapRing ring(7, room);
  std::deque<std::pair<std::uint32_t, std::vector<CellIndex>>> expected;
  std::uint32_t next_cell = 0;
  for (std::uint32_t serial = 1; serial < 2000; ++serial) {
    while (ring.full() || (ring.scans() > 0 && random.chance(0.4))) {
      ASSERT_EQ(ring.oldestSerial(), expected.front().first);
      ASSERT_EQ(ring.oldestStamp(), atSeconds(expected.front().first));
      ASSERT_EQ(droppedCells(ring), expected.front().second);
      expected.pop_front();
    }
    ring.begin(serial, atSeconds(serial));
    expected.emplace_back(serial, std::vector<CellIndex>());
    std::vector<MappedReturn> batch;
    const auto count = static_cast<std::size_t>(random.integer(0, returns_max));
    while (batch.size() < std::min(count, ring.room())) {
      expected.back().second.push_back(next_cell);
      batch.push_back({next_cell++, 0});
    }
    if (random.chance(0.5)) {
      ring.add(batch.data(), batch.size());
    } else {
      for (const MappedReturn& entry : batch) ring.add(entry);
    }
    ASSERT_EQ(ring.scans(), expected.size());
    if (!random.chance(0.2)) continue;
    const auto divisor = static_cast<CellIndex>(random.integer(1, 5));
    ring.keepIf([=](const MappedReturn& entry) { return entry.cell % divisor > 0; });
    std::size_t returns = 0;
    for (auto& [owner, cells] : expected) {
      const auto gone = [=](CellIndex cell) { return cell % divisor == 0; };
      cells.erase(std::remove_if(cells.begin(), cells.end(), gone), cells.end());
      returns += cells.size();
    }
    ASSERT_EQ(ring.returns(), returns);
  }
}

TEST(PartMapRingTest, ARandomStreamComesOutAsItWentIn) {
  expectARandomStreamToComeOutAsItWentIn(50, 20);
  expectARandomStreamToComeOutAsItWentIn(1024, 500);
  expectARandomStreamToComeOutAsItWentIn(3000, 900);
}

/// Of this process, in memory [bytes].
std::size_t residentBytes() {
  std::ifstream statm("/proc/self/statm");
  std::size_t size = 0, resident = 0;
  statm >> size >> resident;
  return resident * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
}

TEST(PartMapRingTest, RoomThatIsNeverNeededAtOnceIsLeftToTheSystem) {
  const std::vector<MappedReturn> scan(450);
  PartMapRing ring(40, 4000000);
  const std::size_t before = residentBytes();
  for (std::uint32_t serial = 0; serial < 20000; ++serial) {
    if (ring.full()) ring.dropOldest();
    ring.begin(serial, atSeconds(serial));
    ring.add(scan.data(), scan.size());
    if (serial % 100 == 0) ring.keepIf([](const MappedReturn&) { return true; });
  }
  // 40 scans have 144 kB; 9,000,000 returns went through, twice the 32 MB of the ring.
  EXPECT_LT(residentBytes(), before + 2000000U);
}

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
