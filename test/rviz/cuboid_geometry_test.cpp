#include "rviz/cuboid_geometry.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "support/cuboid_scene.h"

namespace tccm {
namespace {

using Vertex = CuboidVertex;

constexpr Rgba kMagenta{255, 0, 204, 255}, kBlue{51, 102, 255, 255};

Vector3 place(const Vertex& vertex) { return {vertex.x, vertex.y, vertex.z}; }

class CuboidGeometryTest : public ::testing::Test {
 protected:
  CuboidGeometryTest() : map_(test::emptyMap()) {}

  /// Beside the first cell in x and y, so many cells away.
  [[nodiscard]] CellIndex cell(CellIndex x, CellIndex y) const {
    return (y + 50) * map_.grid.cellsX() + x + 10;
  }
  void add(CellIndex x, CellIndex y, double bottom, double top) {
    test::addCuboid(map_, cell(x, y), bottom, top);
  }
  /// The corners of all faces are in corners_ then.
  /// Cuboids in most cells of a small area.
  void buildOfMany(test::Random& random) {
    Grid::Config grid;
    grid.size_x_m = grid.size_y_m = 0.3;
    map_ = test::randomMap(random, grid, 0.7);
    build();
  }
  void build() {
    geometry_.build(map_, look_, flagged_);
    corners_.clear();
    for (const CuboidFaces* faces : {&geometry_.live(), &geometry_.held()}) {
      for (const auto& side : faces->sides)
        corners_.insert(corners_.end(), side.begin(), side.end());
    }
  }
  std::size_t faces() {
    build();
    return geometry_.faces();
  }
  /// Of the brightest face of the only cuboid.
  Rgba color(CuboidColoring coloring) {
    look_.coloring = coloring;
    build();
    return corners_.front().color;
  }

  CuboidMap map_;
  CuboidLook look_;
  std::vector<FlaggedPlace> flagged_;
  CuboidGeometry geometry_;
  std::vector<Vertex> corners_;
};

TEST_F(CuboidGeometryTest, AnEmptyMapHasNoFaces) {
  EXPECT_EQ(faces(), 0U);
  EXPECT_TRUE(geometry_.live().bounds.isEmpty());
}

TEST_F(CuboidGeometryTest, ACuboidAloneHasSixFacesFromItsCellsCornerToTheOther) {
  add(0, 0, 0.70, 0.75);
  EXPECT_EQ(faces(), 6U);
  EXPECT_EQ(corners_.size(), 24U);
  const UprightBox box = map_.box(map_.cuboids[0]);
  UprightBox extent;
  for (const Vertex& vertex : corners_) extent.extend(place(vertex));
  EXPECT_TRUE(extent.isApprox(box, 1e-6));
  EXPECT_TRUE(geometry_.live().bounds.isApprox(box, 1e-12));
}

TEST_F(CuboidGeometryTest, EveryFaceLooksOutwards) {
  add(0, 0, 0.70, 0.75);
  build();
  const Vector3 centre = map_.box(map_.cuboids[0]).center();
  for (std::size_t i = 0; i < corners_.size(); i += CuboidFaces::kCorners) {
    const auto corner = [&](std::size_t k) { return place(corners_[i + k]); };
    const Vector3 normal = (corner(1) - corner(0)).cross(corner(2) - corner(0));
    EXPECT_GT(normal.dot(corner(0) - centre), 0.0) << i;
    EXPECT_GT((corner(2) - corner(0)).cross(corner(3) - corner(0)).dot(normal), 0.0) << i;
  }
}

TEST_F(CuboidGeometryTest, WhatNeighboursHideOfEachOtherIsLeftOut) {
  add(0, 0, 0.70, 0.75);
  add(1, 0, 0.70, 0.75);
  EXPECT_EQ(faces(), 10U);
  add(0, 1, 0.70, 0.75);
  EXPECT_EQ(faces(), 14U);
  add(1, 1, 0.70, 0.75);
  EXPECT_EQ(faces(), 16U) << "a plate of four: 4 tops, 4 bottoms, 8 sides";
}

TEST_F(CuboidGeometryTest, OfASideTheBareHeightsAreDrawn) {
  add(0, 0, 0.50, 0.90);
  add(1, 0, 0.60, 0.70);  // hides a part of it, and is hidden itself
  EXPECT_EQ(faces(), 7U + 5U);
  add(1, 0, 0.75, 0.80);
  EXPECT_EQ(faces(), 8U + 10U);
}

TEST_F(CuboidGeometryTest, AtTheAreasEdgeNothingOfTheOtherEdgeHidesASide) {
  const CellIndex last = map_.grid.cellsX() - 1;
  test::addCuboid(map_, last, 0.5, 0.6);
  test::addCuboid(map_, last + 1, 0.5, 0.6);  // the next row's first
  EXPECT_EQ(faces(), 12U);
}

TEST_F(CuboidGeometryTest, HeldCuboidsAreALayerOfTheirOwnAndHideNoLiveOnes) {
  add(0, 0, 0.5, 0.6);
  add(1, 0, 0.5, 0.6);
  map_.cuboids[0].held = true;
  EXPECT_EQ(faces(), 6U + 5U);
  EXPECT_EQ(geometry_.live().count(), 6U);
  EXPECT_EQ(geometry_.held().count(), 5U);
  EXPECT_FALSE(geometry_.live().translucent);
  EXPECT_TRUE(geometry_.held().translucent);
}

TEST_F(CuboidGeometryTest, WhatAllFacesEncloseIsTheCuboidsVolume) {
  test::Random random(7);
  buildOfMany(random);
  double volume = 0.0, expected = 0.0;
  for (std::size_t i = 0; i < corners_.size(); i += CuboidFaces::kCorners) {
    const auto corner = [&](std::size_t k) { return place(corners_[i + k]); };
    const Vector3 area = (corner(2) - corner(0)).cross(corner(3) - corner(1)) / 2.0;
    volume += area.dot(corner(0)) / 3.0;
  }
  for (const Cuboid& cuboid : map_.cuboids) expected += map_.box(cuboid).volume();
  EXPECT_NEAR(volume, expected, 1e-4 * expected);
}

TEST_F(CuboidGeometryTest, FromAPointThoseFacesAreDrawnThatDoNotShowItTheirBacks) {
  test::Random random(8);
  buildOfMany(random);
  const CuboidFaces& faces = geometry_.live();
  for (int k = 0; k < 20; ++k) {
    const Eigen::Vector3f eye(static_cast<float>(random.uniform(-0.2, 0.5)),
                              static_cast<float>(random.uniform(-1.2, -0.5)),
                              static_cast<float>(random.uniform(-0.5, 2.5)));
    for (std::size_t side = 0; side < kSides; ++side) {
      const CuboidFaces::Range range = faces.facing(static_cast<Side>(side), eye);
      for (std::size_t i = 0; i < faces.sides[side].size(); i += CuboidFaces::kCorners) {
        const auto corner = [&](std::size_t n) { return place(faces.sides[side][i + n]); };
        const Vector3 normal = (corner(1) - corner(0)).cross(corner(2) - corner(0));
        const bool drawn =
            i / CuboidFaces::kCorners >= range.begin && i / CuboidFaces::kCorners < range.end;
        const double front = normal.normalized().dot(eye.cast<double>() - corner(0));
        if (front > 1e-6) {
          EXPECT_TRUE(drawn) << side << " " << i;
        } else if (front < -1e-6 && side > 1) {  // tops and bottoms are all drawn, or none
          EXPECT_FALSE(drawn) << side << " " << i;
        }
      }
    }
  }
  EXPECT_EQ(faces.facing(Side::kTop, {0.1F, -0.9F, -1.0F}).end, 0U);
  EXPECT_EQ(faces.facing(Side::kBottom, {0.1F, -0.9F, 3.0F}).end, 0U);
}

TEST_F(CuboidGeometryTest, StaticIsGreenDynamicIsRedAndHeldIsViolet) {
  add(0, 0, 0.5, 0.6);
  map_.cuboids[0].dyn = 3;
  const Rgba fixed = color(CuboidColoring::kDynamic);
  EXPECT_GT(fixed.green, 2 * std::max(fixed.red, fixed.blue));
  map_.cuboids[0].dyn = 2;
  const Rgba moving = color(CuboidColoring::kDynamic);
  EXPECT_GT(moving.red, 2 * std::max(moving.green, moving.blue));
  map_.cuboids[0].held = true;
  const Rgba held = color(CuboidColoring::kDynamic);
  EXPECT_GT(held.blue, held.green);
  EXPECT_LT(held.opacity, 255);
}

TEST_F(CuboidGeometryTest, WhatWasFlaggedIsMagentaOrBlueInVerdictAlone) {
  add(0, 0, 0.5, 0.6);
  const Rgba plain = color(CuboidColoring::kVerdict);
  flagged_ = {{cell(0, 0), 0.55, 0.9, false}};
  EXPECT_EQ(color(CuboidColoring::kVerdict), kBlue);
  flagged_.push_back({cell(0, 0), 0.59, 0.61, true});
  EXPECT_EQ(color(CuboidColoring::kVerdict), kMagenta) << "of both, the graver";
  EXPECT_EQ(color(CuboidColoring::kDynamic), plain);
  flagged_ = {{cell(0, 0), 0.6, 0.7, true}, {cell(1, 0), 0.5, 0.6, true}, {~0U, 0.5, 0.6, true}};
  EXPECT_EQ(color(CuboidColoring::kVerdict), plain) << "other places";
}

TEST_F(CuboidGeometryTest, AgeAndHeightGoFromBlueToRed) {
  add(0, 0, 0.0, 0.01);
  map_.window_scans = 40;
  EXPECT_GT(color(CuboidColoring::kAge).blue, 200);
  EXPECT_GT(color(CuboidColoring::kHeight).blue, 200);
  map_.cuboids[0].age_scans = 120;
  map_.cuboids[0].top = map_.grid.heightOf(1.999);
  EXPECT_GT(color(CuboidColoring::kAge).red, 200);
  EXPECT_LT(color(CuboidColoring::kAge).blue, 50);
  EXPECT_GT(color(CuboidColoring::kHeight).red, 200);
  map_.cuboids[0].age_scans = 60;
  EXPECT_GT(color(CuboidColoring::kAge).green, 200);
}

TEST_F(CuboidGeometryTest, ASensorHasOneColourAndHeldIsToldFromLive) {
  add(0, 0, 0.5, 0.6);
  look_.sensor = {10, 20, 30, 255};
  EXPECT_EQ(color(CuboidColoring::kSensor), look_.sensor);
  const Rgba live = color(CuboidColoring::kHeld);
  map_.cuboids[0].held = true;
  EXPECT_FALSE(live == color(CuboidColoring::kHeld));
}

TEST_F(CuboidGeometryTest, OpacityIsOfAll) {
  add(0, 0, 0.5, 0.6);
  build();
  EXPECT_FALSE(geometry_.live().translucent);
  look_.opacity = 0.5;
  build();
  EXPECT_TRUE(geometry_.live().translucent);
  EXPECT_EQ(corners_.front().color.opacity, 128);
}

TEST_F(CuboidGeometryTest, BuiltAnewNothingOfTheOldMapIsLeft) {
  add(0, 0, 0.5, 0.6);
  build();
  map_ = test::emptyMap();
  EXPECT_EQ(faces(), 0U);
  EXPECT_TRUE(geometry_.live().bounds.isEmpty());
}

}  // namespace
}  // namespace tccm
