#include "fit/primitive_fit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <memory>

#include "fit/points.h"
#include "support/geometric_shapes_body.h"
#include "support/random.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

using test::Random;
using test::toBody;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

PrimitiveFit fit(const Mesh& mesh, const PrimitiveFitConfig& config = {}) {
  return fitPrimitives(mesh, config, "link");
}

PrimitiveFitConfig atMost(int primitives) {
  PrimitiveFitConfig config;
  config.primitives_max = primitives;
  return config;
}

void add(Mesh& mesh, const Mesh& more) {
  const auto offset = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), more.vertices.begin(), more.vertices.end());
  for (const auto& [a, b, c] : more.triangles) {
    mesh.triangles.push_back({a + offset, b + offset, c + offset});
  }
}

Mesh boxMesh(const Vector3& low, const Vector3& high) {
  std::vector<Vector3> corners;
  for (int i = 0; i < 8; ++i) {
    corners.emplace_back(i & 1 ? high.x() : low.x(), i & 2 ? high.y() : low.y(),
                         i & 4 ? high.z() : low.z());
  }
  return convexHull(corners).surface;
}

Mesh lShape() {
  Mesh mesh = boxMesh({0.0, 0.0, 0.0}, {0.5, 0.1, 0.1});
  add(mesh, boxMesh({0.0, 0.1, 0.0}, {0.1, 0.4, 0.1}));
  return mesh;
}

Mesh uShape() {
  Mesh mesh = lShape();
  add(mesh, boxMesh({0.4, 0.1, 0.0}, {0.5, 0.4, 0.1}));
  return mesh;
}

void transform(Mesh& mesh, double scale, const Pose& pose) {
  for (Vector3& p : mesh.vertices) p = pose * Vector3(scale * p);
}

/// Whether geometric_shapes says that p is in the primitive; a capsule is a cylinder and two balls.
class Inclusion {
 public:
  explicit Inclusion(const PlacedShape& placed) {
    const auto* capsule = std::get_if<Capsule>(&placed.shape);
    if (!capsule) {
      add(placed.shape, placed.pose);
      return;
    }
    for (const double end : {-capsule->half_length, capsule->half_length}) {
      add(Sphere{capsule->radius}, placed.pose * Eigen::Translation3d(0.0, 0.0, end));
    }
    if (capsule->half_length > 0.0) {
      add(Cylinder{capsule->radius, capsule->half_length}, placed.pose);
    }
  }
  [[nodiscard]] bool contains(const Vector3& p) const {
    for (const auto& body : bodies_) {
      if (body->containsPoint(p)) return true;
    }
    return false;
  }

 private:
  void add(const Shape& shape, const Pose& pose) {
    bodies_.push_back(toBody(shape));
    bodies_.back()->setPose(pose);
  }
  std::vector<std::unique_ptr<bodies::Body>> bodies_;
};

/// Samples corners, edges and insides of all triangles.
int pointsOutside(const Mesh& mesh, const PrimitiveFit& fit, Random& random) {
  std::vector<Inclusion> primitives;
  for (const PlacedShape& placed : fit.primitives) primitives.emplace_back(placed);
  int outside = 0;
  const auto check = [&](const Vector3& p) {
    const auto holds = [&](const Inclusion& primitive) { return primitive.contains(p); };
    outside += std::none_of(primitives.begin(), primitives.end(), holds);
  };
  for (const auto& [a, b, c] : mesh.triangles) {
    for (int i = 0; i < 60; ++i) {
      double u = random.uniform(0.0, 1.0);
      double v = i % 3 == 0 ? 0.0 : random.uniform(0.0, 1.0 - u);
      if (i < 3) u = v = 0.0;
      const Vector3& from = mesh.vertices[i % 2 ? a : c];
      const Vector3& to = mesh.vertices[i % 2 ? c : a];
      check(from + u * (mesh.vertices[b] - from) + v * (to - from));
    }
  }
  return outside;
}

double totalVolume(const PrimitiveFit& fit) {
  double sum = 0.0;
  for (const PlacedShape& placed : fit.primitives) sum += volume(placed.shape);
  return sum;
}

void expectSound(const Mesh& mesh, const PrimitiveFitConfig& config, Random& random) {
  const PrimitiveFit found = fit(mesh, config);
  ASSERT_GE(found.primitives.size(), 1U);
  ASSERT_LE(found.primitives.size(), static_cast<std::size_t>(config.primitives_max));
  for (const PlacedShape& placed : found.primitives) {
    ASSERT_NO_THROW(validate(placed.shape, "link"));
    ASSERT_TRUE(isRigid(placed.pose));
  }
  ASSERT_GE(found.overhang_m, 0.0);
  ASSERT_EQ(pointsOutside(mesh, found, random), 0);
}

TEST(PrimitiveFitTest, RandomTrianglesOfEverySizeAreWhollyInside) {
  Random random(1);
  for (int i = 0; i < 25; ++i) {
    Mesh mesh;
    const int vertices = random.integer(3, 60);
    for (int k = 0; k < vertices; ++k) mesh.vertices.push_back(random.point(1.0));
    const int triangles = random.integer(1, 60);
    const auto any = [&]() { return static_cast<std::uint32_t>(random.integer(0, vertices - 1)); };
    for (int k = 0; k < triangles; ++k) mesh.triangles.push_back({any(), any(), any()});
    transform(mesh, std::pow(10.0, random.uniform(-3.5, 0.5)), random.pose(1.0));
    expectSound(mesh, atMost(random.integer(1, 6)), random);
  }
}

TEST(PrimitiveFitTest, BumpySolidsAreWhollyInside) {
  Random random(2);
  for (int i = 0; i < 8; ++i) {
    std::vector<Vector3> directions;
    for (int k = 0; k < 200; ++k) directions.push_back(random.direction());
    Mesh mesh = convexHull(directions).surface;
    const Vector3 waves = random.point(6.0);
    for (Vector3& p : mesh.vertices) p *= 1.0 + 0.6 * std::sin(waves.dot(p));
    transform(mesh, 0.1, random.pose(1.0));
    expectSound(mesh, {}, random);
  }
}

TEST(PrimitiveFitTest, FlatThinAndLoneMeshesAreInside) {
  Random random(3);
  for (const double scale : {1e-3, 0.1, 1.0}) {
    for (int i = 0; i < 5; ++i) {
      const Pose pose = random.pose(1.0);
      Mesh plate{{{0, 0, 0}, {1, 0, 0}, {1, 0.5, 0}, {0, 0.5, 0}}, {{0, 1, 2}, {0, 2, 3}}};
      Mesh triangle{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
      Mesh needle{{{0, 0, 0}, {1, 0, 0}}, {{0, 1, 1}}};
      Mesh point{{{1, 2, 3}}, {{0, 0, 0}}};
      Mesh points{{{1, 2, 3}, {0, 1, 0}, {2, 0, 1}}, {{0, 0, 0}, {1, 1, 1}, {2, 2, 2}}};
      for (Mesh* mesh : {&plate, &triangle, &needle, &point, &points}) {
        transform(*mesh, scale, pose);
        expectSound(*mesh, {}, random);
        EXPECT_NEAR(fit(*mesh).hull_volume_m3, 0.0, 1e-12);
      }
      EXPECT_LT(totalVolume(fit(plate)), 2.5e-5 * scale);
    }
  }
}

TEST(PrimitiveFitTest, ABoxAloneIsOneBoxOfItsSizeAndReachesNowhereBeyond) {
  Random random(4);
  Mesh mesh = boxMesh({0.0, 0.0, 0.0}, {0.1, 0.2, 0.3});
  transform(mesh, 1.0, random.pose(1.0));
  const PrimitiveFit found = fit(mesh);
  ASSERT_EQ(found.primitives.size(), 1U);
  EXPECT_EQ(name(found.primitives[0].shape), "box");
  EXPECT_NEAR(totalVolume(found), 0.006, 1e-5);
  EXPECT_NEAR(found.hull_volume_m3, 0.006, 1e-12);
  EXPECT_LT(found.overhang_m, 1e-4);
}

TEST(PrimitiveFitTest, LAndUShapesAreSeveralBoxesThatAreFullOfThem) {
  Random random(5);
  Mesh l = lShape();
  Mesh u = uShape();
  transform(l, 1.0, random.pose(1.0));
  transform(u, 1.0, random.pose(1.0));
  EXPECT_EQ(fit(l).primitives.size(), 2U);
  EXPECT_EQ(fit(u).primitives.size(), 3U);
  EXPECT_NEAR(totalVolume(fit(l)), 0.008, 1e-4);
  EXPECT_NEAR(totalVolume(fit(u)), 0.011, 1e-4);
  EXPECT_GT(totalVolume(fit(l, atMost(1))), 0.015);
  EXPECT_GT(totalVolume(fit(u, atMost(2))), 0.012);
}

/// Ball, rod, ball: the first cut gains little, both together much.
TEST(PrimitiveFitTest, ADumbbellIsThreePrimitives) {
  Random random(6);
  std::vector<Vector3> ball;
  for (int k = 0; k < 300; ++k) ball.push_back(0.1 * random.direction());
  Mesh dumbbell = convexHull(ball).surface;
  Mesh other = dumbbell;
  transform(other, 1.0, Pose(Eigen::Translation3d(0.0, 0.0, 0.6)));
  add(dumbbell, other);
  add(dumbbell, boxMesh({-0.02, -0.02, 0.1}, {0.02, 0.02, 0.5}));
  const PrimitiveFit found = fit(dumbbell);
  EXPECT_EQ(found.primitives.size(), 3U);
  EXPECT_LT(totalVolume(found), 1.25 * (2.0 * volume(Sphere{0.1}) + 0.04 * 0.04 * 0.4));
}

TEST(PrimitiveFitTest, AMoreDemandingGainLeavesFewerPrimitives) {
  PrimitiveFitConfig demanding;
  demanding.split_gain = 0.9;
  EXPECT_EQ(fit(uShape(), demanding).primitives.size(), 1U);
}

TEST(PrimitiveFitTest, TheMarginGrowsEverySide) {
  PrimitiveFitConfig wide = atMost(1);
  wide.margin_m = 0.01;
  const PrimitiveFit found = fit(boxMesh({0.0, 0.0, 0.0}, {0.1, 0.1, 0.1}), wide);
  const Vector3 half = std::get<Box>(found.primitives.at(0).shape).half_extents;
  EXPECT_LT((half - Vector3::Constant(0.06)).norm(), 1e-9);
  EXPECT_NEAR(found.overhang_m, 0.01 * std::sqrt(3.0), 1e-4);
}

/// A right-angled triangle's plate: the box's empty corner is farthest from the long side.
TEST(PrimitiveFitTest, TheOverhangIsTheFarthestCornersDistanceFromThePart) {
  const Mesh wedge =
      convexHull({{0, 0, 0}, {0.3, 0, 0}, {0, 0.4, 0}, {0, 0, 0.5}, {0.3, 0, 0.5}, {0, 0.4, 0.5}})
          .surface;
  const PrimitiveFit found = fit(wedge, atMost(1));
  ASSERT_EQ(name(found.primitives.at(0).shape), "box");
  const auto& box = found.primitives.at(0);
  const Vector3 half = std::get<Box>(box.shape).half_extents;
  // The prism's hull in brute force: the nearest of densely sampled points.
  double farthest = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    const Vector3 sign(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
    const Vector3 p = box.pose * Vector3(half.cwiseProduct(sign));
    double nearest = kInfinity;
    for (double x = 0.0; x <= 0.3; x += 0.001) {
      for (double y = 0.0; y <= 0.4 * (1.0 - x / 0.3) + 1e-9; y += 0.001) {
        const double z = std::clamp(p.z(), 0.0, 0.5);
        nearest = std::min(nearest, (Vector3(x, y, z) - p).norm());
      }
    }
    farthest = std::max(farthest, nearest);
  }
  EXPECT_NEAR(found.overhang_m, farthest, 0.002);
}

TEST(PrimitiveFitTest, TheSameMeshGivesTheSameBytes) {
  Random random(7);
  Mesh mesh = uShape();
  transform(mesh, 1.0, random.pose(1.0));
  const PrimitiveFit first = fit(mesh);
  const PrimitiveFit second = fit(mesh);
  ASSERT_EQ(first.primitives.size(), second.primitives.size());
  for (std::size_t i = 0; i < first.primitives.size(); ++i) {
    EXPECT_EQ(first.primitives[i].shape.index(), second.primitives[i].shape.index());
    EXPECT_EQ(volume(first.primitives[i].shape), volume(second.primitives[i].shape));
    EXPECT_EQ(first.primitives[i].pose.matrix(), second.primitives[i].pose.matrix());
  }
  EXPECT_EQ(first.overhang_m, second.overhang_m);
}

/// What fit() says about the mesh; nothing where it accepts it.
std::string refusal(const Mesh& mesh, const PrimitiveFitConfig& config = {}) {
  try {
    static_cast<void>(fitPrimitives(mesh, config, "left_wrist"));
  } catch (const ConfigError& error) {
    return error.what();
  }
  return {};
}

TEST(PrimitiveFitTest, WhatIsNoMeshIsRefusedInOneLineThatNamesTheOwner) {
  const Mesh good = boxMesh({0, 0, 0}, {1, 1, 1});
  std::vector<Mesh> refused = {{good.vertices, {}}, {{}, good.triangles}};
  for (const double bad : {kNaN, kInfinity, -kInfinity, 1e30}) {
    refused.push_back(good);
    refused.back().vertices[3].y() = bad;
  }
  refused.push_back(good);
  refused.back().triangles[5][1] = 8;
  for (std::size_t i = 0; i < refused.size(); ++i) {
    const std::string said = refusal(refused[i]);
    EXPECT_NE(said.find("left_wrist"), std::string::npos) << i;
    EXPECT_EQ(said.find('\n'), std::string::npos);
  }
  EXPECT_EQ(refusal(good), "");
  EXPECT_TRUE(fitPrimitives({}, {}, "left_wrist").primitives.empty());
}

TEST(PrimitiveFitTest, ConfigurationsOutsideTheirRangeAreRefused) {
  const Mesh mesh = boxMesh({0, 0, 0}, {1, 1, 1});
  EXPECT_NE(refusal(mesh, atMost(0)), "");
  EXPECT_NE(refusal(mesh, atMost(17)), "");
  for (const double bad : {-0.1, 1.0, kNaN}) {
    PrimitiveFitConfig config;
    config.split_gain = bad;
    EXPECT_NE(refusal(mesh, config), "");
  }
  for (const double bad : {-1e-6, 1.0, kNaN}) {
    PrimitiveFitConfig config;
    config.margin_m = bad;
    EXPECT_NE(refusal(mesh, config), "");
  }
}

TEST(PrimitiveFitTest, AMeshOf100000TrianglesIsFittedToo) {
  Mesh mesh;
  constexpr std::uint32_t kRings = 250;
  constexpr std::uint32_t kSides = 200;
  for (std::uint32_t ring = 0; ring < kRings; ++ring) {
    const double z = 0.4 * ring / (kRings - 1);
    const double radius = z < 0.1 ? 0.1 : 0.04;
    for (std::uint32_t side = 0; side < kSides; ++side) {
      const double angle = 2.0 * M_PI * side / kSides;
      mesh.vertices.emplace_back(radius * std::cos(angle), radius * std::sin(angle), z);
      if (ring == 0) continue;
      const std::uint32_t here = ring * kSides + side;
      const std::uint32_t next = ring * kSides + (side + 1) % kSides;
      mesh.triangles.push_back({here, next, here - kSides});
      mesh.triangles.push_back({next, here - kSides, next - kSides});
    }
  }
  const PrimitiveFit found = fit(mesh);
  EXPECT_EQ(found.primitives.size(), 2U);
  EXPECT_LT(totalVolume(found), 1.05 * M_PI * (0.01 * 0.1 + 0.0016 * 0.3));
}

}  // namespace
}  // namespace tccm
