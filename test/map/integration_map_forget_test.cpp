/// What IntegrationMap::forget() takes out and what it leaves: scenes whose answer fits on paper,
/// and random streams against a list of returns that is filtered and united anew.

#include <gtest/gtest.h>

#include <limits>

#include "map/integration_map.h"
#include "support/part_union.h"
#include "support/small_map.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

using test::atScan;
using test::snapshotOf;
using Runs = std::vector<test::Run>;
using Points = std::vector<Vector3>;

/// Half a cell's diagonal: 71 mm, or 1.4 mm where cells are of 2 mm.
IntegrationMap::Config smallConfig(double cell_size_m = 0.1) { return test::sixCells(cell_size_m); }

PaddedShape ball(double radius, const Vector3& centre, double padding_m = 0.0) {
  return {{Sphere{radius}, Pose(Eigen::Translation3d(centre))}, padding_m};
}

Region everything() { return {{{Box{{5.0, 5.0, 5.0}}, Pose::Identity()}, 0.0}}; }

Runs runsIn(IntegrationMap& map) { return test::runsOf(snapshotOf(map)); }

Vector3 atHeight(double z) { return {0.05, 0.05, z}; }

TEST(ForgetTest, ReturnsWithinPaddingAndHalfACellsDiagonalOfTheShapeLeaveAtOnce) {
  for (const double padding : {0.0, 0.02}) {
    IntegrationMap map(smallConfig());
    map.add(atScan(0), {atHeight(0.5), atHeight(0.62), atHeight(0.63), {0.25, 0.05, 0.5}});
    EXPECT_EQ(map.forget({ball(0.05, atHeight(0.5), padding)}, atScan(0)), padding > 0.0 ? 3U : 2U);
    EXPECT_EQ(runsIn(map), padding > 0.0 ? (Runs{{2, 480, 500, 1}})
                                         : (Runs{{0, 610, 630, 1}, {2, 480, 500, 1}}));
  }
}

TEST(ForgetTest, AReturnInACellsCornerLeavesThoughTheCellsCentreIsOutside) {
  IntegrationMap map(smallConfig());
  map.add(atScan(0), {{0.0001, 0.0001, 0.5}});
  EXPECT_EQ(map.forget({ball(0.001, {0.0, 0.0, 0.5})}, atScan(0)), 1U);
  EXPECT_TRUE(runsIn(map).empty());
}

TEST(ForgetTest, WhatOlderScansSawBelowTheForgottenComesToLightAndExpiresWithThem) {
  IntegrationMap map(smallConfig(0.002));
  const Vector3 table(0.001, 0.001, 0.500), object(0.001, 0.001, 0.510);
  map.add(atScan(0), {table});
  map.add(atScan(1), {object});
  EXPECT_EQ(runsIn(map), (Runs{{0, 480, 510, 2}}));
  EXPECT_EQ(map.forget({ball(0.001, object)}, atScan(1)), 1U);
  EXPECT_EQ(runsIn(map), (Runs{{0, 480, 500, 1}}));
  EXPECT_EQ(map.scans(), 2U);
  map.expireOldest();
  EXPECT_TRUE(runsIn(map).empty());
  map.expireOldest();
  EXPECT_EQ(map.scans(), 0U);
}

TEST(ForgetTest, WhatNewerScansSawStaysTheirsWhenOlderReturnsAreForgotten) {
  IntegrationMap map(smallConfig(0.002));
  const Vector3 object(0.001, 0.001, 0.510), table(0.001, 0.001, 0.500);
  map.add(atScan(0), {object});
  map.add(atScan(1), {table});
  EXPECT_EQ(map.forget({ball(0.001, object)}, atScan(1)), 1U);
  map.expireOldest();
  EXPECT_EQ(runsIn(map), (Runs{{0, 480, 500, 1}}));
}

TEST(ForgetTest, WhatRemainsKeepsItsAgeAndWhatComesToAnEmptiedPlaceIsNew) {
  IntegrationMap map(smallConfig(0.002));
  const Vector3 table(0.001, 0.001, 0.500), object(0.001, 0.001, 0.530);
  for (int i = 0; i < 10; ++i) {
    map.add(atScan(i), i < 4 ? Points{table} : Points{table, object});
    if (map.scans() > 3) map.expireOldest();
  }
  EXPECT_EQ(map.forget({ball(0.001, object)}, atScan(9)), 3U);
  ASSERT_EQ(runsIn(map), (Runs{{0, 480, 500, 3}}));
  EXPECT_EQ(snapshotOf(map).cuboids[0].age_scans, 9U);
  map.add(atScan(10), {object});
  ASSERT_EQ(runsIn(map), (Runs{{0, 480, 500, 3}, {0, 510, 530, 1}}));
  EXPECT_EQ(snapshotOf(map).cuboids[0].age_scans, 10U);
  EXPECT_EQ(snapshotOf(map).cuboids[1].age_scans, 0U);
}

TEST(ForgetTest, ReturnsOfLaterScansAreJudgedByTheirPlaceAndCountAgainAfterUntil) {
  IntegrationMap map(smallConfig());
  const Points points = {{0.05, 0.05, 0.5}, {0.07, 0.05, 0.5}, {0.9, 0.05, 0.5}};
  EXPECT_EQ(map.forget({ball(0.005, atHeight(0.5), 0.005)}, atScan(2)), 0U);
  for (int i = 0; i < 4; ++i) {
    const auto added = map.add(atScan(i), points);
    EXPECT_EQ(added.forgotten, i <= 2 ? 1U : 0U);
    EXPECT_EQ(added.mapped, i <= 2 ? 1U : 2U);
    EXPECT_EQ(added.out_of_area, 1U);
  }
  EXPECT_EQ(runsIn(map), (Runs{{0, 480, 500, 5}}));
}

TEST(ForgetTest, ARegionOfEverythingEmptiesTheMapAndLeavesTheWindowItsScans) {
  IntegrationMap map(smallConfig());
  for (int i = 0; i < 5; ++i) map.add(atScan(i), {atHeight(0.5), atHeight(0.1), {0.25, 0.15, 0.0}});
  EXPECT_EQ(map.forget(everything(), atScan(4)), 15U);
  EXPECT_TRUE(runsIn(map).empty());
  EXPECT_EQ(map.scans(), 5U);
  EXPECT_EQ(map.serial(), 5U);
  EXPECT_EQ(map.oldestStamp(), atScan(0));
  map.add(atScan(5), {atHeight(0.5)});
  EXPECT_EQ(runsIn(map), (Runs{{0, 480, 500, 1}}));
  while (map.scans() > 0) map.expireOldest();
  EXPECT_TRUE(runsIn(map).empty());
}

TEST(ForgetTest, AnEmptyListOrAPlaceOutsideTheAreaTakesNothing) {
  IntegrationMap map(smallConfig());
  EXPECT_EQ(map.forget(everything(), atScan(-1)), 0U) << "no scan yet";
  map.add(atScan(0), {atHeight(0.5)});
  EXPECT_EQ(map.forget({}, atScan(0)), 0U);
  for (const Vector3& far :
       {Vector3(-9.0, 0.05, 0.5), Vector3(9.0, 0.05, 0.5), Vector3(0.05, -9.0, 0.5),
        Vector3(0.05, 9.0, 0.5), Vector3(0.05, 0.05, 9.0), Vector3(9e5, -9e5, 9e5)}) {
    EXPECT_EQ(map.forget({ball(0.1, far)}, atScan(0)), 0U);
  }
  EXPECT_EQ(runsIn(map), (Runs{{0, 480, 500, 1}}));
}

TEST(ForgetTest, ARegionThatIsNotValidIsRefusedAndChangesNothing) {
  IntegrationMap map(smallConfig());
  map.add(atScan(0), {atHeight(0.5)});
  Region region = {ball(0.1, atHeight(0.5)), ball(0.1, atHeight(0.5))};
  region[1].padding_m = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(map.forget(region, atScan(5)), ConfigError);
  EXPECT_EQ(map.add(atScan(1), {atHeight(0.5)}).mapped, 1U);
  EXPECT_EQ(runsIn(map), (Runs{{0, 480, 500, 2}}));
}

TEST(ForgetTest, ClearingEndsWhatIsForgotten) {
  IntegrationMap map(smallConfig());
  map.forget(everything(), atScan(5));
  map.clear();
  EXPECT_EQ(map.add(atScan(1), {atHeight(0.5)}).mapped, 1U);
}

TEST(ForgetTest, AnOverflowedMapStaysOverflowedUntilThatScanLeaves) {
  IntegrationMap::Config config = smallConfig();
  config.returns_max = 3;
  IntegrationMap map(config);
  map.add(atScan(0), {atHeight(0.1)});
  map.add(atScan(1), {atHeight(0.2), atHeight(0.5), atHeight(0.8)});
  ASSERT_TRUE(map.overflowed());
  EXPECT_EQ(map.forget({ball(0.01, atHeight(0.5))}, atScan(1)), 1U);
  EXPECT_TRUE(map.overflowed());
  EXPECT_EQ(runsIn(map), (Runs{{0, 80, 100, 1}, {0, 180, 200, 1}}));
  EXPECT_EQ(map.add(atScan(2), {atHeight(0.9)}).mapped, 1U) << "there is room again";
  EXPECT_EQ(map.forget(everything(), atScan(2)), 3U);
  map.expireOldest();
  EXPECT_TRUE(map.overflowed());
  map.expireOldest();
  EXPECT_FALSE(map.overflowed());
}

/// Scan 1 sees [480, 500) and [520, 540), scan 2 all of [470, 550) as one interval. Forgetting scan
/// 2's returns leaves more intervals than there were.
TEST(ForgetTest, WherePoolRunsOutMoreStaysAndTheMapIsOverflowed) {
  IntegrationMap::Config config = smallConfig(0.002);
  config.intervals_max = 5;
  IntegrationMap map(config);
  const auto at = [](double z) { return Vector3(0.001, 0.001, z); };
  const Points cover = {at(0.490), at(0.510), at(0.530), at(0.550)};
  map.add(atScan(0), {at(0.500), at(0.540)});
  map.add(atScan(1), cover);
  map.add(atScan(2), {{0.005, 0.001, 0.1}, {0.005, 0.001, 0.2}, {0.005, 0.001, 0.3}});
  ASSERT_FALSE(map.overflowed());
  Region region;
  for (const Vector3& p : cover) region.push_back(ball(0.001, p));
  EXPECT_EQ(map.forget(region, atScan(2)), 4U);
  EXPECT_TRUE(map.overflowed());
  const Runs runs = runsIn(map);
  ASSERT_FALSE(runs.empty());
  EXPECT_LE(runs.front().bottom, 480);
  EXPECT_GE(runs.front().top, 540) << "what remains is in the map in any case";
  while (map.scans() > 0) map.expireOldest();
  EXPECT_FALSE(map.overflowed());
  EXPECT_TRUE(runsIn(map).empty());
  map.add(atScan(3), {at(0.1), at(0.2), at(0.3), at(0.4)});
  EXPECT_FALSE(map.overflowed()) << "all intervals are free again";
}

}  // namespace
}  // namespace tccm
