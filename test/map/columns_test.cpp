#include "tccm_monitor/map/columns.h"

#include <gtest/gtest.h>

#include <array>
#include <deque>
#include <tuple>
#include <vector>

#include "support/random.h"

namespace tccm {
namespace {

/// bottom, top, serial, born
using Piece = std::tuple<int, int, std::uint32_t, std::uint32_t>;

std::vector<Piece> piecesOf(const Columns& columns, CellIndex cell = 0) {
  std::vector<Piece> pieces;
  for (std::uint32_t i = columns.first(cell); i != Columns::kNone; i = columns.interval(i).next) {
    const auto& interval = columns.interval(i);
    pieces.emplace_back(interval.bottom, interval.top, interval.serial, interval.born);
  }
  return pieces;
}

/// Inserts [bottom, top, serial] in turn into cell 0.
std::vector<Piece> afterInserting(std::initializer_list<std::array<int, 3>> inserts) {
  Columns columns(1, 100);
  for (const auto& [bottom, top, serial] : inserts) {
    EXPECT_TRUE(columns.insert(0, static_cast<Height>(bottom), static_cast<Height>(top),
                               static_cast<std::uint32_t>(serial)));
  }
  return piecesOf(columns);
}

using Pieces = std::vector<Piece>;

TEST(ColumnsTest, AnIntervalAloneIsItself) {
  EXPECT_EQ(afterInserting({{10, 30, 1}}), (Pieces{{10, 30, 1, 1}}));
}

TEST(ColumnsTest, SeparateIntervalsAreKeptFromLowToHigh) {
  EXPECT_EQ(afterInserting({{50, 70, 1}, {10, 30, 1}, {31, 49, 2}}),
            (Pieces{{10, 30, 1, 1}, {31, 49, 2, 2}, {50, 70, 1, 1}}));
}

TEST(ColumnsTest, AScansOwnIntervalsUniteWhereTheyOverlapOrTouch) {
  EXPECT_EQ(afterInserting({{10, 30, 1}, {20, 40, 1}}), (Pieces{{10, 40, 1, 1}}));
  EXPECT_EQ(afterInserting({{10, 30, 1}, {30, 50, 1}}), (Pieces{{10, 50, 1, 1}}));
  EXPECT_EQ(afterInserting({{10, 30, 1}, {50, 70, 1}, {30, 50, 1}}), (Pieces{{10, 70, 1, 1}}));
}

TEST(ColumnsTest, ANewerScanCarvesTheOlderFromAboveBelowAndBetween) {
  EXPECT_EQ(afterInserting({{10, 30, 1}, {20, 40, 2}}), (Pieces{{10, 20, 1, 1}, {20, 40, 2, 1}}));
  EXPECT_EQ(afterInserting({{20, 40, 1}, {10, 30, 2}}), (Pieces{{10, 30, 2, 1}, {30, 40, 1, 1}}));
  EXPECT_EQ(afterInserting({{0, 50, 1}, {10, 30, 2}}),
            (Pieces{{0, 10, 1, 1}, {10, 30, 2, 1}, {30, 50, 1, 1}}));
  EXPECT_EQ(afterInserting({{10, 30, 1}, {0, 50, 2}}), (Pieces{{0, 50, 2, 1}}));
  EXPECT_EQ(afterInserting({{10, 30, 1}, {10, 30, 2}}), (Pieces{{10, 30, 2, 1}}));
}

TEST(ColumnsTest, TouchingAnOlderIntervalNeitherCarvesItNorInheritsItsBirth) {
  EXPECT_EQ(afterInserting({{10, 30, 1}, {30, 50, 2}}), (Pieces{{10, 30, 1, 1}, {30, 50, 2, 2}}));
  EXPECT_EQ(afterInserting({{30, 50, 1}, {10, 30, 2}}), (Pieces{{10, 30, 2, 2}, {30, 50, 1, 1}}));
}

TEST(ColumnsTest, TheEarliestBirthOfAllThatIsOverlappedIsInherited) {
  EXPECT_EQ(afterInserting({{10, 20, 3}, {30, 40, 5}, {15, 35, 7}}),
            (Pieces{{10, 15, 3, 3}, {15, 35, 7, 3}, {35, 40, 5, 5}}));
  EXPECT_EQ(afterInserting({{10, 20, 3}, {15, 25, 7}, {25, 35, 7}}),
            (Pieces{{10, 15, 3, 3}, {15, 35, 7, 3}}));
}

TEST(ColumnsTest, SerialsMayWrap) {
  Columns columns(1, 10);
  ASSERT_TRUE(columns.insert(0, 0, 20, 0xFFFFFFFEU));
  ASSERT_TRUE(columns.insert(0, 10, 30, 2U));
  EXPECT_EQ(piecesOf(columns),
            (Pieces{{0, 10, 0xFFFFFFFEU, 0xFFFFFFFEU}, {10, 30, 2U, 0xFFFFFFFEU}}));
}

TEST(ColumnsTest, ExpiryRemovesWhatTheScanStillOwns) {
  Columns columns(2, 10);
  ASSERT_TRUE(columns.insert(0, 0, 50, 1));
  ASSERT_TRUE(columns.insert(1, 0, 50, 1));
  ASSERT_TRUE(columns.insert(0, 10, 30, 2));
  columns.expire(0, 1);
  EXPECT_EQ(piecesOf(columns), (Pieces{{10, 30, 2, 1}}));
  EXPECT_EQ(piecesOf(columns, 1), (Pieces{{0, 50, 1, 1}}));
  EXPECT_EQ(columns.used(), 2U);
}

TEST(ColumnsTest, AnInsertThatMightNotFitIsRefusedAndChangesNothing) {
  Columns columns(1, 3);
  ASSERT_TRUE(columns.insert(0, 0, 10, 1));
  ASSERT_TRUE(columns.insert(0, 20, 30, 1));
  const Pieces before = piecesOf(columns);
  EXPECT_FALSE(columns.insert(0, 40, 50, 1));
  EXPECT_EQ(piecesOf(columns), before);
  columns.expire(0, 1);
  EXPECT_EQ(columns.used(), 0U);
  EXPECT_TRUE(columns.insert(0, 40, 50, 2));
}

TEST(ColumnsTest, ClearingFreesEverything) {
  Columns columns(3, 4);
  ASSERT_TRUE(columns.insert(2, 0, 10, 1));
  ASSERT_TRUE(columns.insert(0, 0, 10, 1));
  columns.clear();
  EXPECT_EQ(columns.used(), 0U);
  for (CellIndex cell = 0; cell < 3; ++cell) EXPECT_TRUE(piecesOf(columns, cell).empty());
  for (int round = 0; round < 3; ++round) {
    ASSERT_TRUE(columns.insert(1, static_cast<Height>(20 * round),
                               static_cast<Height>(20 * round + 10), 2));
  }
}

/// One owner a quantum, 0 for none.
using Owners = std::array<std::uint32_t, 100>;

Owners ownersOf(const Columns& columns) {
  Owners owners{};
  int last_top = -1;
  for (const auto& [bottom, top, serial, born] : piecesOf(columns)) {
    EXPECT_LT(bottom, top);
    EXPECT_GE(bottom, last_top);
    EXPECT_LE(born, serial);
    last_top = top;
    for (int h = bottom; h < top; ++h) owners[static_cast<std::size_t>(h)] = serial;
  }
  return owners;
}

TEST(ColumnsTest, RandomInsertsAndExpiriesLeaveEachQuantumWithItsNewestOwner) {
  test::Random random(31);
  Columns columns(1, 400);
  Owners expected{};
  std::uint32_t oldest = 1;
  for (std::uint32_t serial = 1; serial < 3000; ++serial) {
    for (int i = random.integer(0, 6); i > 0; --i) {
      const int bottom = random.integer(0, 89), top = bottom + random.integer(1, 10);
      ASSERT_TRUE(columns.insert(0, static_cast<Height>(bottom), static_cast<Height>(top), serial));
      std::fill(expected.begin() + bottom, expected.begin() + top, serial);
      ASSERT_EQ(ownersOf(columns), expected) << "serial " << serial;
    }
    while (serial - oldest + 1 > static_cast<std::uint32_t>(random.integer(1, 20))) {
      columns.expire(0, oldest);
      for (std::uint32_t& owner : expected) {
        if (owner == oldest) owner = 0;
      }
      ++oldest;
      ASSERT_EQ(ownersOf(columns), expected) << "serial " << serial;
    }
    ASSERT_EQ(columns.used(), piecesOf(columns).size());
  }
}

}  // namespace
}  // namespace tccm
