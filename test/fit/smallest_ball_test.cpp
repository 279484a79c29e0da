#include "fit/smallest_ball.h"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <limits>

#include "support/random.h"

namespace tccm {
namespace {

using test::Random;

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
