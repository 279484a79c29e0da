#include "fit/planar.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <limits>

#include "support/random.h"

namespace tccm {
namespace {

using test::Random;

double cross(const Vector2& a, const Vector2& b) { return a.x() * b.y() - a.y() * b.x(); }

std::vector<Vector2> randomPoints(Random& random) {
  std::vector<Vector2> points;
  const int count = random.integer(1, 60);
  const bool on_grid = random.chance(0.3);
  for (int k = 0; k < count; ++k) {
    Vector3 p = random.point(1.0);
    if (on_grid) p = (3.0 * p).array().round();
    points.emplace_back(p.head<2>());
  }
  return points;
}

double bruteForceArea(const std::vector<Vector2>& points, double thinnest) {
  constexpr int kAngles = 5000;
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < kAngles; ++i) {
    const Eigen::Rotation2Dd turn(0.5 * M_PI * i / kAngles);
    Eigen::AlignedBox2d box;
    for (const Vector2& p : points) box.extend(Vector2(turn * p));
    least = std::min(least, box.sizes().cwiseMax(thinnest).prod());
  }
  return least;
}

TEST(PlanarTest, TheHullTurnsLeftAndNoPointIsRightOfIt) {
  Random random(1);
  for (int i = 0; i < 1000; ++i) {
    const std::vector<Vector2> points = randomPoints(random);
    const std::vector<Vector2> hull = planarHull(points);
    for (std::size_t k = 0; k < hull.size() && hull.size() > 1; ++k) {
      const Vector2 a = hull[k];
      const Vector2 b = hull[(k + 1) % hull.size()];
      if (hull.size() > 2) {
        ASSERT_GT(cross(b - a, hull[(k + 2) % hull.size()] - b), 0.0);
      }
      for (const Vector2& p : points) ASSERT_GT(cross(b - a, p - a), -1e-12);
    }
  }
}

TEST(PlanarTest, ASquareOfManyPointsHasFourCorners) {
  std::vector<Vector2> points;
  for (int x = 0; x <= 8; ++x) {
    for (int y = 0; y <= 8; ++y) points.emplace_back(x, y);
  }
  EXPECT_EQ(planarHull(points).size(), 4U);
}

TEST(PlanarTest, TheRectangleHoldsEveryPointAndIsAsSmallAsOfAnyAngle) {
  Random random(2);
  for (int i = 0; i < 200; ++i) {
    const std::vector<Vector2> points = randomPoints(random);
    const Rectangle rectangle = smallestRectangle(planarHull(points), 1e-6);
    const Vector2 along_y(-rectangle.along_x.y(), rectangle.along_x.x());
    for (const Vector2& p : points) {
      const Vector2 from = p - rectangle.centre;
      ASSERT_LE(std::abs(from.dot(rectangle.along_x)), rectangle.half_extents.x() + 1e-12) << i;
      ASSERT_LE(std::abs(from.dot(along_y)), rectangle.half_extents.y() + 1e-12) << i;
    }
    const double area = 4.0 * rectangle.half_extents.prod();
    const double brute_force = bruteForceArea(points, 1e-6);
    ASSERT_LE(area, brute_force * (1.0 + 1e-9)) << i;
  }
}

TEST(PlanarTest, ARotatedRectangleIsFoundAgain) {
  Random random(3);
  for (int i = 0; i < 200; ++i) {
    const Eigen::Rotation2Dd turn(random.uniform(0.0, 6.0));
    const Vector2 half(random.uniform(0.01, 1.0), random.uniform(0.01, 1.0));
    std::vector<Vector2> corners;
    for (const Vector2& sign : {Vector2(1, 1), Vector2(-1, 1), Vector2(1, -1), Vector2(-1, -1)}) {
      corners.emplace_back(turn * half.cwiseProduct(sign));
    }
    const Rectangle rectangle = smallestRectangle(planarHull(corners), 1e-6);
    EXPECT_NEAR(rectangle.half_extents.prod(), half.prod(), 1e-12);
    EXPECT_LT(rectangle.centre.norm(), 1e-12);
  }
}

}  // namespace
}  // namespace tccm
