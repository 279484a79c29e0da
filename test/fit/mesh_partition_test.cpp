#include "fit/mesh_partition.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "fit/convex_hull.h"
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

double hullVolume(const MeshPartition& partition) {
  double sum = 0.0;
  for (const MeshPart& part : partition.parts) sum += convexHull(part.vertices()).volume_m3;
  return sum;
}

TEST(MeshPartitionTest, PartsRiseInNumberFromTheWholeToTheMost) {
  for (const std::size_t most : {1U, 2U, 3U, 4U, 5U, 8U}) {
    const std::vector<MeshPartition> found = partitions(comb(), most);
    ASSERT_FALSE(found.empty());
    EXPECT_EQ(found.front().parts.size(), 1U);
    EXPECT_NEAR(hullVolume(found.front()), 0.5 * 0.4 * 0.1, 1e-9);
    EXPECT_LE(found.back().parts.size(), most);
    for (std::size_t i = 1; i < found.size(); ++i) {
      EXPECT_GT(found[i].parts.size(), found[i - 1].parts.size());
    }
  }
}

TEST(MeshPartitionTest, ACombFallsIntoItsTeethWhereOneCutWouldGainNothing) {
  const std::vector<MeshPartition> found = partitions(comb(), 6);
  const double solid = 0.1 * (0.5 * 0.1 + 3 * 0.1 * 0.3);
  double least = 1.0;
  for (const MeshPartition& partition : found) {
    least = std::min(least, partition.rough_volume_m3);
    EXPECT_GE(partition.rough_volume_m3, 0.999 * hullVolume(partition));
  }
  EXPECT_LT(least, 1.15 * solid);
}

TEST(MeshPartitionTest, EveryVertexIsInSomePart) {
  Random random(1);
  Mesh mesh;
  for (int k = 0; k < 40; ++k) mesh.vertices.push_back(random.point(1.0));
  for (std::uint32_t k = 0; k < 38; ++k) mesh.triangles.push_back({k, k + 1, k + 2});
  for (const MeshPartition& partition : partitions(mesh, 5)) {
    for (const Vector3& p : mesh.vertices) {
      const auto holds = [&](const MeshPart& part) {
        const auto same = [&](const Vector3& q) { return (p - q).norm() < 1e-12; };
        return std::any_of(part.vertices().begin(), part.vertices().end(), same);
      };
      ASSERT_TRUE(std::any_of(partition.parts.begin(), partition.parts.end(), holds));
    }
  }
}

}  // namespace
}  // namespace tccm
