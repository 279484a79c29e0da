#include "map/region.h"

#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "support/random.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

const double kNan = std::numeric_limits<double>::quiet_NaN();

PaddedShape ball(double radius, const Vector3& centre, double padding_m) {
  return {{Sphere{radius}, Pose(Eigen::Translation3d(centre))}, padding_m};
}

TEST(RegionTest, APartHasWhatIsWithinItsPaddingAndItsGrowthAndTheBorderToo) {
  const RegionPart part(ball(0.25, {1.0, 0.0, 0.0}, 0.5), 0.25);
  EXPECT_TRUE(part.contains({1.0, 0.0, 0.0}));
  EXPECT_TRUE(part.contains({2.0, 0.0, 0.0}));
  EXPECT_TRUE(part.contains({1.0, 0.0, -1.0}));
  EXPECT_FALSE(part.contains({2.000001, 0.0, 0.0}));
  EXPECT_FALSE(part.contains({1.8, 0.8, 0.0})) << "in its bounds, not in the ball";
}

TEST(RegionTest, ABoxThatIsPaddedHasRoundEdges) {
  const RegionPart part(PaddedShape{{Box{{1.0, 1.0, 1.0}}, Pose::Identity()}, 0.5});
  EXPECT_TRUE(part.contains({1.5, 0.0, 0.0}));
  EXPECT_TRUE(part.contains({1.35, 1.35, 0.0}));
  EXPECT_FALSE(part.contains({1.36, 1.36, 0.0}));
}

TEST(RegionTest, WhatIsNotFiniteIsNowhere) {
  const RegionPart part(ball(1.0, {0.0, 0.0, 0.0}, 0.0));
  EXPECT_FALSE(part.contains({kNan, 0.0, 0.0}));
  EXPECT_FALSE(part.contains({0.0, 0.0, kNan}));
  EXPECT_FALSE(part.contains({0.0, std::numeric_limits<double>::infinity(), 0.0}));
}

TEST(RegionTest, RandomPartsHaveThePointsWhoseDistanceSaysSo) {
  test::Random random(71);
  std::size_t inside = 0;
  for (int i = 0; i < 20000; ++i) {
    const PaddedShape shape{
        {random.shape(static_cast<std::size_t>(i) % test::kShapeKinds), random.pose(0.1)},
        random.chance(0.3) ? 0.0 : random.uniform(0.0, 0.05)};
    const Vector3 p = random.point(0.2);
    const Vector3 p_shape =
        shape.placed.pose.linear().transpose() * (p - shape.placed.pose.translation());
    const bool expected = distance(shape.placed.shape, p_shape) <= shape.padding_m + 0.01;
    ASSERT_EQ(RegionPart(shape, 0.01).contains(p), expected);
    inside += expected ? 1 : 0;
  }
  EXPECT_GT(inside, 1000U);
  EXPECT_LT(inside, 19000U);
}

std::string refusal(const Region& region) {
  try {
    validate(region);
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "";
}

TEST(RegionTest, AnythingThatIsNoGoodIsRefusedByNameInOneLine) {
  const PaddedShape good = ball(0.1, {0.0, 0.0, 0.0}, 0.02);
  EXPECT_EQ(refusal({}), "");
  EXPECT_EQ(refusal({good, good}), "");
  std::vector<PaddedShape> bad(7, good);
  bad[0].placed.shape = Sphere{kNan};
  bad[1].placed.shape = Box{{0.1, -0.1, 0.1}};
  bad[2].placed.pose.translation().x() = kNan;
  bad[3].placed.pose.linear() *= 2.0;
  bad[4].padding_m = -0.001;
  bad[5].padding_m = kNan;
  bad[6].padding_m = 1.001;
  for (std::size_t i = 0; i < bad.size(); ++i) {
    const std::string line = refusal({good, bad[i], good});
    EXPECT_EQ(line.find("shape 1 of the region"), 0U) << i << ": " << line;
    EXPECT_EQ(line.find('\n'), std::string::npos);
  }
  EXPECT_EQ(refusal(Region(kRegionShapesMax, good)), "");
  EXPECT_NE(refusal(Region(kRegionShapesMax + 1, good)), "");
}

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
