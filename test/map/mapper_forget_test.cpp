// What is held leaves where the robot takes it, by height.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "map/mapper.h"
#include "support/beyond_padding.h"
#include "support/hold_feed.h"
#include "support/random.h"

namespace tccm {
namespace {

using test::at;
using test::Feed;
using test::kWindow;
using test::Occupied;
using test::occupiedBy;
using test::to;

/// From the lowest to the highest return, without a gap.
std::vector<Look> column(double x, double y, double lowest, double highest) {
  std::vector<Look> looks;
  for (double z = lowest; z < highest + 1e-9; z += 0.02) looks.push_back(to({x, y, z}));
  return looks;
}

/// The heights of what is held.
std::vector<std::pair<int, int>> heldHeights(Feed& feed) {
  std::vector<std::pair<int, int>> heights;
  for (const Cuboid& cuboid : feed.map().cuboids) {
    if (cuboid.held) heights.emplace_back(cuboid.bottom, cuboid.top);
  }
  return heights;
}

TEST(MapperForgetTest, OfAHeldColumnTheRobotTakesWhatLiesInTheRegionAndNoMore) {
  using Heights = std::vector<std::pair<int, int>>;
  const std::vector<std::pair<Vector3, Heights>> cases = {
      {{0.15, 0.15, 0.49}, {{80, 396}, {584, 900}}},  // 80 mm, and half a cell's diagonal
      {{0.15, 0.15, 0.85}, {{80, 756}}},
      {{0.15, 0.15, 0.05}, {{144, 900}}},
      {{0.30, 0.15, 0.49}, {{80, 900}}},
      {{0.15, 0.15, 1.10}, {{80, 900}}},
  };
  for (const auto& [centre, left] : cases) {
    Feed feed;
    feed.scan(column(0.15, 0.15, 0.1, 0.9));
    feed.scan({}, kWindow);
    ASSERT_EQ(heldHeights(feed), (Heights{{80, 900}}));
    feed.mapper().forget({{{Sphere{0.05}, Pose(Eigen::Translation3d(centre))}, 0.03}}, at(0.0));
    EXPECT_EQ(heldHeights(feed), left) << centre.transpose();
  }
}

/// Of points all over a cell's quantum.
double leastBeyond(const Region& region, const UprightBox& quantum) {
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 50; ++i) {
    const int column = i % 5, row = i / 5 % 5, layer = i / 25;
    const Vector3 share(0.25 * column, 0.25 * row, layer);
    least = std::min(least, test::distanceBeyondPadding(
                                region, quantum.min() + share.cwiseProduct(quantum.sizes())));
  }
  return least;
}

Region randomRegion(test::Random& random, int shapes) {
  Region region;
  for (; shapes > 0; --shapes) {
    Pose pose = random.pose(0.0);
    pose.translation() =
        Vector3(random.uniform(0.0, 0.2), random.uniform(0.0, 0.2), random.uniform(0.0, 1.1));
    const auto kind = static_cast<std::size_t>(random.integer(0, test::kShapeKinds - 1));
    region.push_back(
        {{random.shape(kind), pose}, random.chance(0.3) ? 0.0 : random.uniform(0.0, 0.05)});
  }
  return region;
}

TEST(MapperForgetTest, OfRandomColumnsTheRobotTakesAllThatWasInRandomRegionsAndNothingFurtherOff) {
  const double diagonal = std::hypot(std::sqrt(2.0) * 0.02, 0.001);
  std::size_t taken = 0, kept = 0, between = 0;
  for (unsigned seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    test::Random random(seed);
    Feed feed;
    std::vector<Look> looks;
    for (int i = random.integer(1, 12); i > 0; --i) {
      const double bottom = random.uniform(0.0, 0.6);
      const auto more = column(random.uniform(0.0, 0.2), random.uniform(0.0, 0.2), bottom,
                               bottom + random.uniform(0.0, 0.5));
      looks.insert(looks.end(), more.begin(), more.end());
    }
    feed.scan(looks);
    feed.scan({}, kWindow);
    const Occupied before = occupiedBy(feed.map(), true);
    ASSERT_FALSE(before.empty());
    const Region region = randomRegion(random, random.integer(1, 4));
    feed.mapper().forget(region, at(0.0));
    const Occupied after = occupiedBy(feed.map(), true);
    for (const auto& place : after) ASSERT_EQ(before.count(place), 1U);
    for (const auto& [cell, height] : before) {
      const double off = leastBeyond(region, feed.map().grid.box(cell, height, height + 1));
      const bool stayed = after.count({cell, height}) > 0;
      if (off <= 0.0) {
        ASSERT_FALSE(stayed) << "cell " << cell << " at " << height << " mm";
        ++taken;
      } else if (off > diagonal) {
        ASSERT_TRUE(stayed) << "cell " << cell << " at " << height << " mm";
        ++kept;
      } else {
        ++between;
      }
    }
    const auto& cuboids = feed.map().cuboids;
    for (std::size_t i = 1; i < cuboids.size(); ++i) {
      const Cuboid &below = cuboids[i - 1], &above = cuboids[i];
      ASSERT_TRUE(below.cell < above.cell ||
                  (below.cell == above.cell && below.top <= above.bottom));
    }
  }
  EXPECT_GT(taken, 3000U);
  EXPECT_GT(kept, 10000U);
  EXPECT_LT(between, taken + kept);
}

TEST(MapperForgetTest, WhatTheRobotsRegionCutsInTwoWithoutRoomMakesTheMapNotToBeTrusted) {
  Mapper::Config tight = test::holdingMapper();
  tight.hold.intervals_max = 1;
  Feed feed(tight);
  feed.scan(column(0.15, 0.15, 0.1, 0.9));
  feed.scan({}, kWindow);
  ASSERT_FALSE(feed.map().overflowed);
  feed.mapper().forget({{{Sphere{0.05}, Pose(Eigen::Translation3d(0.15, 0.15, 0.49))}, 0.03}},
                       at(0.0));
  EXPECT_TRUE(feed.map().overflowed);
  feed.scan({}, static_cast<int>(tight.hold.longest_s / test::kScanPeriod));
  EXPECT_FALSE(feed.map().overflowed);
}

}  // namespace
}  // namespace tccm
