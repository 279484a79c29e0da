#include "map/part_map_ring.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <deque>
#include <utility>

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
  EXPECT_FALSE(ring.hasRoom());
  droppedCells(ring);
  EXPECT_TRUE(ring.hasRoom());
  ring.add({4, 0});
  ring.add({5, 0});
  EXPECT_FALSE(ring.hasRoom());
  EXPECT_EQ(droppedCells(ring), (std::vector<CellIndex>{3, 4, 5}));
}

TEST(PartMapRingTest, ClearingEmptiesIt) {
  PartMapRing ring(2, 2);
  ring.begin(1, atSeconds(1.0));
  ring.add({1, 0});
  ring.clear();
  EXPECT_EQ(ring.scans(), 0U);
  EXPECT_TRUE(ring.hasRoom());
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
  ASSERT_FALSE(ring.hasRoom());
  ring.keepIf([](const MappedReturn& entry) { return entry.cell == 4; });
  EXPECT_EQ(ring.scans(), 2U);
  EXPECT_EQ(ring.returns(), 1U);
  ring.begin(3, atSeconds(3.0));
  for (const CellIndex cell : {5U, 6U, 7U}) {
    ASSERT_TRUE(ring.hasRoom());
    ring.add({cell, 0});
  }
  EXPECT_FALSE(ring.hasRoom());
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

TEST(PartMapRingTest, ARandomStreamComesOutAsItWentIn) {
  test::Random random(32);
  PartMapRing ring(7, 50);
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
    for (int i = random.integer(0, 20); i > 0 && ring.hasRoom(); --i) {
      ring.add({next_cell, 0});
      expected.back().second.push_back(next_cell++);
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

}  // namespace
}  // namespace tccm
