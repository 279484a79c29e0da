/// What distance.h tells besides the distance: which way it lies, and how far shapes reach.

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "geometry/distance.h"
#include "support/random.h"

namespace tccm {
namespace {

using test::Random;

constexpr double kExact = 1e-6;     // what distance() promises [m]
constexpr double kRounding = 1e-9;  // [m]

struct Pair {
  Shape shape;
  Pose T_fixed_shape;
  UprightBox box;
};

/// Apart by up to some 0.5 m, or overlapping.
Pair randomPair(Random& random, std::size_t kind) {
  const Vector3 half(0.5 * random.size(), 0.5 * random.size(), 0.5 * random.size());
  Pair pair{random.shape(kind), Pose::Identity(), {-half, half}};
  pair.T_fixed_shape.linear() = random.mixedRotation();
  pair.T_fixed_shape.translation() = random.point(0.5);
  return pair;
}

/// The whole shape lies beyond the plane that its distance and direction give, the box before it.
TEST(SeparationTest, AGapAsWideAsTheDistanceLiesAcrossTheDirection) {
  constexpr double kFarAway = std::numeric_limits<double>::infinity();
  for (std::size_t kind = 0; kind < test::kShapeKinds; ++kind) {
    Random random(300 + static_cast<unsigned>(kind));
    for (int i = 0; i < 5000; ++i) {
      const Pair pair = randomPair(random, kind);
      const Separation apart = separation(pair.shape, pair.T_fixed_shape, pair.box, kFarAway);
      EXPECT_EQ(apart.distance_m, distance(pair.shape, pair.T_fixed_shape, pair.box));
      if (apart.distance_m == 0.0) {
        EXPECT_TRUE(apart.direction.isZero(0.0));
        continue;
      }
      EXPECT_NEAR(apart.direction.norm(), 1.0, kRounding);
      const Vector3 nearest = furthest(pair.shape, pair.T_fixed_shape, -apart.direction);
      const double box_end =
          furthest(Box{0.5 * pair.box.sizes()}, Pose(Eigen::Translation3d(pair.box.center())),
                   apart.direction)
              .dot(apart.direction);
      EXPECT_NEAR(nearest.dot(apart.direction) - box_end, apart.distance_m, kRounding);
    }
  }
}

TEST(SeparationTest, WhereLessIsEnoughItIsNeverTooLargeAndAtLeastThatMuch) {
  for (std::size_t kind = 0; kind < test::kShapeKinds; ++kind) {
    Random random(400 + static_cast<unsigned>(kind));
    for (int i = 0; i < 5000; ++i) {
      const Pair pair = randomPair(random, kind);
      const double enough = random.uniform(0.0, 0.2);
      const double whole = distance(pair.shape, pair.T_fixed_shape, pair.box);
      const double found = separation(pair.shape, pair.T_fixed_shape, pair.box, enough).distance_m;
      EXPECT_LE(found, whole + kExact);
      EXPECT_GE(found, std::min(enough, whole) - kExact);
    }
  }
}

TEST(FurthestTest, IsAPointOfTheShapeAndNoneLiesBeyondIt) {
  for (std::size_t kind = 0; kind < test::kShapeKinds; ++kind) {
    Random random(500 + static_cast<unsigned>(kind));
    for (int i = 0; i < 1000; ++i) {
      const Shape shape = random.shape(kind);
      const Pose pose = random.pose(1.0);
      const Vector3 direction =
          i % 2 == 0 ? random.direction() : Vector3(random.axisRotation().col(0));
      const Vector3 point = furthest(shape, pose, direction);
      EXPECT_NEAR(distance(shape, pose.inverse() * point), 0.0, 1e-9);
      EXPECT_GT(distance(shape, pose.inverse() * (point + 1e-3 * direction)), 0.9e-3);
    }
  }
}

}  // namespace
}  // namespace tccm
