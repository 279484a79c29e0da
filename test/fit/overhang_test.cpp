#include "fit/overhang.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <limits>

#include "fit/enclosing.h"
#include "fit/points.h"
#include "support/random.h"

namespace tccm {
namespace {

using test::Random;

using Points = std::vector<Vector3>;

constexpr double kAtMostMore = 1e-4;  // [m]
constexpr double kRounding = 1e-9;    // [m]

PlacedShape unturned(const Shape& shape, const Vector3& at = Vector3::Zero()) {
  return {shape, Pose(Eigen::Translation3d(at))};
}

Points boxCorners(const Vector3& half) {
  Points corners;
  for (int i = 0; i < 8; ++i) {
    const Vector3 sign(i & 1 ? 1.0 : -1.0, i & 2 ? 1.0 : -1.0, i & 4 ? 1.0 : -1.0);
    corners.emplace_back(half.cwiseProduct(sign));
  }
  return corners;
}

TEST(OverhangTest, ABoxAroundASmallerOneReachesBeyondAtItsCorners) {
  const double found =
      overhang(unturned(Box{{0.2, 0.3, 0.1}}), boxCorners(Vector3(0.2, 0.2, 0.1) * 0.5));
  EXPECT_NEAR(found, Vector3(0.1, 0.2, 0.05).norm(), 1e-5);
}

TEST(OverhangTest, ACylinderAroundABoxReachesBeyondWhereItsRimIsFarthest) {
  // Farthest from the bar is the rim above its middle.
  const Points bar = boxCorners({0.5, 0.01, 0.1});
  EXPECT_NEAR(overhang(unturned(Cylinder{0.5, 0.1}), bar), 0.49, kAtMostMore);
  EXPECT_NEAR(overhang(unturned(Cylinder{0.5, 0.4}), bar), std::hypot(0.49, 0.3), kAtMostMore);
}

TEST(OverhangTest, OfABallWithinAHullCountsWhatTheNearestSideDoesNotHold) {
  const Points cube = boxCorners(Vector3::Constant(0.1));
  EXPECT_EQ(overhang(unturned(Sphere{0.05}), cube), 0.0);
  EXPECT_NEAR(overhang(unturned(Sphere{0.15}), cube), 0.05, 1e-9);
  EXPECT_NEAR(overhang(unturned(Sphere{0.05}, {0.07, 0.0, 0.0}), cube), 0.02, 1e-9);
  EXPECT_NEAR(overhang(unturned(Sphere{0.05}, {0.2, 0.2, 0.1}), cube), 0.05 + std::hypot(0.1, 0.1),
              1e-5);
  EXPECT_NEAR(overhang(unturned(Capsule{0.05, 0.2}), cube), 0.15, 1e-5);
  EXPECT_NEAR(overhang(unturned(Capsule{0.12, 0.05}), cube), 0.07, 1e-9);
}

TEST(OverhangTest, FlatHullsHaveNoInside) {
  const Points plate = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  for (const Points& points : {plate, Points{{-1, 0, 0}, {1, 0, 0}}, Points{{0, 0, 0}}}) {
    EXPECT_NEAR(overhang(unturned(Sphere{0.1}), points), 0.1, 1e-5);
  }
}

/// The distance of a point from a triangle, by the regions of its plane (Ericson 2005, 5.1.5).
double fromTriangle(const Vector3& p, const Vector3& a, const Vector3& b, const Vector3& c) {
  const auto fromSegment = [&](const Vector3& from, const Vector3& to) {
    const Vector3 along = to - from;
    const double length2 = along.squaredNorm();
    const double share = length2 > 0.0 ? (p - from).dot(along) / length2 : 0.0;
    return (from + std::clamp(share, 0.0, 1.0) * along - p).norm();
  };
  const double border = std::min({fromSegment(a, b), fromSegment(b, c), fromSegment(c, a)});
  const Vector3 normal = (b - a).cross(c - a);
  const double area2 = normal.squaredNorm();
  const bool above = normal.cross(b - a).dot(p - a) >= 0.0 &&
                     normal.cross(c - b).dot(p - b) >= 0.0 && normal.cross(a - c).dot(p - c) >= 0.0;
  if (!above || !(area2 > 0.0)) return border;
  return std::min(border, std::abs(normal.dot(p - a)) / std::sqrt(area2));
}

/// A hull in brute force: all its triangles are looked at for each point.
class LiteralHull {
 public:
  explicit LiteralHull(const Points& points) {
    const Mesh surface = convexHull(points).surface;
    for (const Vector3& p : surface.vertices) {
      middle_ += p / static_cast<double>(surface.vertices.size());
    }
    for (const auto& [a, b, c] : surface.triangles) {
      triangles_.push_back({surface.vertices[a], surface.vertices[b], surface.vertices[c]});
    }
    is_solid_ = !triangles_.empty();
    if (!is_solid_) takeEveryTriangle(surface.vertices);
  }

  /// Below 0 inside, by the distance from the surface.
  [[nodiscard]] double signedDistance(const Vector3& p) const {
    double least = std::numeric_limits<double>::infinity();
    bool inside = is_solid_;
    for (const auto& [a, b, c] : triangles_) {
      least = std::min(least, fromTriangle(p, a, b, c));
      const Vector3 normal = (b - a).cross(c - a);
      const double outwards = normal.dot(a - middle_) < 0.0 ? -1.0 : 1.0;
      if (outwards * normal.dot(p - a) > 0.0) inside = false;
    }
    return inside ? -least : least;
  }
  [[nodiscard]] double distance(const Vector3& p) const { return std::max(0.0, signedDistance(p)); }

 private:
  /// Every point of a flat hull is in a triangle of three of its points.
  void takeEveryTriangle(const Points& points) {
    for (std::size_t a = 0; a < points.size(); ++a) {
      for (std::size_t b = 0; b <= a; ++b) {
        for (std::size_t c = 0; c <= b; ++c) {
          triangles_.push_back({points[a], points[b], points[c]});
        }
      }
    }
  }

  std::vector<std::array<Vector3, 3>> triangles_;
  Vector3 middle_ = Vector3::Zero();
  bool is_solid_ = false;
};

/// The largest distance that some point of the primitive has for certain.
double sampledOverhang(const PlacedShape& primitive, const LiteralHull& hull, Random& random) {
  double most = 0.0;
  const auto look = [&](const Vector3& p_shape) {
    most = std::max(most, hull.distance(primitive.pose * p_shape));
  };
  if (const auto* box = std::get_if<Box>(&primitive.shape)) {
    for (const Vector3& corner : boxCorners(box->half_extents)) look(corner);
    for (int i = 0; i < 50; ++i) look(random.point(1.0).cwiseProduct(box->half_extents));
  } else if (const auto* cylinder = std::get_if<Cylinder>(&primitive.shape)) {
    constexpr int kSamples = 1000;
    for (int i = 0; i < kSamples; ++i) {
      const double angle = 2.0 * M_PI * i / kSamples;
      const Vector3 out(std::cos(angle), std::sin(angle), 0.0);
      look(cylinder->radius * out + cylinder->half_length * Vector3::UnitZ());
      look(cylinder->radius * out - cylinder->half_length * Vector3::UnitZ());
    }
  } else {
    const auto* capsule = std::get_if<Capsule>(&primitive.shape);
    const double radius = capsule ? capsule->radius : std::get<Sphere>(primitive.shape).radius;
    const double half = capsule ? capsule->half_length : 0.0;
    for (int i = 0; i < 300; ++i) {
      look(radius * random.direction() + (i % 2 ? half : -half) * Vector3::UnitZ());
    }
  }
  return most;
}

/// The overhang in brute force, up to some 0.01 mm too small.
double literalOverhang(const PlacedShape& primitive, const LiteralHull& hull, Random& random) {
  const double sampled = sampledOverhang(primitive, hull, random);
  const auto* capsule = std::get_if<Capsule>(&primitive.shape);
  const auto* sphere = std::get_if<Sphere>(&primitive.shape);
  if (!capsule && !sphere) return sampled;
  // Few directions are as bad as that of the nearest face; a ball may be measured by its centre.
  const double radius = capsule ? capsule->radius : sphere->radius;
  const Vector3 end = (capsule ? capsule->half_length : 0.0) * Vector3::UnitZ();
  const double centres = std::max(hull.signedDistance(primitive.pose * end),
                                  hull.signedDistance(primitive.pose * Vector3(-end)));
  EXPECT_LE(sampled, std::max(0.0, radius + centres) + kRounding);
  return std::max(0.0, radius + centres);
}

constexpr unsigned kPointKinds = 6;

/// Solid, flat, on a line and single points; needles and plates that are barely solid; from 0.1 mm
/// to 1 m.
Points randomPoints(Random& random, int kind) {
  const double scale = std::pow(10.0, random.uniform(-4.0, 0.0));
  if (kind < 3) return random.flatCloud(kind, kind == 0 ? 1 : random.integer(2, 7), scale);
  Points points;
  for (int i = random.integer(4, 25); i > 0; --i) points.push_back(random.point(scale));
  const double thin = std::pow(10.0, random.uniform(-7.0, -1.0));
  const Vector3 squeeze = kind == 3   ? Vector3(1.0, thin, 1.0)
                          : kind == 4 ? Vector3(thin, thin, 1.0)
                                      : Vector3::Ones();
  const Pose pose = random.pose(1.0);
  for (Vector3& p : points) p = pose * Vector3(p.cwiseProduct(squeeze));
  return points;
}

/// Somewhere about the points, from smaller than them to larger.
PlacedShape randomPrimitive(Random& random, std::size_t kind, const Points& points) {
  const auto around = enclosingSphere(points);
  const double extent = std::get<Sphere>(around.shape).radius;
  const auto size = [&] { return std::max(kThinnest, extent * random.uniform(0.05, 2.0)); };
  Pose pose = random.pose(extent * (random.chance(0.5) ? 0.3 : 2.0));
  pose.pretranslate(around.pose.translation());
  if (kind == 0) return {Box{{size(), size(), size()}}, pose};
  if (kind == 1) return {Cylinder{size(), size()}, pose};
  if (kind == 2) return {Capsule{size(), random.chance(0.1) ? 0.0 : size()}, pose};
  return {Sphere{size()}, pose};
}

void expectRight(const PlacedShape& primitive, const Points& points, Random& random) {
  const double found = overhang(primitive, points);
  const double literal = literalOverhang(primitive, LiteralHull(points), random);
  EXPECT_GE(found, literal - kRounding) << name(primitive.shape);
  EXPECT_LE(found, literal + kAtMostMore) << name(primitive.shape);
  EXPECT_EQ(found, overhang(primitive, points));
}

TEST(OverhangTest, OfRandomHullsAndPrimitivesItIsNeverUnderstated) {
  for (unsigned seed = 0; seed < 1200; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const Points points = randomPoints(random, static_cast<int>(seed % kPointKinds));
    const std::size_t kind = seed / kPointKinds % test::kShapeKinds;
    expectRight(randomPrimitive(random, kind, points), points, random);
  }
}

TEST(OverhangTest, OfPrimitivesAroundTheHullItIsNeverUnderstated) {
  for (unsigned seed = 0; seed < 96; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const Points points = randomPoints(random, static_cast<int>(seed % kPointKinds));
    const std::vector<PlacedShape (*)(const Points&)> fits = {enclosingBox, enclosingCylinder,
                                                              enclosingCapsule, enclosingSphere};
    PlacedShape primitive = fits[seed / kPointKinds % fits.size()](points);
    primitive.shape = expanded(primitive.shape, {1.0, random.chance(0.5) ? 0.0 : 0.01});
    expectRight(primitive, points, random);
  }
}

}  // namespace
}  // namespace tccm
