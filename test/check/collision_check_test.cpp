#include "check/collision_check.h"

#include <gtest/gtest.h>

#include <set>

#include "geometry/overlap.h"
#include "support/checked_robot.h"
#include "support/cuboid_scene.h"
#include "support/fcl_overlap.h"
#include "support/small_map.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

using test::placedAt;
using test::Random;

CollisionCheck::Config everyContact() {
  CollisionCheck::Config config;
  config.support_points = 1;
  config.contacts_max = 100000;
  return config;
}

/// 20 x 20 cells of 20 mm around the origin.
Grid::Config smallGrid() { return test::smallGrid(0.4, 0.4, 1.0, -0.2); }

Body randomBody(Random& random, std::size_t kind) {
  Body body;
  for (int i = 0; i < 3; ++i) {
    body.shapes.push_back(random.shape(kind));
    Pose pose = Pose::Identity();
    pose.linear() = random.mixedRotation();
    // Some beside the map, some astride its border.
    pose.translation() = random.point(0.35) + Vector3(0.0, 0.0, 0.3);
    body.poses.push_back(pose);
  }
  return body;
}

/// FCL's answers for every cuboid; those that hang on less than its accuracy are left to ours.
std::set<std::uint32_t> touchedByFcl(const CuboidMap& map, const Shape& shape, const Pose& pose,
                                     std::size_t& too_close) {
  constexpr double kTouching = 1e-5;
  const Vector3 by = Vector3::Constant(kTouching);
  std::set<std::uint32_t> touched;
  for (std::uint32_t k = 0; k < map.cuboids.size(); ++k) {
    const UprightBox box = map.box(map.cuboids[k]);
    bool answer = test::overlapsByFcl(shape, pose, box);
    const bool larger = overlaps(shape, pose, {box.min() - by, box.max() + by});
    const bool smaller = overlaps(shape, pose, {box.min() + by, box.max() - by});
    if (larger != smaller) {
      ++too_close;
      answer = overlaps(shape, pose, box);
    }
    if (answer) touched.insert(k);
  }
  return touched;
}

TEST(CollisionCheckTest, FindsWhatFclFindsAmongAllCuboidsForEveryKindOfShape) {
  for (std::size_t kind = 0; kind < test::kShapeKinds; ++kind) {
    Random random(10 + static_cast<unsigned>(kind));
    std::size_t contacts = 0, too_close = 0;
    CollisionCheck check(everyContact());
    for (int scene = 0; scene < 25; ++scene) {
      const CuboidMap map = test::randomMap(random, smallGrid(), 0.5);
      const Body body = randomBody(random, kind);
      const auto found = test::contactsOf(check, map, body);
      for (std::uint32_t i = 0; i < body.shapes.size(); ++i) {
        std::set<std::uint32_t> ours;
        for (const Contact& contact : found) {
          if (contact.shape == i) ours.insert(contact.cuboid);
        }
        EXPECT_EQ(ours, touchedByFcl(map, body.shapes[i], body.poses[i], too_close))
            << name(body.shapes[i]) << " in scene " << scene;
        contacts += ours.size();
      }
    }
    EXPECT_GT(contacts, 100U) << kind;
    EXPECT_LT(too_close, 50U) << kind;
  }
}

TEST(CollisionCheckTest, ContactsComeByShapeThenByCellAndOnlyOnce) {
  Random random(1);
  const CuboidMap map = test::randomMap(random, smallGrid(), 0.8);
  Body body = randomBody(random, 0);
  body.shapes = {Sphere{0.2}, Sphere{0.3}, Sphere{0.25}};
  CollisionCheck check(everyContact());
  const auto found = test::contactsOf(check, map, body);
  ASSERT_GT(found.size(), 50U);
  for (std::size_t i = 0; i + 1 < found.size(); ++i) {
    const bool in_order = found[i].shape != found[i + 1].shape
                              ? found[i].shape < found[i + 1].shape
                              : found[i].cuboid < found[i + 1].cuboid;
    EXPECT_TRUE(in_order) << i;
  }
}

/// One cell's cuboid from 0.3 to 0.4 m, its footprint (0, 0) to (0.02, 0.02).
CuboidMap oneCuboid(std::uint32_t points = 5) {
  CuboidMap map = test::emptyMap(smallGrid());
  test::addCuboid(map, *map.grid.cellOf(Vector3(0.01, 0.01, 0.0)), 0.3, 0.4, points);
  return map;
}

std::size_t contactsOf(const Shape& shape, const Pose& pose, const CuboidMap& map) {
  CollisionCheck check(everyContact());
  return test::contactsOf(check, map, {{shape}, {pose}}).size();
}

TEST(CollisionCheckTest, TouchingBordersCountOnEverySide) {
  constexpr double kRounding = 1e-9, kRadius = 0.05;
  const CuboidMap map = oneCuboid();
  const Vector3 centre(0.01, 0.01, 0.35), half(0.01, 0.01, 0.05);
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      const auto ball = [&](double gap) {
        Vector3 place = centre;
        place[axis] += side * (half[axis] + kRadius + gap);
        return placedAt(place.x(), place.y(), place.z());
      };
      EXPECT_EQ(contactsOf(Sphere{kRadius}, ball(-kRounding), map), 1U) << axis << " " << side;
      EXPECT_EQ(contactsOf(Sphere{kRadius}, ball(kRounding), map), 0U) << axis << " " << side;
    }
  }
}

TEST(CollisionCheckTest, ABoxThatEndsExactlyOnACellsBorderTouchesTheCellBeyond) {
  Grid::Config grid = smallGrid();
  grid.origin_x_m = grid.origin_y_m = 0.0;
  grid.cell_size_m = 0.25;
  grid.size_x_m = grid.size_y_m = 1.0;
  CuboidMap map = test::emptyMap(grid);
  for (CellIndex cell = 0; cell < map.grid.cells(); ++cell) test::addCuboid(map, cell, 0.0, 0.5);
  EXPECT_EQ(contactsOf(Box{{0.125, 0.125, 0.1}}, placedAt(0.375, 0.375, 0.25), map), 9U);
  EXPECT_EQ(contactsOf(Box{{0.124, 0.124, 0.1}}, placedAt(0.375, 0.375, 0.25), map), 1U);
}

TEST(CollisionCheckTest, BesideAndAboveTheMapThereIsNothing) {
  const CuboidMap map = oneCuboid();
  for (const double far : {-50.0, -0.5, 0.6, 50.0}) {
    EXPECT_EQ(contactsOf(Sphere{0.1}, placedAt(far, 0.01, 0.35), map), 0U);
    EXPECT_EQ(contactsOf(Sphere{0.1}, placedAt(0.01, far, 0.35), map), 0U);
    EXPECT_EQ(contactsOf(Sphere{0.1}, placedAt(0.01, 0.01, far), map), 0U);
  }
}

TEST(CollisionCheckTest, AShapeLargerThanTheWholeMapTouchesAllOfIt) {
  Random random(3);
  const CuboidMap map = test::randomMap(random, smallGrid(), 0.5);
  EXPECT_EQ(contactsOf(Sphere{5.0}, placedAt(0.0, 0.0, 0.0), map), map.cuboids.size());
}

TEST(CollisionCheckTest, AnEmptyMapAndAnEmptyBodyHaveNoContacts) {
  CollisionCheck check(everyContact());
  EXPECT_TRUE(
      test::contactsOf(check, test::emptyMap(), {{Sphere{1.0}}, {Pose::Identity()}}).empty());
  EXPECT_TRUE(test::contactsOf(check, oneCuboid(), {}).empty());
}

bool isSupported(const CuboidMap& map, const CollisionCheck::Config& config) {
  CollisionCheck check(config);
  return !test::contactsOf(check, map, {{Sphere{0.05}}, {placedAt(0.01, 0.01, 0.35)}}).empty();
}

TEST(CollisionCheckTest, TwoPointsAreNoObstacleAndThreeAre) {
  EXPECT_FALSE(isSupported(oneCuboid(2), {}));
  EXPECT_TRUE(isSupported(oneCuboid(3), {}));
  EXPECT_TRUE(isSupported(oneCuboid(1), everyContact()));
}

TEST(CollisionCheckTest, PointsInTheEightCellsAroundSupportAndFurtherOnesDoNot) {
  for (int dx = -2; dx <= 2; ++dx) {
    for (int dy = -2; dy <= 2; ++dy) {
      if (dx == 0 && dy == 0) continue;
      CuboidMap map = oneCuboid(1);
      const Vector3 beside(0.01 + 0.02 * dx, 0.01 + 0.02 * dy, 0.0);
      test::addCuboid(map, *map.grid.cellOf(beside), 0.35, 0.37, 2);
      CollisionCheck check{CollisionCheck::Config{}};
      const auto found =
          test::contactsOf(check, map, {{Sphere{0.001}}, {placedAt(0.01, 0.01, 0.35)}});
      EXPECT_EQ(found.size(), std::abs(dx) <= 1 && std::abs(dy) <= 1 ? 1U : 0U) << dx << " " << dy;
    }
  }
}

TEST(CollisionCheckTest, PointsFurtherThanTheSupportHeightDoNotSupport) {
  for (const auto& [bottom, supported] : {std::pair{0.430, true}, std::pair{0.431, false}}) {
    CuboidMap map = oneCuboid(1);
    test::addCuboid(map, map.cuboids[0].cell, bottom, bottom + 0.05, 2);
    CollisionCheck check{CollisionCheck::Config{}};
    const auto found =
        test::contactsOf(check, map, {{Sphere{0.001}}, {placedAt(0.01, 0.01, 0.35)}});
    EXPECT_EQ(found.size(), supported ? 1U : 0U) << bottom;
  }
}

/// Written down anew: heights in quanta, cells by their distance.
bool isSupportedByBruteForce(const CuboidMap& map, const Cuboid& cuboid, int reach, int points) {
  const auto column = [&](const Cuboid& c) { return static_cast<int>(c.cell % map.grid.cellsX()); };
  const auto row = [&](const Cuboid& c) { return static_cast<int>(c.cell / map.grid.cellsX()); };
  int found = 0;
  for (const Cuboid& other : map.cuboids) {
    if (std::abs(column(other) - column(cuboid)) > 1) continue;
    if (std::abs(row(other) - row(cuboid)) > 1) continue;
    const int gap = std::max(other.bottom - cuboid.top, cuboid.bottom - other.top);
    if (gap <= reach) found += static_cast<int>(other.points);
  }
  return found >= points;
}

TEST(CollisionCheckTest, TheSupportRuleIsThatOfABruteForceOverAllCuboids) {
  Random random(5);
  std::size_t kept = 0, left_out = 0;
  for (int scene = 0; scene < 60; ++scene) {
    const CuboidMap map = test::randomMap(random, smallGrid(), random.uniform(0.05, 0.4));
    const Body body = randomBody(random, static_cast<std::size_t>(scene) % test::kShapeKinds);
    CollisionCheck::Config config = everyContact();
    CollisionCheck every(config);
    config.support_points = random.integer(2, 8);
    CollisionCheck supported(config);
    std::set<std::pair<std::uint32_t, std::uint32_t>> expected, found;
    for (const Contact& contact : test::contactsOf(every, map, body)) {
      if (isSupportedByBruteForce(map, map.cuboids[contact.cuboid], 30, config.support_points)) {
        expected.emplace(contact.shape, contact.cuboid);
      } else {
        ++left_out;
      }
    }
    for (const Contact& contact : test::contactsOf(supported, map, body)) {
      found.emplace(contact.shape, contact.cuboid);
    }
    EXPECT_EQ(found, expected) << scene;
    kept += found.size();
  }
  EXPECT_GT(kept, 100U);
  EXPECT_GT(left_out, 100U);
}

TEST(CollisionCheckTest, NoMoreContactsAreListedThanAsked) {
  CollisionCheck::Config config = everyContact();
  config.contacts_max = 7;
  CollisionCheck check(config);
  Random random(2);
  const CuboidMap map = test::randomMap(random, smallGrid(), 0.9);
  const Body body{{Sphere{0.2}, Sphere{0.2}}, {placedAt(0, 0, 0.3), placedAt(0, 0, 0.3)}};
  EXPECT_EQ(test::contactsOf(check, map, body).size(), 7U);
  EXPECT_EQ(test::contactsOf(check, map, {}).size(), 0U) << "the list starts anew";
}

TEST(CollisionCheckTest, ValuesOutOfRangeAreRefused) {
  CollisionCheck::Config config;
  config.support_points = 0;
  EXPECT_THROW(CollisionCheck{config}, ConfigError);
  config = {};
  config.support_height_m = -0.01;
  EXPECT_THROW(CollisionCheck{config}, ConfigError);
  config = {};
  config.contacts_max = 0;
  EXPECT_THROW(CollisionCheck{config}, ConfigError);
}

}  // namespace
}  // namespace tccm
