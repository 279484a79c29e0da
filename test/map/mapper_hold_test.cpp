// What leaves the window while nobody looks at its place is held.
#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <utility>

#include "map/mapper.h"
#include "support/random.h"
#include "support/small_map.h"

namespace tccm {
namespace {

constexpr double kScanPeriod = 0.025;  // [s]
constexpr int kWindow = 4;             // scans
const Vector3 kViewpoint(0.1, 0.1, 1.5);
const Vector3 kPlace(0.15, 0.15, 0.5);
const Vector3 kElsewhere(0.05, 0.05, 0.3);

Time at(double seconds) { return Time(fromSeconds(seconds)); }

Mapper::Config config() {
  Mapper::Config config = test::smallMapper();
  config.hold.intervals_max = 1000;
  config.window_scans = kWindow;
  config.hold.longest_s = 1.0;
  return config;
}

/// Feeds scans, and lists what the map holds.
class Feed {
 public:
  explicit Feed(const Mapper::Config& config = ::tccm::config()) : mapper_(config) {}

  void scan(std::vector<Look> looks = {}, int times = 1) {
    for (int i = 0; i < times; ++i) {
      ScanReturns scan;
      scan.stamp = at(kScanPeriod * ++scans_);
      scan.viewpoint = kViewpoint;
      scan.looks = looks;
      for (const Look& look : looks) {
        if (look.what == Seen::kSurface) scan.points.push_back(look.end);
      }
      EXPECT_EQ(mapper_.add(scan).dropped, "");
    }
  }
  /// The place is seen, and then no more until that scan has left the window.
  void seeOnce() {
    scan({{kViewpoint, kPlace, Seen::kSurface}});
    scan({}, kWindow);
  }
  std::size_t count(bool held) {
    mapper_.snapshot(map_);
    std::size_t count = 0;
    for (const Cuboid& cuboid : map_.cuboids) count += cuboid.held == held ? 1 : 0;
    return count;
  }
  std::size_t live() { return count(false); }
  std::size_t held() { return count(true); }
  const CuboidMap& map() { return count(true), map_; }
  Mapper& mapper() { return mapper_; }

 private:
  Mapper mapper_;
  CuboidMap map_;
  int scans_ = 0;
};

Look to(const Vector3& end, Seen what = Seen::kSurface) { return {kViewpoint, end, what}; }
/// Past a place, to so much of its distance.
Look past(const Vector3& place, double share, Seen what = Seen::kSurface) {
  return to(kViewpoint + share * (place - kViewpoint), what);
}

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

TEST(MapperHoldTest, WhereMoreIsToBeHeldThanThereIsRoomForTheMapIsNotToBeTrusted) {
  Mapper::Config tight = config();
  tight.hold.intervals_max = 1;
  Feed feed(tight);
  feed.scan({to(kPlace), to(kElsewhere)});
  feed.scan({}, kWindow);
  EXPECT_EQ(feed.held(), 1U);
  EXPECT_TRUE(feed.map().overflowed);
  feed.scan({}, kWindow);
  EXPECT_FALSE(feed.map().overflowed);
}

/// Heights in quanta, by cell.
using Occupied = std::set<std::pair<CellIndex, int>>;

Occupied occupiedBy(const CuboidMap& map, bool held) {
  Occupied occupied;
  for (const Cuboid& cuboid : map.cuboids) {
    if (cuboid.held != held) continue;
    for (int h = cuboid.bottom; h < cuboid.top; ++h) occupied.insert({cuboid.cell, h});
  }
  return occupied;
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
