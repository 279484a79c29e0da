#include "tccm_monitor/direction_grid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "support/random.h"

namespace tccm {
namespace {

TEST(DirectionGridTest, AResolutionThatDoesNotDivideHalfATurnIsMadeFiner) {
  const DirectionGrid grid(0.035);
  EXPECT_EQ(grid.rows(), 90);
  EXPECT_EQ(grid.columns(), 180);
  EXPECT_NEAR(grid.resolution(), M_PI / 90.0, 1e-12);
  EXPECT_EQ(grid.pixels(), 16200U);
}

TEST(DirectionGridTest, TheMiddleOfEachPixelLiesInIt) {
  const DirectionGrid grid(0.05);
  for (int row = 0; row < grid.rows(); ++row) {
    for (int column = 0; column < grid.columns(); ++column) {
      const std::size_t index = grid.index(row, column);
      ASSERT_EQ(grid.pixelOf(0.3 * grid.middle(row, column)), index);
      ASSERT_EQ(grid.rowOfPixel(index), row);
      ASSERT_NEAR(grid.middle(row, column).norm(), 1.0, 1e-12);
    }
  }
}

TEST(DirectionGridTest, RandomDirectionsFallWhereTheirAnglesSay) {
  const DirectionGrid grid(0.02);
  test::Random random(1);
  for (int i = 0; i < 100000; ++i) {
    const Vector3 d = random.uniform(0.1, 3.0) * random.direction();
    const double elevation = std::atan2(d.z(), d.head<2>().norm());
    const double azimuth = std::atan2(d.y(), d.x());
    const int row = static_cast<int>((elevation + M_PI / 2.0) / grid.resolution());
    const int column = static_cast<int>((azimuth + M_PI) / grid.resolution());
    ASSERT_EQ(grid.pixelOf(d), grid.index(row, column)) << d.transpose();
  }
}

TEST(DirectionGridTest, AFollowerFindsTheSamePixelWhereverItWas) {
  const DirectionGrid grid(0.035);
  test::Random random(5);
  const auto any = [&](std::size_t below) {
    return static_cast<std::size_t>(random.integer(0, static_cast<int>(below) - 1));
  };
  for (int i = 0; i < 100000; ++i) {
    Vector3 d = random.uniform(0.1, 3.0) * random.direction();
    if (random.chance(0.3)) {  // near the corner of four pixels, or at an end of the columns
      const double elevation = grid.resolution() * random.integer(0, grid.rows()) - M_PI / 2.0;
      const double azimuth = grid.resolution() * random.integer(0, grid.columns()) - M_PI;
      d = Vector3(std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
                  std::sin(elevation)) +
          random.point(random.chance(0.5) ? 1e-16 : 0.01);
    }
    const std::size_t pixel = grid.pixelOf(d);
    const std::size_t beside = std::min(pixel + any(3), grid.pixels() - 1);
    for (const std::size_t near : {pixel, beside, any(grid.pixels())}) {
      PixelFollower follower(grid);
      follower.follow(grid.middle(near));
      follower.follow(d);
      ASSERT_EQ(follower.pixel(), pixel) << d.transpose();
      ASSERT_EQ(follower.middle(), grid.middle(pixel));
    }
  }
}

TEST(DirectionGridTest, StraightUpAndStraightDownAreInTheLastAndTheFirstRow) {
  const DirectionGrid grid(0.1);
  EXPECT_EQ(grid.rowOfPixel(grid.pixelOf({0.0, 0.0, -2.0})), 0);
  EXPECT_EQ(grid.rowOfPixel(grid.pixelOf({0.0, 0.0, 0.1})), grid.rows() - 1);
}

TEST(DirectionGridTest, NoDirectionWithinAnAngleIsMoreColumnsAway) {
  const DirectionGrid grid(0.035);
  test::Random random(2);
  for (const double angle : {0.01, 0.03, 0.1}) {
    for (int i = 0; i < 20000; ++i) {
      const Vector3 d = random.direction(), any = random.direction();
      const Vector3 off = (any - any.dot(d) * d).normalized();
      const Vector3 other = std::cos(angle) * d + std::sin(angle) * off;
      const auto from = static_cast<int>(grid.pixelOf(d));
      const auto to = static_cast<int>(grid.pixelOf(other));
      const int row = grid.rowOfPixel(static_cast<std::size_t>(to));
      const int apart = std::abs(from % grid.columns() - to % grid.columns());
      ASSERT_LE(std::min(apart, grid.columns() - apart), grid.columnsWithin(row, angle))
          << d.transpose() << " and " << other.transpose();
    }
  }
}

TEST(DirectionGridTest, AroundAPixelAreAllWhoseMiddlesAreWithinTheAngle) {
  const DirectionGrid grid(0.1);
  const double angle = 0.25;
  const DirectionGrid::Around around = grid.around(angle);
  for (std::size_t pixel = 0; pixel < grid.pixels(); pixel += 7) {
    std::vector<bool> visited(grid.pixels(), false);
    EXPECT_FALSE(grid.visitAround(pixel, around, [&](int row, int column) {
      visited[grid.index(row, column)] = true;
      return false;
    }));
    for (std::size_t other = 0; other < grid.pixels(); ++other) {
      const double cosine = grid.middle(pixel).dot(grid.middle(other));
      ASSERT_TRUE(visited[other] || cosine < std::cos(angle)) << pixel << ' ' << other;
    }
    int visits = 0;
    EXPECT_TRUE(grid.visitAround(pixel, around, [&](int, int) { return ++visits == 2; }));
    EXPECT_EQ(visits, 2);
  }
}

}  // namespace
}  // namespace tccm
