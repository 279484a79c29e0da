#include <gtest/gtest.h>

#include <set>

#include "fit/points.h"
#include "support/random.h"

namespace tccm {
namespace {

using test::Random;
using Points = std::vector<Vector3>;

double extent(const Points& points) {
  Eigen::AlignedBox3d box;
  for (const Vector3& p : points) box.extend(p);
  return box.sizes().maxCoeff();
}

Vector3 middle(const Points& points) {
  Vector3 sum = Vector3::Zero();
  for (const Vector3& p : points) sum += p;
  return sum / static_cast<double>(points.size());
}

/// How far the worst point is in front of a face; faces look away from the middle.
double farthestInFront(const Mesh& hull, const Points& points) {
  const Vector3 inside = middle(hull.vertices);
  double farthest = 0.0;
  for (const auto& [a, b, c] : hull.triangles) {
    const Vector3 at = hull.vertices[a];
    Vector3 normal = (hull.vertices[b] - at).cross(hull.vertices[c] - at);
    if (normal.norm() < 1e-12 * extent(points) * extent(points)) continue;  // a sliver of a face
    normal.normalize();
    if (normal.dot(at - inside) < 0.0) normal = -normal;
    for (const Vector3& p : points) farthest = std::max(farthest, normal.dot(p - at));
  }
  return farthest;
}

Points corners(const Vector3& size) {
  Points points;
  for (const double x : {0.0, size.x()}) {
    for (const double y : {0.0, size.y()}) {
      for (const double z : {0.0, size.z()}) points.emplace_back(x, y, z);
    }
  }
  return points;
}

Points moved(Points points, const Pose& pose) {
  for (Vector3& p : points) p = pose * p;
  return points;
}

TEST(ConvexHullTest, ACubeHas8CornersAnd12TrianglesAndItsVolume) {
  Points points = corners({1.0, 2.0, 3.0});
  points.emplace_back(0.5, 0.5, 0.5);
  points.emplace_back(0.5, 1.0, 0.0);  // within a face
  points.emplace_back(0.5, 0.0, 0.0);  // within an edge
  const ConvexHull hull = convexHull(points);
  EXPECT_EQ(hull.surface.vertices.size(), 8U);
  EXPECT_EQ(hull.surface.triangles.size(), 12U);
  EXPECT_NEAR(hull.volume_m3, 6.0, 1e-12);
}

TEST(ConvexHullTest, KnownVolumesAreFoundInAnyPlaceAndSize) {
  Random random(1);
  const Points tetrahedron = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const Points octahedron = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  for (const double scale : {1e-4, 1e-3, 1.0, 100.0}) {
    for (int i = 0; i < 20; ++i) {
      Pose pose = random.pose(5.0);
      pose.linear() *= scale;
      const double unit = std::pow(scale, 3);
      EXPECT_NEAR(convexHull(moved(tetrahedron, pose)).volume_m3, unit / 6.0, 1e-9 * unit);
      EXPECT_NEAR(convexHull(moved(octahedron, pose)).volume_m3, unit * 4.0 / 3.0, 1e-9 * unit);
      EXPECT_NEAR(convexHull(moved(corners({1, 1, 1}), pose)).volume_m3, unit, 1e-9 * unit);
    }
  }
}

TEST(ConvexHullTest, NoPointOfARandomCloudIsInFrontOfAFace) {
  Random random(2);
  for (int i = 0; i < 100; ++i) {
    const Vector3 stretch(random.uniform(0.001, 1.0), random.uniform(0.001, 1.0), 1.0);
    const Pose pose = random.pose(2.0);
    Points points;
    const int count = random.integer(4, 200);
    for (int k = 0; k < count; ++k) {
      const Vector3 p = random.chance(0.5) ? random.direction() : random.point(1.0);
      points.push_back(pose * stretch.cwiseProduct(p));
    }
    const ConvexHull hull = convexHull(points);
    ASSERT_GE(hull.surface.triangles.size(), 4U);
    ASSERT_LT(farthestInFront(hull.surface, points), 1e-11) << i;
  }
}

/// A closed surface of triangles of V vertices has 2 V - 4 of them, and each edge twice.
TEST(ConvexHullTest, TheSurfaceIsClosed) {
  Random random(3);
  for (int i = 0; i < 50; ++i) {
    Points points;
    for (int k = 0; k < 100; ++k) points.push_back(random.point(1.0));
    const Mesh hull = convexHull(points).surface;
    EXPECT_EQ(hull.triangles.size(), 2 * hull.vertices.size() - 4);
    std::multiset<std::pair<std::uint32_t, std::uint32_t>> edges;
    for (const Mesh::Triangle& t : hull.triangles) {
      for (std::size_t k = 0; k < 3; ++k) edges.insert(std::minmax(t.at(k), t.at((k + 1) % 3)));
    }
    for (const auto& edge : edges) ASSERT_EQ(edges.count(edge), 2U);
  }
}

TEST(ConvexHullTest, GridsWithManyPointsInEveryFaceKeepTheirVolume) {
  Random random(4);
  Points grid;
  for (int x = 0; x <= 10; ++x) {
    for (int y = 0; y <= 10; ++y) {
      for (int z = 0; z <= 10; ++z) grid.emplace_back(0.1 * x, 0.1 * y, 0.1 * z);
    }
  }
  for (int i = 0; i < 10; ++i) {
    const Points points = moved(grid, random.pose(1.0));
    const ConvexHull hull = convexHull(points);
    EXPECT_NEAR(hull.volume_m3, 1.0, 1e-9);
    EXPECT_LT(farthestInFront(hull.surface, points), 1e-9);
  }
}

double furthestAlong(const Vector3& direction, const Points& points) {
  double furthest = -1e9;
  for (const Vector3& p : points) furthest = std::max(furthest, direction.dot(p));
  return furthest;
}

TEST(ConvexHullTest, FlatCollinearAndSinglePointsHaveNoVolumeAndKeepTheirExtremes) {
  Random random(5);
  for (const double scale : {1e-4, 1.0}) {
    for (int dimensions = 0; dimensions < 3; ++dimensions) {
      const Points points = random.flatCloud(dimensions, 50, scale);
      const ConvexHull hull = convexHull(points);
      EXPECT_NEAR(hull.volume_m3, 0.0, 1e-12 * scale * scale);
      for (int k = 0; k < 20; ++k) {
        const Vector3 n = random.direction();
        ASSERT_NEAR(furthestAlong(n, points), furthestAlong(n, hull.surface.vertices), 1e-12);
      }
    }
  }
}

TEST(ConvexHullTest, DuplicatesChangeNothing) {
  Random random(6);
  Points points = corners({0.1, 0.1, 0.1});
  for (int k = 0; k < 5; ++k) points.insert(points.end(), points.begin(), points.begin() + 8);
  const ConvexHull hull = convexHull(points);
  EXPECT_EQ(hull.surface.vertices.size(), 8U);
  EXPECT_NEAR(hull.volume_m3, 1e-3, 1e-15);
  EXPECT_EQ(convexHull({3, Vector3(1.0, 2.0, 3.0)}).surface.vertices.size(), 1U);
}

TEST(ConvexHullTest, NoPointsGiveAnEmptyHull) {
  EXPECT_TRUE(convexHull({}).surface.vertices.empty());
  EXPECT_EQ(convexHull({}).volume_m3, 0.0);
}

/// Every thickness between flat and solid, where a hull's faces are hard to tell apart.
TEST(ConvexHullTest, NearlyFlatCloudsOfEveryThicknessAreHeldWithoutAWord) {
  Random random(7);
  testing::internal::CaptureStderr();
  for (double thickness = 1e-18; thickness < 1.0; thickness *= 3.0) {
    const Pose pose = random.pose(1.0);
    Points points;
    for (int k = 0; k < 60; ++k) {
      points.push_back(pose * random.point(1.0).cwiseProduct(Vector3(1.0, 1.0, thickness)));
    }
    const ConvexHull hull = convexHull(points);
    ASSERT_FALSE(hull.surface.vertices.empty());
    ASSERT_LE(hull.volume_m3, 8.0 * thickness + 1e-12);
    for (int k = 0; k < 100; ++k) {
      const Vector3 n = random.direction();
      ASSERT_NEAR(furthestAlong(n, points), furthestAlong(n, hull.surface.vertices), 1e-9)
          << thickness;
    }
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST(ConvexHullTest, LonePointsFarAwayAndHugeExtentsAreHeld) {
  const Points far = {{0, 0, 0}, {1e8, 0, 0}, {0, 1e8, 0}, {0, 0, 1e8}, {1e-8, 1e-8, 1e-8}};
  EXPECT_NEAR(convexHull(far).volume_m3 / 1e24, 1.0 / 6.0, 1e-9);
  EXPECT_NO_THROW(static_cast<void>(
      convexHull({{1e300, 0, 0}, {-1e300, 0, 0}, {0, 1e300, 0}, {0, 0, 1e300}, {0, 0, -1e300}})));
}

}  // namespace
}  // namespace tccm
