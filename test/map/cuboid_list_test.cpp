#include "map/cuboid_list.h"

#include <gtest/gtest.h>

#include <map>
#include <vector>

#include "support/random.h"

namespace tccm {
namespace {

constexpr CellIndex kCells = 100;
using Entries = std::vector<CuboidList::Entry>;

Time at(std::int64_t milliseconds) { return Time(std::chrono::milliseconds(milliseconds)); }

CuboidMap written(const CuboidList& list, std::uint32_t serial = 7, Time now = at(5000)) {
  CuboidMap map;
  list.write(map, serial, now);
  return map;
}

TEST(CuboidListTest, ACuboidIsAsOldAsTheMapTells) {
  CuboidList list(kCells, 10);
  list.changed().insert(3);
  list.update([](CellIndex cell, Entries& entries) {
    entries.emplace_back(cell, false, Columns::Heights{10, 30}, 4, 2, at(4000) + Duration(1));
    entries.emplace_back(cell, true, Columns::Heights{40, 60}, 5, 6, at(6000));
  });
  const CuboidMap map = written(list);
  ASSERT_EQ(map.cuboids.size(), 2U);
  const Cuboid &live = map.cuboids[0], &held = map.cuboids[1];
  EXPECT_EQ(live.cell, 3U);
  EXPECT_EQ(live.bottom, 10);
  EXPECT_EQ(live.top, 30);
  EXPECT_EQ(live.points, 4U);
  EXPECT_EQ(live.age_scans, 5U);
  EXPECT_EQ(live.unseen_ms, 999U) << "whole ones";
  EXPECT_FALSE(live.held);
  EXPECT_TRUE(held.held);
  EXPECT_EQ(held.unseen_ms, 0U) << "seen later";
  EXPECT_EQ(written(list, 9, at(7000)).cuboids[0].age_scans, 7U);
}

TEST(CuboidListTest, ACuboidKeepsItsDynUntilItsCellIsListedAnewOrToldAgain) {
  CuboidList list(kCells, 10);
  const auto listOne = [](CellIndex cell, Entries& entries) {
    entries.emplace_back(cell, false, Columns::Heights{10, 30}, 1, 1, at(0));
  };
  const auto tell = [&](const IndexSet& others, std::uint32_t dyn) {
    CuboidMap map = written(list);
    list.tellDyn(others, map, [dyn](const Cuboid& cuboid) { return 10 * cuboid.cell + dyn; });
    std::vector<std::uint32_t> all;
    for (const Cuboid& cuboid : map.cuboids) all.push_back(cuboid.dyn);
    return all;
  };
  IndexSet none(kCells), third(kCells);
  third.insert(3);
  for (const CellIndex cell : {2U, 3U, 4U}) list.changed().insert(cell);
  list.update(listOne);
  EXPECT_EQ(written(list).cuboids[1].dyn, 0U);
  EXPECT_EQ(tell(none, 1), (std::vector<std::uint32_t>{21, 31, 41}));
  EXPECT_EQ(tell(none, 2), (std::vector<std::uint32_t>{21, 31, 41}));
  EXPECT_EQ(tell(third, 3), (std::vector<std::uint32_t>{21, 33, 41}));
  list.changed().insert(4);
  list.update(listOne);
  EXPECT_EQ(tell(none, 4), (std::vector<std::uint32_t>{21, 33, 44}));
}

TEST(CuboidListTest, OnlyCellsThatHaveChangedAreListedAnew) {
  test::Random random(2);
  CuboidList list(kCells, 1000);
  std::map<CellIndex, int> cuboids;  // by cell
  const auto count = [&](CellIndex cell, Entries& entries) {
    for (int i = 0; i < cuboids[cell]; ++i) {
      const Columns::Heights heights{static_cast<Height>(10 * i), static_cast<Height>(10 * i + 5)};
      entries.emplace_back(cell, false, heights, static_cast<std::uint32_t>(cuboids[cell]), 1,
                           at(0));
    }
  };
  for (int step = 0; step < 500; ++step) {
    for (int i = random.integer(0, 5); i > 0; --i) {
      const auto cell = static_cast<CellIndex>(random.integer(0, kCells - 1));
      cuboids[cell] = random.integer(0, 4);
      list.changed().insert(cell);
    }
    list.update([&](CellIndex cell, Entries& entries) { count(cell, entries); });
    EXPECT_TRUE(list.changed().empty());
    Entries expected;
    const CuboidMap map = written(list);
    ASSERT_EQ(map.cell_begin.size(), kCells + 1);
    for (CellIndex cell = 0; cell < kCells; ++cell) {
      ASSERT_EQ(map.cell_begin[cell], expected.size()) << step;
      count(cell, expected);
    }
    ASSERT_EQ(map.cell_begin[kCells], expected.size());
    ASSERT_EQ(map.cuboids.size(), expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i) {
      ASSERT_EQ(map.cuboids[i].cell, expected[i].cell);
      ASSERT_EQ(map.cuboids[i].bottom, expected[i].bottom);
      ASSERT_EQ(map.cuboids[i].points, expected[i].points);
    }
  }
}

}  // namespace
}  // namespace tccm
