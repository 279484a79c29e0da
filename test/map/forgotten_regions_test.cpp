#include "map/forgotten_regions.h"

#include <gtest/gtest.h>

namespace tccm {
namespace {

Time at(double seconds) { return Time(fromSeconds(seconds)); }

/// A ball of 100 mm around x.
Region ballAt(double x) { return {{{Sphere{0.1}, Pose(Eigen::Translation3d(x, 0.0, 0.0))}, 0.0}}; }
Vector3 pointAt(double x) { return {x, 0.0, 0.0}; }

TEST(ForgottenRegionsTest, AtFirstNothingIsForgotten) {
  ForgottenRegions regions;
  EXPECT_FALSE(regions.begin(at(1.0)));
  EXPECT_FALSE(regions.contains(pointAt(0.0)));
  regions.add({}, at(2.0));
  EXPECT_FALSE(regions.begin(at(1.0)));
}

TEST(ForgottenRegionsTest, EachRegionCountsUpToItsOwnStamp) {
  ForgottenRegions regions;
  regions.add(ballAt(0.0), at(2.0));
  regions.add(ballAt(1.0), at(3.0));
  EXPECT_TRUE(regions.begin(at(2.0)));
  EXPECT_TRUE(regions.contains(pointAt(0.05)));
  EXPECT_TRUE(regions.contains(pointAt(1.05)));
  EXPECT_FALSE(regions.contains(pointAt(0.5)));
  EXPECT_TRUE(regions.begin(at(2.1)));
  EXPECT_FALSE(regions.contains(pointAt(0.05)));
  EXPECT_TRUE(regions.contains(pointAt(1.05)));
  EXPECT_EQ(regions.size(), 1U);
  EXPECT_FALSE(regions.begin(at(3.1)));
  EXPECT_EQ(regions.size(), 0U);
}

TEST(ForgottenRegionsTest, AStampOfAnotherClockMakesNothingBlind) {
  ForgottenRegions regions;
  regions.add(ballAt(0.0), at(1.7e9));
  EXPECT_FALSE(regions.begin(at(100.0)));
  EXPECT_FALSE(regions.contains(pointAt(0.0)));
  EXPECT_FALSE(regions.begin(at(1.7e9 - 10.1)));
  EXPECT_TRUE(regions.begin(at(1.7e9 - 10.0)));
  EXPECT_TRUE(regions.contains(pointAt(0.0)));
}

TEST(ForgottenRegionsTest, ShapesBeyondTheBoundPushOutTheFirst) {
  ForgottenRegions regions;
  const std::size_t bytes = regions.memoryBytes();
  const int more = 5, all = static_cast<int>(ForgottenRegions::kShapesMax) + more;
  for (int i = 0; i < all; ++i) regions.add(ballAt(i), at(2.0));
  EXPECT_EQ(regions.size(), ForgottenRegions::kShapesMax);
  EXPECT_TRUE(regions.begin(at(1.0)));
  for (int i = 0; i < all; ++i) EXPECT_EQ(regions.contains(pointAt(i)), i >= more) << i;
  Region largest;
  for (std::size_t i = 0; i < kRegionShapesMax; ++i) largest.push_back(ballAt(-1.0).front());
  regions.add(largest, at(2.0));
  EXPECT_TRUE(regions.begin(at(1.0)));
  EXPECT_TRUE(regions.contains(pointAt(-1.0)));
  EXPECT_FALSE(regions.contains(pointAt(all - 1)));
  EXPECT_EQ(regions.memoryBytes(), bytes);
}

TEST(ForgottenRegionsTest, ClearingEndsAllOfThem) {
  ForgottenRegions regions;
  regions.add(ballAt(0.0), at(2.0));
  regions.begin(at(1.0));
  regions.clear();
  EXPECT_FALSE(regions.contains(pointAt(0.0)));
  EXPECT_FALSE(regions.begin(at(1.0)));
}

}  // namespace
}  // namespace tccm
