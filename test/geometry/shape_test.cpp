#include "tccm_monitor/shape.h"

#include <gtest/gtest.h>

#include <limits>

#include "support/geometric_shapes_body.h"
#include "support/near.h"
#include "support/random.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

using test::isNearly;
using test::Random;
using test::toBody;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

bool contains(const Shape& shape, const Vector3& p) { return distance(shape, p) == 0.0; }

/// The surface's point whose outward normal is n: the farthest along n.
Vector3 support(const Shape& shape, const Vector3& n) {
  const auto side = [](double x) { return x < 0.0 ? -1.0 : 1.0; };
  if (const auto* b = std::get_if<Box>(&shape)) {
    return b->half_extents.cwiseProduct(Vector3(side(n.x()), side(n.y()), side(n.z())));
  }
  if (const auto* c = std::get_if<Cylinder>(&shape)) {
    const double across = std::hypot(n.x(), n.y());
    const double scale = across > 0.0 ? c->radius / across : 0.0;
    return {n.x() * scale, n.y() * scale, side(n.z()) * c->half_length};
  }
  if (const auto* c = std::get_if<Capsule>(&shape)) {
    return n * c->radius + Vector3(0.0, 0.0, side(n.z()) * c->half_length);
  }
  return n * std::get<Sphere>(shape).radius;
}

/// The values that geometric_shapes' own tests state.
TEST(ShapeTest, SphereOfRadius1HoldsPoint99AndNot1Point01) {
  const Shape sphere = Sphere{1.0};
  EXPECT_TRUE(contains(sphere, {0.99, 0.0, 0.0}));
  EXPECT_FALSE(contains(sphere, {1.01, 0.0, 0.0}));
  EXPECT_TRUE(contains(sphere, {0.70, 0.70, 0.0}));
  EXPECT_FALSE(contains(sphere, {0.71, 0.71, 0.0}));
}

TEST(ShapeTest, BoxOf2x2x2HoldsPoint99AndNot1Point01) {
  const Shape box = Box{{1.0, 1.0, 1.0}};
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_TRUE(contains(box, 0.99 * Vector3::Unit(axis)));
    EXPECT_TRUE(contains(box, -0.99 * Vector3::Unit(axis)));
    EXPECT_FALSE(contains(box, 1.01 * Vector3::Unit(axis)));
    EXPECT_FALSE(contains(box, -1.01 * Vector3::Unit(axis)));
  }
}

TEST(ShapeTest, CylinderOfRadius1AndLength4HasTheStatedBorders) {
  const Shape cylinder = Cylinder{1.0, 2.0};
  EXPECT_TRUE(contains(cylinder, {0.0, 0.0, 1.99}));
  EXPECT_FALSE(contains(cylinder, {0.0, 0.0, 2.01}));
  EXPECT_TRUE(contains(cylinder, {0.70, 0.70, 1.99}));
  EXPECT_FALSE(contains(cylinder, {0.71, 0.71, 2.01}));
  EXPECT_FALSE(contains(cylinder, {0.0, 1.01, 0.0}));
  EXPECT_TRUE(contains(expanded(cylinder, {1.0, 0.02}), {0.0, 1.01, 0.0}));
}

TEST(ShapeTest, UnitBoxScaledAndTurned60DegreesAboutXHasTheStatedBorders) {
  const Shape box = expanded(Box{{0.5, 0.5, 0.5}}, {1.01, 0.0});
  Pose pose(Eigen::AngleAxisd(M_PI / 3.0, Vector3::UnitX()));
  pose.translation() = Vector3(1.0, 1.0, 1.0);
  EXPECT_TRUE(contains(box, pose.inverse() * Vector3(1.5, 1.0, 1.5)));
  EXPECT_FALSE(contains(box, pose.inverse() * Vector3(1.5, 1.5, 1.5)));
}

TEST(ShapeTest, InclusionAgreesWithGeometricShapesOnRandomPoints) {
  for (const std::size_t kind : {0U, 1U, 3U}) {
    Random random(500 + static_cast<unsigned>(kind));
    int inside = 0;
    for (int i = 0; i < 20000; ++i) {
      const Shape shape = random.shape(kind);
      const auto body = toBody(shape);
      const Pose pose = random.pose(1.0);
      body->setPose(pose);
      const Vector3 p = pose * (1.2 * random.pointIn(bounds(shape, Pose::Identity())));
      const double apart = distance(shape, pose.inverse() * p);
      inside += apart == 0.0;
      if (apart > 0.0 && apart < 1e-9) continue;
      ASSERT_EQ(apart == 0.0, body->containsPoint(p)) << name(shape) << " point " << i;
    }
    EXPECT_GT(inside, 4000);
  }
}

/// The distance to a convex solid is at least that to any supporting plane, and at most that to any
/// of its points; the best of many planes comes close.
TEST(ShapeTest, DistanceLiesBetweenSupportingPlanesAndSampledPoints) {
  for (std::size_t kind = 0; kind < test::kShapeKinds; ++kind) {
    Random random(600 + static_cast<unsigned>(kind));
    int tight = 0;
    for (int i = 0; i < 300; ++i) {
      const Shape shape = random.shape(kind);
      const Vector3 p = random.point(2.0 * boundingRadius(shape));
      const double claimed = distance(shape, p);
      double plane = 0.0;
      double point = std::numeric_limits<double>::infinity();
      Vector3 best = p.normalized();
      for (int k = 0; k < 3000; ++k) {
        const double spread = 2.0 * std::exp(-k / 300.0);  // coarse first, then around the best
        const Vector3 n = (best + spread * random.direction()).normalized();
        const double apart = n.dot(p - support(shape, n));
        if (apart > plane) {
          plane = apart;
          best = n;
        }
        const Vector3 inner = random.uniform(0.0, 1.0) * support(shape, n);
        point = std::min({point, (p - inner).norm(), (p - support(shape, n)).norm()});
      }
      ASSERT_LE(plane, claimed + 1e-12) << name(shape);
      ASSERT_GE(point, claimed - 1e-12) << name(shape);
      tight += plane >= 0.99 * claimed;
    }
    EXPECT_GT(tight, 280);
  }
}

TEST(ShapeTest, DistanceIsThatToTheNearestFaceEdgeOrEnd) {
  EXPECT_NEAR(distance(Box{{1.0, 2.0, 3.0}}, {2.0, 0.0, 0.0}), 1.0, 1e-12);
  EXPECT_NEAR(distance(Box{{1.0, 2.0, 3.0}}, {4.0, 6.0, 0.0}), 5.0, 1e-12);
  EXPECT_NEAR(distance(Cylinder{1.0, 2.0}, {4.0, 0.0, 6.0}), 5.0, 1e-12);
  EXPECT_NEAR(distance(Capsule{1.0, 2.0}, {3.0, 0.0, 6.0}), 4.0, 1e-12);
  EXPECT_NEAR(distance(Capsule{1.0, 2.0}, {3.0, 0.0, -1.0}), 2.0, 1e-12);
  EXPECT_NEAR(distance(Sphere{1.0}, {0.0, -3.0, 4.0}), 4.0, 1e-12);
}

TEST(ShapeTest, BoundsAreExactlyTheSupportAlongEachAxis) {
  for (std::size_t kind = 0; kind < test::kShapeKinds; ++kind) {
    Random random(700 + static_cast<unsigned>(kind));
    for (int i = 0; i < 2000; ++i) {
      const Shape shape = random.shape(kind);
      Pose pose = random.pose(1.0);
      pose.linear() = random.mixedRotation();
      const UprightBox box = bounds(shape, pose);
      for (int axis = 0; axis < 3; ++axis) {
        const Vector3 n = pose.linear().transpose() * Vector3::Unit(axis);
        ASSERT_NEAR(box.max()[axis], (pose * support(shape, n))[axis], 1e-12) << name(shape);
        ASSERT_NEAR(box.min()[axis], (pose * support(shape, -n))[axis], 1e-12) << name(shape);
      }
    }
  }
}

TEST(ShapeTest, BoundingRadiusReachesTheFarthestPointAndNotBeyond) {
  EXPECT_DOUBLE_EQ(boundingRadius(Box{{1.0, 2.0, 2.0}}), 3.0);
  EXPECT_DOUBLE_EQ(boundingRadius(Cylinder{3.0, 4.0}), 5.0);
  EXPECT_DOUBLE_EQ(boundingRadius(Capsule{3.0, 4.0}), 7.0);
  EXPECT_DOUBLE_EQ(boundingRadius(Sphere{3.0}), 3.0);
}

TEST(ShapeTest, ExpansionScalesSizesAndPadsEverySide) {
  const Expansion by{1.2, 0.05};
  const auto box = std::get<Box>(expanded(Box{{1.0, 2.0, 3.0}}, by));
  EXPECT_TRUE(isNearly(box.half_extents, {1.25, 2.45, 3.65}, 1e-12));
  const auto cylinder = std::get<Cylinder>(expanded(Cylinder{0.5, 1.0}, by));
  EXPECT_NEAR(cylinder.radius, 0.65, 1e-12);
  EXPECT_NEAR(cylinder.half_length, 1.25, 1e-12);
  const auto capsule = std::get<Capsule>(expanded(Capsule{0.5, 1.0}, by));
  EXPECT_NEAR(capsule.radius, 0.65, 1e-12);
  EXPECT_NEAR(capsule.half_length, 1.2, 1e-12);
  EXPECT_NEAR(std::get<Sphere>(expanded(Sphere{0.5}, by)).radius, 0.65, 1e-12);
}

TEST(ShapeTest, APaddedShapeHoldsAllThatIsWithinThePadding) {
  for (std::size_t kind = 0; kind < test::kShapeKinds; ++kind) {
    Random random(800 + static_cast<unsigned>(kind));
    for (int i = 0; i < 5000; ++i) {
      const Shape shape = random.shape(kind);
      const Expansion by{random.uniform(1.0, 1.3), random.uniform(0.0, 0.1)};
      const Vector3 n = random.direction();
      const Vector3 near = support(expanded(shape, {by.scale, 0.0}), n) +
                           0.999999 * by.padding_m * random.direction();
      ASSERT_LT(distance(expanded(shape, by), near), 1e-12) << name(shape);
    }
  }
}

TEST(ShapeTest, NoExpansionLeavesTheShapeAsItIs) {
  EXPECT_DOUBLE_EQ(std::get<Sphere>(expanded(Sphere{0.3}, {})).radius, 0.3);
}

TEST(ShapeTest, EveryKindHasItsName) {
  EXPECT_EQ(name(Box{{1.0, 1.0, 1.0}}), "box");
  EXPECT_EQ(name(Cylinder{1.0, 1.0}), "cylinder");
  EXPECT_EQ(name(Capsule{1.0, 1.0}), "capsule");
  EXPECT_EQ(name(Sphere{1.0}), "sphere");
}

TEST(ShapeTest, VolumesAreThoseOfGeometricShapes) {
  Random random(41);
  for (std::size_t i = 0; i < 100; ++i) {
    const Shape shape = random.shape(i % test::kShapeKinds);
    const auto body = toBody(shape);
    if (!body) continue;
    EXPECT_NEAR(volume(shape), body->computeVolume(), 1e-9) << name(shape);
  }
  EXPECT_NEAR(volume(Capsule{0.5, 1.0}), volume(Cylinder{0.5, 1.0}) + volume(Sphere{0.5}), 1e-12);
}

TEST(ShapeTest, ValidSizesAreAcceptedDownToHalfAMillimetre) {
  EXPECT_NO_THROW(validate(Box{{0.00025, 0.00025, 0.5}}, "link"));
  EXPECT_NO_THROW(validate(Cylinder{0.0005, 0.0005}, "link"));
  EXPECT_NO_THROW(validate(Capsule{0.1, 0.0}, "link"));
  EXPECT_NO_THROW(validate(Sphere{0.001}, "link"));
}

TEST(ShapeTest, NaNInfiniteNegativeAndZeroSizesAreRefused) {
  for (const double bad : {kNaN, kInfinity, -kInfinity, -0.1, 0.0}) {
    for (int axis = 0; axis < 3; ++axis) {
      Box box{{0.1, 0.1, 0.1}};
      box.half_extents[axis] = bad;
      EXPECT_THROW(validate(box, "link"), ConfigError) << bad;
    }
    EXPECT_THROW(validate(Cylinder{bad, 0.1}, "link"), ConfigError) << bad;
    EXPECT_THROW(validate(Cylinder{0.1, bad}, "link"), ConfigError) << bad;
    EXPECT_THROW(validate(Capsule{bad, 0.1}, "link"), ConfigError) << bad;
    EXPECT_THROW(validate(Sphere{bad}, "link"), ConfigError) << bad;
  }
  for (const double bad : {kNaN, kInfinity, -0.1}) {
    EXPECT_THROW(validate(Capsule{0.1, bad}, "link"), ConfigError) << bad;
  }
}

TEST(ShapeTest, ARefusalNamesTheOwner) {
  try {
    validate(Sphere{-1.0}, "left_wrist");
    FAIL() << "nothing was thrown";
  } catch (const ConfigError& error) {
    EXPECT_NE(std::string(error.what()).find("left_wrist"), std::string::npos);
  }
}

}  // namespace
}  // namespace tccm
