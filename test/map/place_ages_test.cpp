// For how long cuboids have been where they are, as a laser sees them that tilts over a table.
#include "map/place_ages.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include "geometry/ray.h"
#include "map/mapper.h"

namespace tccm {
namespace {

constexpr int kStroke = 20;           // scans
constexpr int kPeriod = 2 * kStroke;  // scans, as the window
constexpr double kTableTop = 0.5;     // [m]
const Vector3 kSensor(0.0, 0.0, 1.2);

struct Thing {
  Box box;
  Vector3 centre;
};
const Thing kBlock{Box{{0.05, 0.05, 0.06}}, {0.7, 0.0, kTableTop + 0.06}};
/// Halfway between the sensor and where the block stands.
const Thing kBoard{Box{{0.06, 0.06, 0.002}}, {0.35, 0.0, 0.88}};

Mapper::Config mapperConfig() {
  Mapper::Config config;
  config.map.grid.origin_x_m = 0.5;
  config.map.grid.origin_y_m = -0.2;
  config.map.grid.size_x_m = config.map.grid.size_y_m = 0.4;
  config.map.grid.height_max_m = 1.0;
  config.window_scans = kPeriod;
  return config;
}

/// A map of a table, and of what stands on it, from a laser that goes over it once in a stroke.
class Table {
 public:
  std::vector<Thing> things;
  /// Whether what a beam ends on is measured; all is where there is no such function.
  std::function<bool(const Vector3&)> isMeasured;

  explicit Table(const Mapper::Config& config = mapperConfig()) : mapper_(config) {}

  void watch(int windows) {
    for (int i = 0; i < windows * kPeriod; ++i) scan();
  }
  void scan() {
    if (scans_ > 0) ages_.follow(mapper_.map(), mapper_.looks());
    const int phase = scans_ % kPeriod;
    const double part = phase < kStroke ? phase + 0.5 : kPeriod - phase - 0.5;
    const Eigen::AngleAxisd down(M_PI / 180.0 * (34.0 + 24.0 * part / kStroke), Vector3::UnitY());
    ScanReturns scan;
    scan.stamp = Time(fromSeconds(0.025 * ++scans_));
    scan.viewpoint = kSensor;
    for (int i = -50; i <= 50; ++i) {
      const double angle = M_PI / 180.0 * 0.4 * i;
      const Vector3 end = hit({kSensor, down * Vector3(std::cos(angle), std::sin(angle), 0.0)});
      if (isMeasured && !isMeasured(end)) continue;
      scan.looks.push_back({kSensor, end});
      scan.points.push_back(end);
    }
    EXPECT_EQ(mapper_.add(scan).dropped, "");
  }
  const CuboidMap& map() {
    mapper_.snapshot(map_);
    mapper_.apply(ages_, map_);
    return map_;
  }
  /// The dyn of the live cuboids that fulfil a condition on their box.
  std::vector<std::uint32_t> dyn(const std::function<bool(const UprightBox&)>& isMeant) {
    std::vector<std::uint32_t> dyn;
    for (const Cuboid& cuboid : map().cuboids) {
      if (!cuboid.held && isMeant(map_.box(cuboid))) dyn.push_back(cuboid.dyn);
    }
    return dyn;
  }
  Mapper& mapper() { return mapper_; }

 private:
  Vector3 hit(const Ray& ray) {
    double range = (kTableTop - ray.origin.z()) / ray.direction.z();
    for (const Thing& thing : things) {
      const auto span = intersect(thing.box, {ray.origin - thing.centre, ray.direction});
      if (span) range = std::min(range, span->enter);
    }
    return ray.at(range + noise_(engine_));
  }

  Mapper mapper_;
  PlaceAges ages_{mapper_.map()};
  CuboidMap map_;
  int scans_ = 0;
  std::mt19937 engine_{7};
  std::normal_distribution<double> noise_{0.0, 0.003};
};

bool isAnything(const UprightBox&) { return true; }
bool isTable(const UprightBox& box) { return box.max().z() < kTableTop + 0.015; }
/// In the cells before the block, or under its near side: of the table or the block's lowest part.
bool isNearSide(const UprightBox& box) {
  return std::abs(box.center().x() - 0.65) < 0.015 && std::abs(box.center().y()) < 0.045;
}
bool isBlock(const UprightBox& box) { return box.min().z() > kTableTop + 0.03; }
bool isBelowBlock(const UprightBox& box) {
  const Vector3 offset = box.center() - kBlock.centre;
  return std::max(std::abs(offset.x()), std::abs(offset.y())) < 0.035;
}

std::size_t countFrom(std::uint32_t least, const std::vector<std::uint32_t>& dyn) {
  return static_cast<std::size_t>(
      std::count_if(dyn.begin(), dyn.end(), [=](std::uint32_t d) { return d >= least; }));
}

double shareFrom(std::uint32_t least, const std::vector<std::uint32_t>& dyn) {
  return static_cast<double>(countFrom(least, dyn)) / static_cast<double>(dyn.size());
}

TEST(PlaceAgesTest, WhatStandsIsOlderByOneWithEachWindow) {
  Table table;
  table.things = {kBlock};
  for (int windows = 1; windows <= 9; windows += 4) {
    table.watch(windows == 1 ? 1 : 4);
    const auto dyn = table.dyn(isAnything);
    ASSERT_GT(dyn.size(), 200U);
    EXPECT_EQ(countFrom(static_cast<std::uint32_t>(windows) + 1, dyn), 0U);
    if (windows == 1) continue;
    EXPECT_GT(shareFrom(static_cast<std::uint32_t>(windows) - 1, dyn), 0.95);
  }
}

TEST(PlaceAgesTest, WhatScansMissInMostWindowsAgesAsTheRest) {
  Table table;
  int window = 0;
  table.isMeasured = [&window](const Vector3& end) { return window % 3 == 0 || end.y() < 0.0; };
  for (; window <= 9; ++window) table.watch(1);
  const auto dyn = table.dyn([](const UprightBox& box) { return box.min().y() > 0.02; });
  ASSERT_GT(dyn.size(), 80U);
  EXPECT_GT(shareFrom(8, dyn), 0.9);
}

TEST(PlaceAgesTest, WhatIsHiddenIsAsOldAsIfItWereSeen) {
  Table table;
  table.watch(6);
  table.things = {kBoard};
  table.watch(4);
  ASSERT_LT(table.dyn(isBelowBlock).size(), 3U) << "the board hides too little";
  table.things.clear();
  table.watch(1);
  const auto dyn = table.dyn(isBelowBlock);
  ASSERT_GT(dyn.size(), 9U);
  EXPECT_GT(shareFrom(9, dyn), 0.8);
}

TEST(PlaceAgesTest, WhatWasLookedThroughIsNewWhenSomethingIsThereAgain) {
  Table table;
  table.things = {kBlock};
  table.watch(6);
  const auto before = table.dyn(isBlock);
  ASSERT_GT(before.size(), 10U);
  EXPECT_GT(shareFrom(4, before), 0.9);
  table.things.clear();
  table.watch(2);
  table.things = {kBlock};
  table.watch(2);
  const auto after = table.dyn(isBlock);
  ASSERT_GT(after.size(), 10U);
  EXPECT_EQ(countFrom(3, after), 0U);
}

TEST(PlaceAgesTest, OfAThingPutOnATableTheLowestPartIsAsNewAsTheThing) {
  Table table;
  table.watch(8);
  ASSERT_GT(countFrom(6, table.dyn(isNearSide)), 0U);
  table.things = {kBlock};
  table.watch(2);
  const auto after = table.dyn(isNearSide);
  ASSERT_GT(after.size(), 5U);
  EXPECT_EQ(countFrom(3, after), 0U);
  // The table around it is not.
  const auto rest = table.dyn([](const UprightBox& box) {
    return isTable(box) && (box.center() - kBlock.centre).head<2>().lpNorm<Eigen::Infinity>() > 0.1;
  });
  ASSERT_GT(rest.size(), 80U);
  EXPECT_GT(shareFrom(8, rest), 0.95);
}

TEST(PlaceAgesTest, WhatComesOverATableAndDoesNotTouchItMakesItNoNewer) {
  Table table;
  table.watch(8);
  const Thing shelf{Box{{0.08, 0.15, 0.002}}, {0.7, 0.0, kTableTop + 0.08}};
  table.things = {shelf};
  table.watch(2);
  // Seen before its near edge and beside it, in the cells under the shelf and next to them.
  const auto beside = table.dyn([&shelf](const UprightBox& box) {
    const Vector3 offset = (box.center() - shelf.centre).cwiseAbs() - shelf.box.half_extents;
    return isTable(box) && std::abs(std::max(offset.x(), offset.y())) < 0.015;
  });
  ASSERT_GT(beside.size(), 5U);
  EXPECT_GT(shareFrom(8, beside), 0.9);
  EXPECT_EQ(countFrom(3, table.dyn([](const UprightBox& box) {
              return box.min().z() > kTableTop + 0.045;
            })),
            0U);
}

TEST(PlaceAgesTest, WhatIsOlderThanCanBeToldIsToldToBeTheOldest) {
  Table table;
  table.watch(PlaceAges::kWindowsMax + 5);
  const auto dyn = table.dyn(isTable);
  ASSERT_GT(dyn.size(), 200U);
  EXPECT_GT(shareFrom(PlaceAges::kWindowsMax, dyn), 0.95);
  EXPECT_EQ(countFrom(PlaceAges::kWindowsMax + 1, dyn), 0U);
}

TEST(PlaceAgesTest, AMapThatIsClearedKnowsNothing) {
  Table table;
  table.watch(6);
  table.mapper().clear();
  table.watch(1);
  EXPECT_EQ(countFrom(2, table.dyn(isAnything)), 0U);
}

TEST(PlaceAgesTest, ThinReturnsAgeAsThickOnes) {
  Mapper::Config thin = mapperConfig();
  thin.map.thickness_m = 0.008;
  Table table(thin);
  table.things = {kBlock};
  table.watch(6);
  const auto dyn = table.dyn(isAnything);
  ASSERT_GT(dyn.size(), 200U);
  EXPECT_GT(shareFrom(5, dyn), 0.95);
  EXPECT_EQ(countFrom(7, dyn), 0U);
}

}  // namespace
}  // namespace tccm
