#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "nodelets/markers.h"
#include "ros/conversions.h"
#include "support/cuboid_scene.h"

namespace tccm {
namespace {

using visualization_msgs::Marker;

constexpr int kStatic = 3;

class CuboidMarkerTest : public ::testing::Test {
 protected:
  CuboidMarkerTest() {
    CuboidMap map = test::emptyMap();
    test::addCuboid(map, *map.grid.cellOf(Vector3(0.51, 0.21, 0.5)), 0.70, 0.75);
    toMessage(map, "odom", map_);
  }
  Marker marker(CuboidLayer layer = CuboidLayer::kLive) { return toMarker(map_, layer, kStatic); }
  /// Red, green and blue of the brightest face.
  std::array<float, 3> colour(CuboidLayer layer = CuboidLayer::kLive) {
    const Marker drawn = marker(layer);
    const auto brightest = std::max_element(
        drawn.colors.begin(), drawn.colors.end(),
        [](const auto& a, const auto& b) { return a.r + a.g + a.b < b.r + b.g + b.b; });
    return {brightest->r, brightest->g, brightest->b};
  }
  tccm_monitor::CuboidMap map_;
};

TEST_F(CuboidMarkerTest, ACuboidIsTwelveTriangles) {
  const Marker drawn = marker();
  EXPECT_EQ(drawn.type, Marker::TRIANGLE_LIST);
  EXPECT_EQ(drawn.action, Marker::ADD);
  EXPECT_EQ(drawn.header.frame_id, "odom");
  EXPECT_EQ(drawn.points.size(), 36U);
  EXPECT_EQ(drawn.colors.size(), 36U);
}

TEST_F(CuboidMarkerTest, ItReachesFromItsCellsCornerToTheOther) {
  UprightBox extent;
  for (const auto& p : marker().points) extent.extend(Vector3(p.x, p.y, p.z));
  EXPECT_TRUE(extent.min().isApprox(Vector3(0.50, 0.20, 0.70), 1e-6)) << extent.min().transpose();
  EXPECT_TRUE(extent.max().isApprox(Vector3(0.52, 0.22, 0.75), 1e-6)) << extent.max().transpose();
}

TEST_F(CuboidMarkerTest, EveryTriangleLooksOutwards) {
  const Marker drawn = marker();
  const Vector3 centre(0.51, 0.21, 0.725);
  for (std::size_t i = 0; i < drawn.points.size(); i += 3) {
    const auto corner = [&](std::size_t k) {
      const auto& p = drawn.points[i + k];
      return Vector3(p.x, p.y, p.z);
    };
    const Vector3 normal = (corner(1) - corner(0)).cross(corner(2) - corner(0));
    EXPECT_GT(normal.norm(), 0.0);
    EXPECT_GT(normal.dot(corner(0) - centre), 0.0) << i / 3;
  }
}

TEST_F(CuboidMarkerTest, ColoursTellStaticAndDynamicApart) {
  map_.cuboids[0].dyn = kStatic;
  const auto fixed = colour();
  EXPECT_GT(fixed[1], std::max(fixed[0], fixed[2])) << "static is green";
  map_.cuboids[0].dyn = kStatic - 1;
  const auto moving = colour();
  EXPECT_GT(moving[0], 2.0F * std::max(moving[1], moving[2])) << "dynamic is red";
}

TEST_F(CuboidMarkerTest, HeldCuboidsAreVioletAndTranslucentInANamespaceOfTheirOwn) {
  map_.cuboids[0].held = 1;
  map_.cuboids[0].dyn = kStatic;
  EXPECT_EQ(marker().action, Marker::DELETE) << "no part of the live map";
  const Marker drawn = marker(CuboidLayer::kHeld);
  EXPECT_EQ(drawn.action, Marker::ADD);
  EXPECT_EQ(drawn.points.size(), 36U);
  EXPECT_NE(drawn.ns, marker().ns);
  for (const auto& corner : drawn.colors) EXPECT_LT(corner.a, 1.0F);
  const auto violet = colour(CuboidLayer::kHeld);
  EXPECT_GT(violet[2], violet[0]);
  EXPECT_GT(violet[0], violet[1]);
}

TEST_F(CuboidMarkerTest, LiveCuboidsAreNotAmongTheHeld) {
  EXPECT_EQ(marker(CuboidLayer::kHeld).action, Marker::DELETE);
  EXPECT_TRUE(marker(CuboidLayer::kHeld).points.empty());
}

TEST_F(CuboidMarkerTest, AnEmptyMapDeletesWhatWasDrawn) {
  map_.cuboids.clear();
  const Marker drawn = marker();
  EXPECT_EQ(drawn.action, Marker::DELETE);
  EXPECT_TRUE(drawn.points.empty());
}

}  // namespace
}  // namespace tccm
