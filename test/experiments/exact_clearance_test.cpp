#include "experiments/exact_clearance.h"

#include <gtest/gtest.h>

#include <cmath>

#include "simulation/clearance.h"
#include "simulation/world.h"
#include "support/random.h"

namespace tccm::simulation {
namespace {

Body one(const Shape& shape, const Pose& pose) {
  Body body;
  body.shapes = {shape};
  body.poses = {pose};
  return body;
}

TEST(ExactClearanceTest, BallsAreAsFarApartAsTheirCentresLessTheirRadii) {
  const Body a = one(Sphere{0.1}, at(0, 0, 0));
  EXPECT_NEAR(exactClearance(a, one(Sphere{0.2}, at(0.3, 0.4, 0.0))), 0.2, 1e-5);
  EXPECT_EQ(exactClearance(a, one(Sphere{0.2}, at(0.1, 0.1, 0.1))), 0.0);
}

TEST(ExactClearanceTest, TheNearestOfSeveralCounts) {
  Body several;
  several.shapes = {Box{{0.1, 0.1, 0.1}}, Capsule{0.05, 0.2}};
  several.poses = {at(0, 0, 0), at(0, 0, 1.0)};
  const Body ball = one(Sphere{0.05}, at(0.2, 0, 1.1));
  EXPECT_NEAR(exactClearance(several, ball), 0.1, 1e-5);
  EXPECT_NEAR(exactClearance(ball, several), 0.1, 1e-5);
}

/// From points on the surfaces, which errs by half of their spacing at most.
TEST(ExactClearanceTest, AgreesWithPointsOnTheSurfaces) {
  constexpr double kSpacing = 0.01;
  test::Random random(8);
  for (int i = 0; i < 300; ++i) {
    const Body a = one(random.shape(i % test::kShapeKinds), random.pose(0.4));
    const Body b = one(random.shape((i / 7) % test::kShapeKinds), random.pose(0.4));
    const double sampled = clearance(SampledBody(a, kSpacing), SampledBody(b, kSpacing));
    EXPECT_NEAR(exactClearance(a, b), sampled, 0.6 * kSpacing) << i;
    EXPECT_EQ(exactlyTouch(a, b), exactClearance(a, b) == 0.0) << i;
  }
}

}  // namespace
}  // namespace tccm::simulation
