#include "map/columns.h"

#include <gtest/gtest.h>

#include <array>
#include <deque>
#include <tuple>
#include <vector>

#include "support/random.h"

namespace tccm {
namespace {

constexpr std::size_t kScans = 30;

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
  Columns columns(1, 100, kScans);
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
  Columns columns(1, 10, kScans);
  ASSERT_TRUE(columns.insert(0, 0, 20, 0xFFFFFFFEU));
  ASSERT_TRUE(columns.insert(0, 10, 30, 2U));
  EXPECT_EQ(piecesOf(columns),
            (Pieces{{0, 10, 0xFFFFFFFEU, 0xFFFFFFFEU}, {10, 30, 2U, 0xFFFFFFFEU}}));
}

TEST(ColumnsTest, ExpiryRemovesWhatTheScanStillOwns) {
  Columns columns(2, 10, kScans);
  ASSERT_TRUE(columns.insert(0, 0, 50, 1));
  ASSERT_TRUE(columns.insert(1, 0, 50, 1));
  ASSERT_TRUE(columns.insert(0, 10, 30, 2));
  columns.expire(1);
  EXPECT_EQ(piecesOf(columns), (Pieces{{10, 30, 2, 1}}));
  EXPECT_EQ(piecesOf(columns, 1), (Pieces{}));
  EXPECT_EQ(columns.used(), 1U);
}

TEST(ColumnsTest, AnInsertThatMightNotFitIsRefusedAndChangesNothing) {
  Columns columns(1, 3, kScans);
  ASSERT_TRUE(columns.insert(0, 0, 10, 1));
  ASSERT_TRUE(columns.insert(0, 20, 30, 1));
  const Pieces before = piecesOf(columns);
  EXPECT_FALSE(columns.insert(0, 40, 50, 1));
  EXPECT_EQ(piecesOf(columns), before);
  columns.expire(1);
  EXPECT_EQ(columns.used(), 0U);
  EXPECT_TRUE(columns.insert(0, 40, 50, 2));
}

TEST(ColumnsTest, ClearingFreesEverything) {
  Columns columns(3, 4, kScans);
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

constexpr std::uint32_t kNobody = 9;

/// Cell 0 after [0, 50) of scan 1 and [20, 30) of scan 3.
Columns carved(std::size_t intervals_max) {
  Columns columns(1, intervals_max, kScans);
  EXPECT_TRUE(columns.insert(0, 0, 50, 1));
  EXPECT_TRUE(columns.insert(0, 20, 30, 3));
  return columns;
}

TEST(ColumnsTest, DisowningTakesTheIntervalsThatMeetTheHeightsAndLeavesTheirBirths) {
  Columns columns = carved(10);
  const Columns::Heights disowned = columns.disown(0, {25, 30}, kNobody);
  EXPECT_EQ(disowned.bottom, 20);
  EXPECT_EQ(disowned.top, 30);
  EXPECT_EQ(piecesOf(columns), (Pieces{{0, 20, 1, 1}, {20, 30, kNobody, 1}, {30, 50, 1, 1}}));
  EXPECT_EQ(columns.disown(0, {25, 31}, kNobody).top, 50);
  columns.expire(kNobody);
  EXPECT_EQ(piecesOf(columns), (Pieces{{0, 20, 1, 1}}));
  EXPECT_EQ(columns.used(), 1U);
}

TEST(ColumnsTest, AClaimGetsWhatIsNobodysAndNothingElse) {
  Columns columns = carved(10);
  (void)columns.disown(0, {30, 40}, kNobody);
  EXPECT_TRUE(columns.claim(0, {25, 40}, 2, kNobody));
  EXPECT_EQ(piecesOf(columns),
            (Pieces{{0, 20, 1, 1}, {20, 30, 3, 1}, {30, 40, 2, 1}, {40, 50, kNobody, 1}}));
  EXPECT_TRUE(columns.claim(0, {60, 70}, 2, kNobody));
  EXPECT_TRUE(columns.claim(0, {45, 48}, 2, kNobody));
  columns.expire(kNobody);
  EXPECT_EQ(piecesOf(columns),
            (Pieces{{0, 20, 1, 1}, {20, 30, 3, 1}, {30, 40, 2, 1}, {45, 48, 2, 1}}));
  EXPECT_EQ(columns.used(), 4U);
}

TEST(ColumnsTest, ClaimsOfOneScanThatTouchAreOneIntervalWhereTheirBirthsAreAlike) {
  Columns columns = carved(10);
  ASSERT_TRUE(columns.insert(0, 50, 60, 4));
  (void)columns.disown(0, {0, 60}, kNobody);
  EXPECT_TRUE(columns.claim(0, {40, 60}, 2, kNobody));
  EXPECT_TRUE(columns.claim(0, {0, 10}, 2, kNobody));
  EXPECT_TRUE(columns.claim(0, {5, 45}, 2, kNobody));
  EXPECT_EQ(piecesOf(columns), (Pieces{{0, 50, 2, 1}, {50, 60, 2, 4}}));
  EXPECT_EQ(columns.used(), 2U);
}

TEST(ColumnsTest, AClaimWithoutRoomToSplitTakesMoreAndSaysSo) {
  Columns columns(1, 2, kScans);
  ASSERT_TRUE(columns.insert(0, 0, 50, 1));
  (void)columns.disown(0, {0, 50}, kNobody);
  EXPECT_FALSE(columns.claim(0, {10, 30}, 1, kNobody));
  EXPECT_EQ(piecesOf(columns), (Pieces{{0, 10, kNobody, 1}, {10, 50, 1, 1}}));
  columns.expire(kNobody);
  columns.expire(1);
  EXPECT_EQ(columns.used(), 0U);
}

TEST(ColumnsTest, NobodysSerialMayBeTheOneAfterTheWrap) {
  Columns columns(1, 10, kScans);
  ASSERT_TRUE(columns.insert(0, 0, 20, 0xFFFFFFFEU));
  ASSERT_TRUE(columns.insert(0, 10, 30, 0xFFFFFFFFU));
  (void)columns.disown(0, {0, 30}, 0U);
  EXPECT_TRUE(columns.claim(0, {0, 20}, 0xFFFFFFFEU, 0U));
  columns.expire(0U);
  EXPECT_EQ(piecesOf(columns), (Pieces{{0, 20, 0xFFFFFFFEU, 0xFFFFFFFEU}}));
}

TEST(ColumnsTest, WhatWasClaimedLeavesWithItsNewOwnerAlone) {
  Columns columns = carved(10);
  ASSERT_TRUE(columns.insert(0, 60, 70, 1));
  (void)columns.disown(0, {0, 50}, kNobody);
  EXPECT_TRUE(columns.claim(0, {0, 50}, 2, kNobody));
  columns.expire(1);
  EXPECT_EQ(piecesOf(columns), (Pieces{{0, 50, 2, 1}}));
  columns.expire(2);
  EXPECT_EQ(columns.used(), 0U);
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
  Columns columns(1, 400, kScans);
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
      columns.expire(oldest);
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
