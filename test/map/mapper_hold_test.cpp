// What leaves the window while nobody looks at its place is held.
#include <gtest/gtest.h>

#include <algorithm>

#include "map/mapper.h"
#include "support/hold_feed.h"
#include "support/random.h"

namespace tccm {
namespace {

using test::at;
using test::Feed;
using test::kPlace;
using test::kViewpoint;
using test::kWindow;
using test::Occupied;
using test::occupiedBy;
using test::past;
using test::to;

const Vector3 kElsewhere(0.05, 0.05, 0.3);

Mapper::Config config() { return test::holdingMapper(); }

TEST(MapperHoldTest, WhatNobodyLookedAtAgainIsHeldWithItsPointsAndItsAge) {
  Feed feed;
  feed.scan({to(kPlace), to(kPlace)});
  feed.scan({}, kWindow - 1);
  EXPECT_EQ(feed.live(), 1U);
  EXPECT_EQ(feed.held(), 0U);
  const Cuboid live = feed.map().cuboids.front();
  feed.scan({}, 3);
  EXPECT_EQ(feed.live(), 0U);
  ASSERT_EQ(feed.held(), 1U);
  const Cuboid held = feed.map().cuboids.front();
  EXPECT_EQ(held.cell, live.cell);
  EXPECT_EQ(held.bottom, live.bottom);
  EXPECT_EQ(held.top, live.top);
  EXPECT_EQ(held.points, 2U);
  EXPECT_EQ(held.age_scans, live.age_scans + 3);
}

TEST(MapperHoldTest, WhatItsNeighboursSupportedIsHeldWithTheirPoints) {
  const Vector3 beside = kPlace + Vector3(0.02, 0.0, 0.01);
  Feed feed;
  feed.scan({to(kPlace), to(kElsewhere)});
  feed.scan({to(beside), to(beside)});
  feed.scan({past(beside, 1.1, Seen::kNothing), past(kElsewhere, 1.1, Seen::kNothing)});
  feed.scan({}, kWindow);
  ASSERT_EQ(feed.held(), 1U);
  EXPECT_EQ(feed.map().cuboids.front().points, 3U);
}

TEST(MapperHoldTest, WhatFewerReturnsLieAroundThanWantedIsNotHeld) {
  const Vector3 beside = kPlace + Vector3(0.02, 0.0, 0.01);
  for (const std::size_t wanted : {1U, 4U}) {
    for (std::size_t returns = 1; returns < 8; ++returns) {
      Mapper::Config holding = config();
      holding.hold.support_points = wanted;
      Feed feed(holding);
      std::vector<Look> looks(returns / 2, to(beside));
      looks.resize(returns, to(kPlace));
      feed.scan(looks);
      EXPECT_GT(feed.live(), 0U);
      feed.scan({}, kWindow);
      EXPECT_EQ(feed.held() > 0, returns >= wanted) << returns;
    }
  }
}

/// Returns of a place that came and left the window before the next came.
struct Earlier {
  CellIndex cell;
  int bottom, top;
  std::uint32_t returns;
};

TEST(MapperHoldTest, WhatIsHeldCountsForWhatIsHeldNearIt) {
  std::size_t near = 0, apart = 0;
  for (unsigned seed = 0; seed < 60; ++seed) {
    test::Random random(seed);
    Mapper::Config holding = config();
    holding.hold.look_angle_rad = 0.005;
    Feed feed(holding);
    const Grid grid(holding.map.grid);
    std::vector<Earlier> earlier;
    for (int i = 0; i < 4; ++i) {
      const Vector3 place(0.02 * random.integer(3, 6) + 0.01, 0.02 * random.integer(3, 6) + 0.01,
                          0.3 + 0.001 * random.integer(0, 100));
      const CellIndex cell = grid.place(place)->cell;
      const int top = grid.place(place)->height, bottom = top - 20;
      const auto isIn = [cell](const Earlier& other) { return other.cell == cell; };
      if (std::any_of(earlier.begin(), earlier.end(), isIn)) continue;
      const auto returns = static_cast<std::uint32_t>(random.integer(1, 5));
      feed.scan(std::vector<Look>(returns, to(place)));
      feed.scan({}, kWindow);
      std::uint32_t support = returns;
      const auto column = [&](CellIndex c) { return static_cast<int>(c % grid.cellsX()); };
      const auto row = [&](CellIndex c) { return static_cast<int>(c / grid.cellsX()); };
      for (const Earlier& other : earlier) {
        const bool is_near = std::abs(column(other.cell) - column(cell)) <= 1 &&
                             std::abs(row(other.cell) - row(cell)) <= 1 &&
                             other.bottom - 30 <= top && bottom - 30 <= other.top;
        support += is_near ? other.returns : 0;
        ++(is_near ? near : apart);
      }
      earlier.push_back({cell, bottom, top, returns});
      ASSERT_EQ(feed.held(), earlier.size()) << seed;
      for (const Cuboid& cuboid : feed.map().cuboids) {
        EXPECT_TRUE(cuboid.cell != cell || cuboid.points == support) << seed;
      }
    }
  }
  EXPECT_GT(near, 20U);
  EXPECT_GT(apart, 50U);
}

TEST(MapperHoldTest, OfWhatALaterReturnLeftOverOfAnIntervalOneReturnCounts) {
  const Vector3 below = kPlace - Vector3(0.0, 0.0, 0.005),
                beside = kPlace + Vector3(0.0, 0.02, 0.0);
  const Look hand = past(kPlace + Vector3(0.0, 0.0, 0.03), 0.8, Seen::kRobot);
  Feed feed;
  feed.scan({to(kPlace)});
  feed.scan({hand, to(below)});
  feed.scan({hand}, kWindow);
  ASSERT_EQ(feed.held(), 2U);
  feed.scan({hand, to(beside)});
  feed.scan({hand}, kWindow);
  ASSERT_EQ(feed.held(), 3U);
  const CellIndex cell = feed.map().grid.place(beside)->cell;
  for (const Cuboid& cuboid : feed.map().cuboids) {
    EXPECT_TRUE(cuboid.cell != cell || cuboid.points == 3);
  }
}

TEST(MapperHoldTest, WhatIsHeldDoesNotMakeAFewReturnsBesideItStay) {
  Mapper::Config holding = config();
  holding.hold.support_points = 4;
  Feed feed(holding);
  feed.scan(std::vector<Look>(4, to(kPlace)));
  feed.scan({}, kWindow);
  ASSERT_EQ(feed.held(), 1U);
  feed.scan(std::vector<Look>(3, to(kPlace + Vector3(0.02, 0.0, 0.0))));
  feed.scan({}, kWindow);
  EXPECT_EQ(feed.held(), 1U);
}

TEST(MapperHoldTest, WhatWasLookedThroughMeanwhileIsGone) {
  Feed feed;
  feed.scan({to(kPlace)});
  feed.scan({past(kPlace, 1.5, Seen::kNothing)});
  feed.scan({}, kWindow);
  EXPECT_EQ(feed.live() + feed.held(), 0U);
}

TEST(MapperHoldTest, ALookThatEndsOnTheRobotOrBeforeThePlaceLeavesItHeld) {
  for (const Look& look : {past(kPlace, 1.5, Seen::kRobot), past(kPlace, 0.8, Seen::kNothing),
                           past(kPlace + Vector3(0.06, 0.0, 0.0), 1.5, Seen::kNothing)}) {
    Feed feed;
    feed.scan({to(kPlace)});
    feed.scan({look});
    feed.scan({}, kWindow);
    EXPECT_EQ(feed.held(), 1U);
    feed.scan({look});
    EXPECT_EQ(feed.held(), 1U);
  }
}

/// A thin neck half behind the robot's hand: scan lines pass just below what the hand hides of it.
TEST(MapperHoldTest, WhatIsNextToTheRobotsOutlineStaysHeldWhenALookEndsJustBesideIt) {
  const Vector3 hidden = kPlace + Vector3(0.0, 0.0, 0.015);
  const Vector3 below = kPlace - Vector3(0.0, 0.0, 0.01);
  const Look hand = past(kPlace + Vector3(0.0, 0.0, 0.03), 0.8, Seen::kRobot);
  Feed feed;
  feed.scan({to(hidden)});
  feed.scan({hand, to(below)});
  feed.scan({hand}, kWindow);
  EXPECT_EQ(feed.held(), 2U);
  feed.scan({hand, to(below)});
  EXPECT_EQ(feed.held(), 1U) << "of what the look ended on nothing is held";
  EXPECT_EQ(feed.live(), 1U);
  feed.scan({}, kWindow + 1);
  feed.scan({past(below, 1.5, Seen::kNothing), past(hidden, 1.5, Seen::kNothing)});
  EXPECT_EQ(feed.held(), 0U) << "the hand has left";
}

/// In all directions around the place, to so much of its distance; the robot's hand is beside them.
std::vector<Look> allAround(double share) {
  std::vector<Look> looks = {past(kPlace + Vector3(0.13, 0.0, 0.0), 0.8, Seen::kRobot)};
  for (int x = -8; x <= 8; ++x) {
    for (int y = -8; y <= 8; ++y) {
      looks.push_back(past(kPlace + 0.01 * Vector3(x, y, 0.0), share, Seen::kNothing));
    }
  }
  return looks;
}

TEST(MapperHoldTest, NextToTheRobotAPlaceIsLetGoOfOnceItIsLookedThroughAllAroundIt) {
  Mapper::Config wide = config();
  wide.hold.outline_rad = 0.15;
  Feed feed(wide);
  feed.seeOnce();
  feed.scan(allAround(1.0), 2);
  EXPECT_EQ(feed.held(), 1U) << "something is still there";
  feed.scan(allAround(1.2), 2);
  EXPECT_EQ(feed.held(), 0U);
}

TEST(MapperHoldTest, NextToTheRobotWhatWasLookedThroughAllAroundInTheWindowIsNeverHeld) {
  Mapper::Config wide = config();
  wide.hold.outline_rad = 0.15;
  wide.window_scans = 12;
  Feed feed(wide);
  feed.scan({to(kPlace)});
  feed.scan({}, 6);
  feed.scan(allAround(1.2), 2);
  for (int i = 0; i < 8; ++i) {
    feed.scan();
    EXPECT_EQ(feed.held(), 0U) << i;
  }
}

TEST(MapperHoldTest, WhereTheRobotStoodBeforeTheMapBeganAnewHidesNothing) {
  Feed feed;
  feed.scan({past(kPlace + Vector3(0.0, 0.02, 0.0), 0.8, Seen::kRobot)});
  feed.mapper().clear();
  feed.scan({to(kPlace)});
  feed.scan({past(kPlace, 1.5, Seen::kNothing)});
  feed.scan({}, kWindow);
  EXPECT_EQ(feed.held(), 0U);
}

TEST(MapperHoldTest, AHeldIntervalIsLetGoOfOnceItsPlaceIsSeenAgain) {
  for (const Look& look :
       {past(kPlace, 1.5, Seen::kNothing), past(kPlace, 1.1), to(kPlace), past(kPlace, 0.97)}) {
    Feed feed;
    feed.seeOnce();
    ASSERT_EQ(feed.held(), 1U);
    feed.scan({look});
    EXPECT_EQ(feed.held(), 0U);
  }
}

TEST(MapperHoldTest, ItIsHeldForHoldSecondsAtMost) {
  Feed feed;
  feed.seeOnce();
  feed.scan({}, 40);  // 1 s
  EXPECT_EQ(feed.held(), 1U);
  feed.scan({});
  EXPECT_EQ(feed.held(), 0U);
}

TEST(MapperHoldTest, WithoutHoldingItIsGoneAtOnce) {
  Mapper::Config off = config();
  off.hold.longest_s = 0.0;
  Feed feed(off);
  feed.seeOnce();
  EXPECT_EQ(feed.live() + feed.held(), 0U);
}

TEST(MapperHoldTest, WhatWasLookedAtBeforeTheScanThatSawItCountsForNothing) {
  Feed feed;
  feed.scan({past(kPlace, 1.5, Seen::kNothing)});
  feed.seeOnce();
  EXPECT_EQ(feed.held(), 1U);
}

TEST(MapperHoldTest, WhatTheRobotTakesIsNotHeld) {
  Feed feed;
  feed.scan({to(kPlace), to(kElsewhere)});
  feed.scan({}, kWindow);
  ASSERT_EQ(feed.held(), 2U);
  const PaddedShape ball{{Sphere{0.02}, Pose(Eigen::Translation3d(kPlace))}, 0.02};
  feed.mapper().forget({ball}, at(0.0));
  EXPECT_EQ(feed.held(), 1U);
  feed.mapper().clear();
  EXPECT_EQ(feed.held(), 0U);
}

TEST(MapperHoldTest, OfAFloorThatALaterScanSawHigherNothingBelowTheLeastHeightIsHeld) {
  Feed feed;
  feed.scan({to({0.15, 0.15, 0.0})});
  feed.scan({to({0.15, 0.15, 0.005})});
  for (int i = 0; i < 2 * kWindow; ++i) {
    for (const Cuboid& cuboid : feed.map().cuboids) EXPECT_GE(cuboid.bottom, 0) << i;
    feed.scan();
  }
  ASSERT_EQ(feed.held(), 1U);
  EXPECT_EQ(feed.map().cuboids.front().top, 5);
}

TEST(MapperHoldTest, OfNoiseAboutTheLeastHeightNothingBelowItIsEverLiveOrHeld) {
  std::size_t held = 0;
  for (unsigned seed = 1; seed <= 30; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    test::Random random(seed);
    Mapper::Config raised = config();
    const double least = raised.map.grid.height_min_m = 0.001 * random.integer(-200, 200);
    Feed feed(raised);
    for (int step = 0; step < 60; ++step) {
      std::vector<Look> looks;
      for (int i = random.integer(0, 2); i > 0; --i) {
        looks.push_back(to({random.uniform(0.0, 0.2), random.uniform(0.0, 0.2),
                            least + 0.001 * random.integer(-3, 25)}));
      }
      feed.scan(looks);
      for (const Cuboid& cuboid : feed.map().cuboids) {
        ASSERT_GE(feed.map().grid.metres(cuboid.bottom), least - 1e-9) << step;
        ASSERT_LT(cuboid.bottom, cuboid.top) << step;
        held += cuboid.held ? 1 : 0;
      }
    }
  }
  EXPECT_GT(held, 100U);
}

TEST(MapperHoldTest, WhereMoreIsToBeHeldThanThereIsRoomForTheMapIsNotToBeTrusted) {
  Mapper::Config tight = config();
  tight.hold.intervals_max = 1;
  Feed feed(tight);
  feed.scan({to(kPlace), to(kElsewhere)});
  feed.scan({}, kWindow);
  EXPECT_EQ(feed.held(), 1U);
  EXPECT_TRUE(feed.map().overflowed);
  const auto until_it_ends = static_cast<int>(tight.hold.longest_s / test::kScanPeriod);
  ASSERT_GT(until_it_ends, kWindow);
  feed.scan({}, until_it_ends - 2);
  EXPECT_TRUE(feed.map().overflowed) << "what is missing would be held yet";
  feed.scan({}, 2);
  EXPECT_FALSE(feed.map().overflowed);
}

TEST(MapperHoldTest, WhereWhatIsSeenAgainLeavesTwoPiecesAndRoomForOneTheMapIsNotToBeTrusted) {
  Mapper::Config tight = config();
  tight.hold.intervals_max = 1;
  Feed feed(tight);
  const Vector3 step(0.0, 0.0, 0.02);
  feed.scan({to(kPlace - step), to(kPlace), to(kPlace + step)});
  feed.scan({}, kWindow);
  ASSERT_EQ(feed.held(), 1U);
  EXPECT_FALSE(feed.map().overflowed);
  feed.scan({to(kPlace)});
  EXPECT_TRUE(feed.map().overflowed);
}

TEST(MapperHoldTest, RandomStreamsLeaveTheLiveMapAsItIsWithoutHoldingAndApartFromWhatIsHeld) {
  Mapper::Config off = config();
  off.hold.longest_s = 0.0;
  Feed holding, plain(off);
  test::Random random(5);
  std::size_t most = 0;
  for (int step = 0; step < 3000; ++step) {
    std::vector<Look> looks;
    for (int i = random.integer(0, 6); i > 0; --i) {
      const Vector3 place(random.uniform(0.0, 0.2), random.uniform(0.0, 0.2),
                          random.uniform(0.1, 0.3));
      looks.push_back(random.chance(0.3)
                          ? past(place, 1.4, random.chance(0.5) ? Seen::kRobot : Seen::kNothing)
                          : to(place));
    }
    holding.scan(looks);
    plain.scan(looks);
    const Occupied live = occupiedBy(holding.map(), false);
    ASSERT_EQ(live, occupiedBy(plain.map(), false)) << step;
    const Occupied held = occupiedBy(holding.map(), true);
    for (const auto& place : held) ASSERT_EQ(live.count(place), 0U) << step;
    const auto& cuboids = holding.map().cuboids;
    for (std::size_t i = 1; i < cuboids.size(); ++i) {
      const Cuboid &below = cuboids[i - 1], &above = cuboids[i];
      ASSERT_TRUE(below.cell < above.cell ||
                  (below.cell == above.cell && below.top <= above.bottom));
    }
    most = std::max(most, holding.held());
  }
  EXPECT_GT(most, 20U);
}

}  // namespace
}  // namespace tccm
