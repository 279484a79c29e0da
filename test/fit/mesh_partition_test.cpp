#include "fit/mesh_partition.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "fit/enclosing.h"
#include "fit/points.h"
#include "support/random.h"

namespace tccm {
namespace {

using test::Random;

void addBox(Mesh& mesh, const Vector3& low, const Vector3& high) {
  std::vector<Vector3> corners;
  for (int i = 0; i < 8; ++i) {
    corners.emplace_back(i & 1 ? high.x() : low.x(), i & 2 ? high.y() : low.y(),
                         i & 4 ? high.z() : low.z());
  }
  const Mesh box = convexHull(corners).surface;
  const auto offset = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), box.vertices.begin(), box.vertices.end());
  for (const auto& [a, b, c] : box.triangles) {
    mesh.triangles.push_back({a + offset, b + offset, c + offset});
  }
}

/// Three legs of one comb: no single cut gains anything, several parallel ones do.
Mesh comb() {
  Mesh mesh;
  addBox(mesh, {0.0, 0.0, 0.0}, {0.5, 0.1, 0.1});
  for (const double x : {0.0, 0.2, 0.4}) addBox(mesh, {x, 0.1, 0.0}, {x + 0.1, 0.4, 0.1});
  return mesh;
}

using Parts = std::vector<MeshPart>;

double hullVolume(const Parts& parts) {
  double sum = 0.0;
  for (const MeshPart& part : parts) sum += convexHull(part.vertices()).volume_m3;
  return sum;
}

TEST(MeshPartitionTest, PartsRiseInNumberFromTheWholeToTheMost) {
  for (const std::size_t most : {1U, 2U, 3U, 4U, 5U, 8U}) {
    const std::vector<Parts> found = partitions(comb(), most);
    ASSERT_FALSE(found.empty());
    EXPECT_EQ(found.front().size(), 1U);
    EXPECT_NEAR(hullVolume(found.front()), 0.5 * 0.4 * 0.1, 1e-9);
    EXPECT_LE(found.back().size(), most);
    for (std::size_t i = 1; i < found.size(); ++i) {
      EXPECT_GT(found[i].size(), found[i - 1].size());
    }
  }
}

TEST(MeshPartitionTest, ACombFallsIntoItsTeethWhereOneCutWouldGainNothing) {
  const std::vector<Parts> found = partitions(comb(), 6);
  const double solid = 0.1 * (0.5 * 0.1 + 3 * 0.1 * 0.3);
  double least = 1.0;
  for (const Parts& parts : found) {
    double around = 0.0;
    for (const MeshPart& part : parts) around += volume(smallestEnclosing(part.vertices()).shape);
    least = std::min(least, around);
    EXPECT_GE(around, 0.999 * hullVolume(parts));
  }
  EXPECT_LT(least, 1.15 * solid);
}

TEST(MeshPartitionTest, EveryVertexIsInSomePart) {
  Random random(1);
  Mesh mesh;
  for (int k = 0; k < 40; ++k) mesh.vertices.push_back(random.point(1.0));
  for (std::uint32_t k = 0; k < 38; ++k) mesh.triangles.push_back({k, k + 1, k + 2});
  for (const Parts& parts : partitions(mesh, 5)) {
    for (const Vector3& p : mesh.vertices) {
      const auto holds = [&](const MeshPart& part) {
        const auto same = [&](const Vector3& q) { return (p - q).norm() < 1e-12; };
        return std::any_of(part.vertices().begin(), part.vertices().end(), same);
      };
      ASSERT_TRUE(std::any_of(parts.begin(), parts.end(), holds));
    }
  }
}

Mesh randomMesh(Random& random) {
  Mesh mesh;
  for (int k = 0; k < 20; ++k) mesh.vertices.push_back(random.point(1.0));
  for (int k = 0; k < 30; ++k) {
    mesh.triangles.push_back({static_cast<std::uint32_t>(random.integer(0, 19)),
                              static_cast<std::uint32_t>(random.integer(0, 19)),
                              static_cast<std::uint32_t>(random.integer(0, 19))});
  }
  return mesh;
}

Vector3 pointOn(const Mesh& mesh, const Mesh::Triangle& t, Random& random) {
  double u = random.uniform(0.0, 1.0);
  double v = random.uniform(0.0, 1.0);
  if (u + v > 1.0) {
    u = 1.0 - u;
    v = 1.0 - v;
  }
  const Vector3 a = mesh.vertices[t[0]];
  return a + u * (mesh.vertices[t[1]] - a) + v * (mesh.vertices[t[2]] - a);
}

/// How far p is beyond the points' hull along one direction; never more than 0 inside the hull.
double beyond(const std::vector<Vector3>& points, const Vector3& p, const Vector3& n) {
  double reach = -std::numeric_limits<double>::infinity();
  for (const Vector3& q : points) reach = std::max(reach, n.dot(q));
  return n.dot(p) - reach;
}

TEST(MeshCutTest, EveryPointOfATriangleIsInTheHullOfThePartOnItsSide) {
  Random random(1);
  for (int i = 0; i < 100; ++i) {
    const Mesh mesh = randomMesh(random);
    const Plane plane{random.direction(), random.uniform(-0.8, 0.8)};
    const auto [below, above] = MeshPart(mesh).cut(plane);
    for (const Mesh::Triangle& triangle : mesh.triangles) {
      const Vector3 p = pointOn(mesh, triangle, random);
      const MeshPart& part = plane.normal.dot(p) < plane.height_m ? below : above;
      for (int k = 0; k < 50; ++k) {
        ASSERT_LT(beyond(part.vertices(), p, random.direction()), 1e-12) << i;
      }
    }
  }
}

TEST(MeshCutTest, NeitherPartReachesAcrossThePlane) {
  Random random(2);
  for (int i = 0; i < 100; ++i) {
    const Plane plane{random.direction(), random.uniform(-0.8, 0.8)};
    const auto [below, above] = MeshPart(randomMesh(random)).cut(plane);
    for (const Vector3& p : below.vertices()) {
      ASSERT_LT(plane.normal.dot(p), plane.height_m + 1e-12);
    }
    for (const Vector3& p : above.vertices()) {
      ASSERT_GT(plane.normal.dot(p), plane.height_m - 1e-12);
    }
  }
}

TEST(MeshCutTest, SlicesHaveTheHullsOfRepeatedCuts) {
  Random random(3);
  for (int i = 0; i < 50; ++i) {
    const Vector3 normal = random.direction();
    const std::vector<double> heights = {-0.5, -0.1, 0.3};
    MeshPart rest(randomMesh(random));
    const std::vector<std::vector<Vector3>> slices = rest.slices(normal, heights);
    ASSERT_EQ(slices.size(), 4U);
    for (std::size_t k = 0; k < heights.size(); ++k) {
      auto [below, above] = rest.cut({normal, heights[k]});
      EXPECT_NEAR(convexHull(slices[k]).volume_m3, convexHull(below.vertices()).volume_m3, 1e-12);
      rest = above;
    }
    EXPECT_NEAR(convexHull(slices[3]).volume_m3, convexHull(rest.vertices()).volume_m3, 1e-12);
  }
}

TEST(MeshCutTest, ACutAndJoinedCubeIsThatCube) {
  Random random(4);
  std::vector<Vector3> corners;
  for (int i = 0; i < 8; ++i) corners.emplace_back(i & 1, (i >> 1) & 1, (i >> 2) & 1);
  const MeshPart cube(convexHull(corners).surface);
  for (int i = 0; i < 20; ++i) {
    const auto [below, above] = cube.cut({random.direction(), random.uniform(0.2, 0.6)});
    const double low = convexHull(below.vertices()).volume_m3;
    const double high = convexHull(above.vertices()).volume_m3;
    EXPECT_NEAR(low + high, 1.0, 1e-9);
    EXPECT_NEAR(convexHull(MeshPart::joined(below, above).vertices()).volume_m3, 1.0, 1e-9);
  }
}

TEST(MeshCutTest, LedgesAreTheFacesAcrossADirection) {
  std::vector<Vector3> corners;
  for (int i = 0; i < 8; ++i) corners.emplace_back(2 * (i & 1), (i >> 1) & 1, 3 * ((i >> 2) & 1));
  double low = 0.0;
  double high = 0.0;
  for (const auto& [height, area] : MeshPart(convexHull(corners).surface).ledges({0, 0, 1})) {
    EXPECT_TRUE(height == 0.0 || height == 3.0);
    (height == 0.0 ? low : high) += area;
  }
  EXPECT_NEAR(low, 2.0, 1e-12);
  EXPECT_NEAR(high, 2.0, 1e-12);
}

TEST(MeshCutTest, VerticesOfNoTriangleAreLeftOut) {
  Mesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {9, 9, 9}}, {{0, 1, 2}}};
  EXPECT_EQ(MeshPart(mesh).vertices().size(), 3U);
}

}  // namespace
}  // namespace tccm
