#include "simulation/clearance.h"

#include <gtest/gtest.h>

#include <cmath>

namespace tccm::simulation {
namespace {

double between(const Shape& a, const Shape& b, const Pose& T_a_b) {
  return clearance(SampledBody({{a}, {Pose::Identity()}}, 0.01), SampledBody({{b}, {T_a_b}}, 0.01));
}

TEST(ClearanceTest, AgreesWithHandComputedDistances) {
  EXPECT_NEAR(between(Sphere{0.1}, Sphere{0.2}, at(1.0, 0.0, 0.0)), 0.7, 1e-4);
  EXPECT_NEAR(between(Box{Vector3(0.1, 0.1, 0.1)}, Sphere{0.1}, at(0.0, 0.0, 0.5)), 0.3, 1e-4);
  EXPECT_NEAR(between(Cylinder{0.03, 0.2}, Capsule{0.04, 0.1}, at(0.2, 0.0, 0.1)), 0.13, 2e-4);
  EXPECT_NEAR(between(Box{Vector3(0.1, 0.1, 0.1)}, Box{Vector3(0.1, 0.1, 0.1)}, at(0.4, 0.4, 0.0)),
              0.2 * std::sqrt(2.0), 1e-9);
}

TEST(ClearanceTest, OfBodiesThatMeetIsNothing) {
  EXPECT_EQ(between(Sphere{0.1}, Box{Vector3(0.1, 0.1, 0.1)}, at(0.15, 0.0, 0.0)), 0.0);
}

TEST(ClearanceTest, SurfacePointsLieOnTheSurface) {
  for (const Shape& shape : std::vector<Shape>{Box{Vector3(0.1, 0.2, 0.3)}, Cylinder{0.1, 0.2},
                                               Capsule{0.1, 0.2}, Sphere{0.1}}) {
    const auto points = surfacePoints(shape, 0.02);
    EXPECT_GT(points.size(), 100U);
    for (const Vector3& p : points) {
      EXPECT_LT(distance(shape, p), 1e-9);
      EXPECT_GT(distance(shape, p * 1.001), 0.0) << name(shape);
    }
  }
}

}  // namespace
}  // namespace tccm::simulation
