#include "fit/directions.h"

#include <gtest/gtest.h>

#include <algorithm>

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
  const std::vector<Vector3> extreme = ExtremePoints(80).of(points);
  EXPECT_LE(extreme.size(), 160U);
  for (int i = 0; i < 500; ++i) {
    const Vector3 n = random.direction();
    double reach = -1.0;
    for (const Vector3& p : extreme) reach = std::max(reach, n.dot(p));
    EXPECT_GT(reach, 0.96);
  }
  EXPECT_EQ(ExtremePoints(80).of({points[0], points[1]}).size(), 2U);
}

}  // namespace
}  // namespace tccm
