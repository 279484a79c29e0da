#include "fit/enclosing.h"

#include <gtest/gtest.h>

#include <array>
#include <limits>

#include "fit/points.h"
#include "support/random.h"

namespace tccm {
namespace {

using test::Random;
using Points = std::vector<Vector3>;
using Enclose = PlacedShape (*)(const Points&);

/// In the order of Shape's alternatives.
constexpr std::array<Enclose, 4> kEncloseAs = {enclosingBox, enclosingCylinder, enclosingCapsule,
                                               enclosingSphere};
constexpr std::array<Enclose, 5> kAll = {enclosingBox, enclosingCylinder, enclosingCapsule,
                                         enclosingSphere, smallestEnclosing};

double farthestOutside(const PlacedShape& placed, const Points& points) {
  double farthest = 0.0;
  for (const Vector3& p : points) {
    farthest = std::max(farthest, distance(placed.shape, placed.pose.inverse() * p));
  }
  return farthest;
}

Points cloud(Random& random) {
  Points points;
  const int count = random.integer(1, 150);
  const Pose pose = random.pose(1.0);
  const Vector3 stretch(random.size(), random.size(), random.size());
  for (int k = 0; k < count; ++k) {
    const Vector3 p = random.chance(0.5) ? random.direction() : random.point(1.0);
    points.push_back(pose * stretch.cwiseProduct(p));
  }
  return points;
}

/// A point of the shape's surface, corners and rims among them.
Vector3 surfacePoint(const Shape& shape, Random& random) {
  const Vector3 n = random.direction();
  const auto side = [&]() { return random.chance(0.5) ? 1.0 : -1.0; };
  if (const auto* box = std::get_if<Box>(&shape)) {
    return box->half_extents.cwiseProduct(Vector3(side(), side(), side()));
  }
  const Vector3 across = Vector3(n.x(), n.y(), 0.0).normalized();
  if (const auto* c = std::get_if<Cylinder>(&shape)) {
    return c->radius * across + Vector3(0.0, 0.0, side() * c->half_length);
  }
  if (const auto* c = std::get_if<Capsule>(&shape)) {
    return c->radius * n + Vector3(0.0, 0.0, std::copysign(c->half_length, n.z()));
  }
  return std::get<Sphere>(shape).radius * n;
}

TEST(EnclosingTest, EveryPointOfARandomCloudIsInside) {
  Random random(1);
  for (int i = 0; i < 60; ++i) {
    const Points points = cloud(random);
    for (const Enclose enclose : kAll) {
      const PlacedShape placed = enclose(points);
      ASSERT_TRUE(isRigid(placed.pose));
      ASSERT_NO_THROW(validate(placed.shape, "cloud"));
      ASSERT_LT(farthestOutside(placed, points), 1e-12) << name(placed.shape) << " " << i;
    }
  }
}

TEST(EnclosingTest, AKnownPrimitiveIsFoundAgainToWithin2PerCentOfItsVolume) {
  for (std::size_t kind = 0; kind < test::kShapeKinds; ++kind) {
    Random random(10 + static_cast<unsigned>(kind));
    for (int i = 0; i < 10; ++i) {
      const Shape shape = random.shape(kind);
      const Pose pose = random.pose(1.0);
      Points points;
      for (int k = 0; k < 2000; ++k) points.push_back(pose * surfacePoint(shape, random));
      const PlacedShape placed = kEncloseAs.at(kind)(points);
      ASSERT_EQ(placed.shape.index(), kind);
      ASSERT_LT(farthestOutside(placed, points), 1e-12) << name(shape);
      ASSERT_LT(volume(placed.shape), 1.02 * volume(shape)) << name(shape) << " " << i;
      ASSERT_LT(volume(smallestEnclosing(points).shape), 1.02 * volume(shape)) << name(shape);
    }
  }
}

/// Exact rectangles and circles along very many directions: what a search could find at best.
TEST(EnclosingTest, BoxesAndCylindersAreAsSmallAsAlong20000Directions) {
  Random random(20);
  const std::vector<Vector3> directions = hemisphereDirections(20000);
  for (int i = 0; i < 12; ++i) {
    const Points points = cloud(random);
    double box = std::numeric_limits<double>::infinity();
    double cylinder = box;
    for (const Vector3& direction : directions) {
      const Eigen::Matrix3d to_view = axesAbout(direction).transpose();
      std::vector<Vector2> across;
      Eigen::AlignedBox<double, 1> along;
      for (const Vector3& p : points) {
        across.emplace_back((to_view * p).head<2>());
        along.extend((to_view * p).tail<1>());
      }
      const double length = std::max(along.sizes()[0], kThinnest);
      const std::vector<Vector2> hull = planarHull(across);
      const double area = 4.0 * smallestRectangle(hull, kThinnest).half_extents.prod();
      const double radius = std::max(smallestBall<2>(hull).radius, 0.5 * kThinnest);
      box = std::min(box, area * length);
      cylinder = std::min(cylinder, M_PI * radius * radius * length);
    }
    EXPECT_LT(volume(enclosingBox(points).shape), 1.01 * box) << i;
    EXPECT_LT(volume(enclosingCylinder(points).shape), 1.01 * cylinder) << i;
  }
}

/// Capsules about random segments near the one found: the radius is the farthest point's distance.
TEST(EnclosingTest, NoCapsuleNearbyIsMuchSmaller) {
  Random random(30);
  for (int i = 0; i < 20; ++i) {
    const Points points = cloud(random);
    const PlacedShape placed = enclosingCapsule(points);
    const auto capsule = std::get<Capsule>(placed.shape);
    const double size = capsule.radius + capsule.half_length;
    double least = std::numeric_limits<double>::infinity();
    for (int k = 0; k < 20000; ++k) {
      const double spread = size * std::exp(random.uniform(-7.0, 0.0));
      const Vector3 end(0.0, 0.0, capsule.half_length);
      const Vector3 a = placed.pose * end + random.point(spread);
      const Vector3 b = placed.pose * Vector3(-end) + random.point(spread);
      double squared = 0.0;
      for (const Vector3& p : points) {
        const double along = (p - a).dot(b - a) / std::max((b - a).squaredNorm(), 1e-18);
        squared = std::max(squared, (p - a - std::clamp(along, 0.0, 1.0) * (b - a)).squaredNorm());
      }
      least = std::min(least, volume(Capsule{std::sqrt(squared), 0.5 * (b - a).norm()}));
    }
    EXPECT_LT(volume(placed.shape), 1.02 * least) << i;
  }
}

TEST(EnclosingTest, TheSmallestOfAllKindsIsAboutTheSmallestOfEach) {
  Random random(40);
  for (int i = 0; i < 40; ++i) {
    const Points points = cloud(random);
    double least = std::numeric_limits<double>::infinity();
    for (const Enclose enclose : kEncloseAs) {
      least = std::min(least, volume(enclose(points).shape));
    }
    EXPECT_LT(volume(smallestEnclosing(points).shape), 1.02 * least) << i;
  }
}

TEST(EnclosingTest, VolumesAlongGivenAxesAreBoundsAndExactForABoxOfTheseAxes) {
  Random random(50);
  for (int i = 0; i < 40; ++i) {
    const Shape box = random.box();
    const Pose pose = random.pose(1.0);
    Points points;
    for (int k = 0; k < 200; ++k) points.push_back(pose * surfacePoint(box, random));
    EXPECT_NEAR(enclosingVolumeAlong(points, {pose.linear().col(1)}), volume(box), 1e-9);
    EXPECT_GE(enclosingVolumeAlong(points, {random.direction()}), volume(box) * 0.999);
  }
}

TEST(EnclosingTest, FlatThinAndLonePointsHaveValidPrimitives) {
  Random random(60);
  for (const double scale : {1e-4, 1e-3, 1.0}) {
    for (int dimensions = 0; dimensions < 3; ++dimensions) {
      const Points points = random.flatCloud(dimensions, 30, scale);
      for (const Enclose enclose : kAll) {
        const PlacedShape placed = enclose(points);
        ASSERT_NO_THROW(validate(placed.shape, "flat"));
        ASSERT_LT(farthestOutside(placed, points), 1e-12) << name(placed.shape);
      }
      if (dimensions < 2) continue;
      EXPECT_LT(volume(enclosingBox(points).shape), 1e-5 * scale * scale);
    }
  }
}

TEST(EnclosingTest, ManyPointsOnASphereTakeLittleTime) {
  Random random(70);
  Points points;
  for (int k = 0; k < 30000; ++k) points.push_back(random.direction());
  for (const Enclose enclose : kAll) {
    const PlacedShape placed = enclose(points);
    EXPECT_LT(farthestOutside(placed, points), 1e-12) << name(placed.shape);
  }
  EXPECT_LT(volume(smallestEnclosing(points).shape), 1.001 * 4.0 / 3.0 * M_PI);
}

TEST(EnclosingTest, TheSamePointsGiveTheSameBytes) {
  Random random(80);
  const Points points = cloud(random);
  for (const Enclose enclose : kAll) {
    const PlacedShape first = enclose(points);
    const PlacedShape second = enclose(points);
    EXPECT_EQ(volume(first.shape), volume(second.shape));
    EXPECT_EQ(first.pose.matrix(), second.pose.matrix());
  }
}

}  // namespace
}  // namespace tccm
