#include "geometry/ray.h"

#include <gtest/gtest.h>

#include "support/geometric_shapes_body.h"
#include "support/near.h"
#include "support/random.h"

namespace tccm {
namespace {

using test::Random;
using test::toBody;

/// From around the shape towards a point in its bounds; some parallel to an axis, some from inside.
Ray randomRay(Random& random, const Shape& shape) {
  const double reach = boundingRadius(shape);
  const Vector3 target = random.pointIn(bounds(shape, Pose::Identity()));
  Vector3 direction = random.direction();
  if (random.chance(0.3)) direction = Vector3::Unit(random.integer(0, 2));
  if (random.chance(0.15)) direction = -direction;
  const double back = random.chance(0.3) ? 0.0 : random.uniform(-1.0, 3.0) * reach;
  return {target - back * direction, direction};
}

void expectSpan(const Shape& shape, const Ray& ray, double enter, double leave) {
  const auto span = intersect(shape, ray);
  ASSERT_TRUE(span) << name(shape);
  EXPECT_NEAR(span->enter, enter, 1e-12) << name(shape);
  EXPECT_NEAR(span->leave, leave, 1e-12) << name(shape);
}

const Shape kBox = Box{{1.0, 2.0, 3.0}};
const Shape kCylinder = Cylinder{1.0, 2.0};
const Shape kCapsule = Capsule{1.0, 2.0};
const Shape kSphere = Sphere{1.0};

TEST(RayTest, ThroughTheMiddleAlongAnAxisEntersAndLeavesAtTheFaces) {
  const Ray along_x{{-5.0, 0.0, 0.0}, Vector3::UnitX()};
  expectSpan(kBox, along_x, 4.0, 6.0);
  expectSpan(kCylinder, along_x, 4.0, 6.0);
  expectSpan(kCapsule, along_x, 4.0, 6.0);
  expectSpan(kSphere, along_x, 4.0, 6.0);
  const Ray along_z{{0.0, 0.0, -5.0}, Vector3::UnitZ()};
  expectSpan(kBox, along_z, 2.0, 8.0);
  expectSpan(kCylinder, along_z, 3.0, 7.0);
  expectSpan(kCapsule, along_z, 2.0, 8.0);
  expectSpan(kSphere, along_z, 4.0, 6.0);
}

TEST(RayTest, FromInsideItEntersAtZero) {
  const Ray ray{{0.25, 0.0, 0.0}, Vector3::UnitX()};
  for (const Shape& shape : {kBox, kCylinder, kCapsule, kSphere}) expectSpan(shape, ray, 0.0, 0.75);
}

TEST(RayTest, AShapeBehindTheOriginIsMissed) {
  const Ray ray{{5.0, 0.0, 0.0}, Vector3::UnitX()};
  for (const Shape& shape : {kBox, kCylinder, kCapsule, kSphere}) {
    EXPECT_FALSE(intersect(shape, ray)) << name(shape);
  }
}

TEST(RayTest, ParallelToAFaceOutsideMissesAndInTheFaceRunsAlongIt) {
  EXPECT_FALSE(intersect(kBox, {{-5.0, 2.001, 0.0}, Vector3::UnitX()}));
  expectSpan(kBox, {{-5.0, 2.0, 0.0}, Vector3::UnitX()}, 4.0, 6.0);
  EXPECT_FALSE(intersect(kCylinder, {{1.001, 0.0, -5.0}, Vector3::UnitZ()}));
  expectSpan(kCylinder, {{1.0, 0.0, -5.0}, Vector3::UnitZ()}, 3.0, 7.0);
  EXPECT_FALSE(intersect(kCylinder, {{-5.0, 0.0, 2.001}, Vector3::UnitX()}));
  expectSpan(kCylinder, {{-5.0, 0.0, 2.0}, Vector3::UnitX()}, 4.0, 6.0);
  EXPECT_FALSE(intersect(kCapsule, {{1.001, 0.0, -5.0}, Vector3::UnitZ()}));
}

TEST(RayTest, ACapsulesRoundEndIsNotACylindersFlatOne) {
  const Ray beside_end{{-5.0, 0.0, 2.9}, Vector3::UnitX()};
  EXPECT_FALSE(intersect(kCylinder, beside_end));
  const double half_chord = std::sqrt(1.0 - 0.9 * 0.9);
  expectSpan(kCapsule, beside_end, 5.0 - half_chord, 5.0 + half_chord);
}

TEST(RayTest, ATransformedRayMeetsTheSamePoints) {
  Random random(4);
  for (int i = 0; i < 500; ++i) {
    const Pose pose = random.pose(2.0);
    const Ray ray{random.point(1.0), random.direction()};
    const Ray moved = transformed(ray, pose);
    EXPECT_NEAR(moved.direction.norm(), 1.0, 1e-12);
    EXPECT_TRUE(test::isNearly(moved.at(1.7), pose * ray.at(1.7), 1e-12));
  }
}

TEST(RayTest, AgreesWithGeometricShapesOnRandomRays) {
  for (const std::size_t kind : {0U, 1U, 3U}) {
    Random random(300 + static_cast<unsigned>(kind));
    int hits = 0, compared = 0;
    for (int i = 0; i < 20000; ++i) {
      const Shape shape = random.shape(kind);
      const auto body = toBody(shape);
      Ray ray = randomRay(random, shape);
      ray.direction += Vector3::Zero();  // geometric_shapes takes -0 for a direction
      const auto span = intersect(shape, ray);
      // A grazing ray may go either way; the boundary itself belongs to nobody there.
      if (span && (span->leave - span->enter < 1e-4 || span->leave < 1e-4)) continue;
      EigenSTL::vector_Vector3d points;
      const bool theirs = body->intersectsRay(ray.origin, ray.direction, &points);
      if (!span && theirs && points.size() == 1) continue;  // touches a corner or an edge
      ++compared;
      ASSERT_EQ(span.has_value(), theirs) << name(shape) << " ray " << i;
      if (!span) continue;
      ++hits;
      ASSERT_FALSE(points.empty());
      EXPECT_NEAR((points.back() - ray.origin).norm(), span->leave, 1e-6) << name(shape) << i;
      if (points.size() == 2) {
        EXPECT_NEAR((points.front() - ray.origin).norm(), span->enter, 1e-6) << name(shape) << i;
      }
    }
    EXPECT_GT(hits, 8000);
    EXPECT_GT(compared, 19000);
  }
}

TEST(RayTest, MarchingAlongTheRayFindsTheSameSpan) {
  constexpr double kRounding = 1e-9;
  for (std::size_t kind = 0; kind < test::kShapeKinds; ++kind) {
    Random random(400 + static_cast<unsigned>(kind));
    for (int i = 0; i < 3000; ++i) {
      const Shape shape = random.shape(kind);
      const Ray ray = randomRay(random, shape);
      const auto span = intersect(shape, ray);
      const double farthest = 6.0 * boundingRadius(shape);
      for (double range = 0.0; range < farthest; range += farthest / 200.0) {
        const bool inside = distance(shape, ray.at(range)) == 0.0;
        if (inside) {
          ASSERT_TRUE(span || distance(shape, ray.at(range + 1e-7)) > 0.0 ||
                      distance(shape, ray.at(range - 1e-7)) > 0.0)
              << name(shape) << " ray " << i;
        }
        if (!span) continue;
        if (inside) {
          ASSERT_GE(range, span->enter - kRounding) << name(shape) << " ray " << i;
          ASSERT_LE(range, span->leave + kRounding) << name(shape) << " ray " << i;
        } else {
          ASSERT_TRUE(range <= span->enter + kRounding || range >= span->leave - kRounding)
              << name(shape) << " ray " << i;
        }
      }
    }
  }
}

}  // namespace
}  // namespace tccm
