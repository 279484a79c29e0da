#include "fit/points.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/QR>
#include <algorithm>
#include <limits>

#include "support/near.h"
#include "support/random.h"

namespace tccm {
namespace {

using test::isNearly;
using test::Random;

TEST(DirectionsTest, NoDirectionIsFarFromTheEvenSpread) {
  Random random(1);
  for (const int count : {10, 100, 1000}) {
    const std::vector<Vector3> spread = hemisphereDirections(count);
    ASSERT_EQ(spread.size(), static_cast<std::size_t>(count));
    // Each stands for a patch of 2 pi / count; twice its radius is the farthest allowed.
    const double farthest = 2.0 * std::sqrt(2.0 / count);
    for (int i = 0; i < 1000; ++i) {
      const Vector3 n = random.direction();
      double nearest = M_PI;
      for (const Vector3& d : spread) {
        nearest = std::min(nearest, std::acos(std::min(1.0, std::abs(n.dot(d)))));
      }
      ASSERT_LT(nearest, farthest);
    }
  }
}

TEST(DirectionsTest, PrincipalAxesAreThoseOfAStretchedCloudTheLongestFirst) {
  Random random(2);
  for (int i = 0; i < 50; ++i) {
    const Pose pose = random.pose(1.0);
    std::vector<Vector3> points;
    for (int k = 0; k < 3000; ++k) {
      points.push_back(pose * random.point(1.0).cwiseProduct(Vector3(4.0, 2.0, 1.0)));
    }
    const Eigen::Matrix3d axes = principalAxes(points);
    EXPECT_NEAR(axes.determinant(), 1.0, 1e-12);
    for (int k = 0; k < 3; ++k) {
      EXPECT_GT(std::abs(axes.col(k).dot(pose.linear().col(k))), 0.98);
    }
  }
}

TEST(DirectionsTest, ALonePointHasAnyAxes) {
  EXPECT_EQ(principalAxes({Vector3(1.0, 2.0, 3.0)}), Eigen::Matrix3d::Identity());
}

TEST(DirectionsTest, AxesAboutADirectionAreARotationWithItAsZ) {
  Random random(3);
  for (int i = 0; i < 200; ++i) {
    const Vector3 z = i < 3 ? Vector3(Vector3::Unit(i)) : random.direction();
    const Eigen::Matrix3d axes = axesAbout(z);
    EXPECT_TRUE(isNearly(Vector3(axes.col(2)), z, 0.0));
    EXPECT_TRUE((axes.transpose() * axes).isIdentity(1e-12));
    EXPECT_NEAR(axes.determinant(), 1.0, 1e-12);
  }
}

TEST(DirectionsTest, OppositeAndNearDirectionsAreTheSame) {
  std::vector<Vector3> directions = {Vector3::UnitX()};
  addIfDifferent(directions, -Vector3::UnitX(), 0.1);
  addIfDifferent(directions, Vector3(std::cos(0.09), std::sin(0.09), 0.0), 0.1);
  EXPECT_EQ(directions.size(), 1U);
  addIfDifferent(directions, Vector3(std::cos(0.11), std::sin(0.11), 0.0), 0.1);
  EXPECT_EQ(directions.size(), 2U);
}

TEST(DirectionsTest, ExtremePointsReachNearlyAsFarAsAll) {
  Random random(4);
  std::vector<Vector3> points;
  for (int k = 0; k < 5000; ++k) points.push_back(random.direction());
  const std::vector<Vector3> extreme = extremePoints(points, hemisphereDirections(80));
  EXPECT_LE(extreme.size(), 160U);
  for (int i = 0; i < 500; ++i) {
    const Vector3 n = random.direction();
    double reach = -1.0;
    for (const Vector3& p : extreme) reach = std::max(reach, n.dot(p));
    EXPECT_GT(reach, 0.96);
  }
  EXPECT_EQ(extremePoints({points[0], points[1]}, hemisphereDirections(80)).size(), 2U);
}

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

template <int Dimension>
using Points = std::vector<Eigen::Matrix<double, Dimension, 1>>;

template <int Dimension>
double farthest(const Points<Dimension>& points, const Eigen::Matrix<double, Dimension, 1>& from) {
  double reach = 0.0;
  for (const auto& p : points) reach = std::max(reach, (p - from).norm());
  return reach;
}

/// The least radius over the balls through every choice of up to Dimension + 1 points, where their
/// centre has equal distances to them in their own span.
template <int Dimension>
double bruteForceRadius(const Points<Dimension>& points) {
  double least = std::numeric_limits<double>::infinity();
  for (unsigned subset = 1; subset < (1U << points.size()); ++subset) {
    Points<Dimension> chosen;
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (subset & (1U << i)) chosen.push_back(points[i]);
    }
    if (chosen.size() > Dimension + 1) continue;
    // |c - p_i|^2 = |c - p_0|^2, with the least-norm solution about p_0.
    const auto rows = static_cast<Eigen::Index>(chosen.size()) - 1;
    Eigen::MatrixXd edges(rows, Dimension);
    Eigen::VectorXd halves(rows);
    for (Eigen::Index i = 0; i < rows; ++i) {
      edges.row(i) = (chosen[static_cast<std::size_t>(i) + 1] - chosen[0]).transpose();
      halves[i] = 0.5 * edges.row(i).squaredNorm();
    }
    Eigen::Matrix<double, Dimension, 1> centre = chosen[0];
    if (rows > 0) centre += edges.completeOrthogonalDecomposition().solve(halves);
    least = std::min(least, farthest<Dimension>(points, centre));
  }
  return least;
}

template <int Dimension>
void expectAsBruteForce(unsigned seed) {
  Random random(seed);
  for (int i = 0; i < 300; ++i) {
    Points<Dimension> points;
    const int count = random.integer(1, 9);
    const bool on_grid = random.chance(0.3);  // many ties and degenerate choices
    for (int k = 0; k < count; ++k) {
      Vector3 p = random.point(1.0);
      if (on_grid) p = (2.0 * p).array().round();
      points.push_back(p.head<Dimension>());
    }
    const Ball<Dimension> ball = smallestBall<Dimension>(points);
    ASSERT_NEAR(ball.radius, bruteForceRadius<Dimension>(points), 1e-9) << i;
    ASSERT_LE(farthest<Dimension>(points, ball.centre), ball.radius * (1.0 + 1e-14)) << i;
  }
}

TEST(SmallestBallTest, CirclesAreThoseOfBruteForceOverAllPairsAndTriples) {
  expectAsBruteForce<2>(1);
}

TEST(SmallestBallTest, SpheresAreThoseOfBruteForceOverAllPairsTriplesAndQuadruples) {
  expectAsBruteForce<3>(2);
}

TEST(SmallestBallTest, PointsOnASphereGiveThatSphere) {
  Random random(3);
  for (const double radius : {1e-4, 0.1, 10.0}) {
    const Vector3 centre = random.point(1.0);
    std::vector<Vector3> points;
    for (int k = 0; k < 5000; ++k) points.emplace_back(centre + radius * random.direction());
    const Ball<3> ball = smallestBall<3>(points);
    EXPECT_NEAR(ball.radius, radius, 1e-3 * radius);
    EXPECT_LE(farthest<3>(points, ball.centre), ball.radius * (1.0 + 1e-14));
  }
}

TEST(SmallestBallTest, OnePointAndItsCopiesHaveNoRadius) {
  EXPECT_EQ(smallestBall<3>({Vector3(1.0, 2.0, 3.0)}).radius, 0.0);
  EXPECT_EQ(smallestBall<3>({7, Vector3(1.0, 2.0, 3.0)}).radius, 0.0);
  EXPECT_NEAR(smallestBall<2>({{0.0, 0.0}, {1.0, 0.0}, {2.0, 0.0}}).radius, 1.0, 1e-15);
}

}  // namespace
}  // namespace tccm
