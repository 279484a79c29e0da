#include "sight/look_map.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

using Kind = LookImage::Sight::Kind;

Time at(double seconds) { return Time(fromSeconds(seconds)); }

const Vector3 kViewpoint(0.2, -0.1, 1.4);

Vector3 direction(double azimuth, double elevation) {
  return {std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
          std::sin(elevation)};
}

Look look(double azimuth, double elevation, double range, Seen what = Seen::kSurface,
          const Vector3& viewpoint = kViewpoint) {
  return {viewpoint, viewpoint + range * direction(azimuth, elevation), what};
}

const LookImage::Passes& passesAt(const LookMap& map, double azimuth, double elevation) {
  return map.image().passes(map.image().grid().pixelOf(direction(azimuth, elevation)));
}

TEST(LookMapTest, ALookSpeaksForTheDirectionsAroundIt) {
  LookMap map({});
  map.add(at(10.0), {look(0.3, -0.5, 1.2)});
  const DirectionGrid& grid = map.image().grid();
  std::size_t pixels = 0;
  for (int row = 0; row < grid.rows(); ++row) {
    for (int column = 0; column < grid.columns(); ++column) {
      const double angle =
          std::acos(std::min(1.0, grid.middle(row, column).dot(direction(0.3, -0.5))));
      const bool looked = map.image().passes(grid.index(row, column))[0].end != Seen::kNever;
      ASSERT_EQ(looked, angle <= 0.03) << row << " " << column << " " << angle;
      pixels += looked ? 1 : 0;
    }
  }
  EXPECT_GE(pixels, 2U);
  EXPECT_NEAR(passesAt(map, 0.3, -0.5)[0].range(), 1.2, 0.0011);
}

TEST(LookMapTest, EachCloudIsAPassHoweverShortlyItFollows) {
  LookMap map({});
  for (const double t : {10.0, 10.033, 10.066}) map.add(at(t), {look(0.3, -0.5, 1.2)}, true);
  const LookImage::Passes passes = passesAt(map, 0.3, -0.5);
  EXPECT_EQ(map.image().timeOf(passes[0].first), at(10.066));
  EXPECT_EQ(map.image().timeOf(passes[1].first), at(10.033));
  map.add(at(10.1), {look(0.3, -0.5, 1.2)});  // a scan is not
  EXPECT_EQ(map.image().timeOf(passesAt(map, 0.3, -0.5)[0].first), at(10.066));
}

TEST(LookMapTest, OfOneScanTheLookNearestToTheMiddleCounts) {
  LookMap map({});
  const DirectionGrid& grid = map.image().grid();
  const Vector3 middle = grid.middle(40, 100);
  const double azimuth = std::atan2(middle.y(), middle.x()), elevation = std::asin(middle.z());
  for (const bool near_first : {true, false}) {
    map.clear();
    const Look near = look(azimuth, elevation + 0.002, 0.6),
               far = look(azimuth, elevation + 0.02, 2.0);
    map.add(at(1.0), near_first ? std::vector<Look>{near, far} : std::vector<Look>{far, near});
    EXPECT_NEAR(map.image().passes(grid.index(40, 100))[0].range(), 0.6, 0.0011);
  }
}

TEST(LookMapTest, LooksThatFollowOneAnotherAreOnePass) {
  LookMap map({});
  for (int i = 0; i < 10; ++i) map.add(at(1.0 + 0.03 * i), {look(0.0, 0.0, 1.0)});
  for (int i = 0; i < 10; ++i) map.add(at(2.0 + 0.03 * i), {look(0.0, 0.0, 1.0)});
  const auto& passes = passesAt(map, 0.0, 0.0);
  EXPECT_EQ(passes[0].first, 1000U);
  EXPECT_EQ(passes[0].last, 1270U);
  EXPECT_EQ(passes[1].first, 0U);
  EXPECT_EQ(passes[1].last, 270U);
  map.add(at(3.0), {look(0.0, 0.0, 1.0)});
  EXPECT_EQ(passes[1].first, 1000U) << "the oldest is forgotten";
}

TEST(LookMapTest, TheBestLookOfALongPassIsNotOneOfLongAgo) {
  LookMap map({});
  const DirectionGrid& grid = map.image().grid();
  const Vector3 middle = grid.middle(45, 90);
  const double azimuth = std::atan2(middle.y(), middle.x()), elevation = std::asin(middle.z());
  map.add(at(1.0), {look(azimuth, elevation, 2.0)});
  for (int i = 1; i <= 20; ++i) map.add(at(1.0 + 0.05 * i), {look(azimuth, elevation + 0.01, 0.5)});
  const auto& pass = map.image().passes(grid.index(45, 90))[0];
  EXPECT_EQ(pass.first, 0U);
  EXPECT_NEAR(pass.range(), 0.5, 0.0011);
}

TEST(LookMapTest, LooksEndOnSurfacesOnTheRobotAndOnNothing) {
  LookMap map({});
  map.add(at(1.0), {look(0.0, 0.0, 1.0), look(1.0, 0.0, 4.0, Seen::kNothing),
                    look(2.0, 0.0, 0.4, Seen::kRobot)});
  EXPECT_EQ(passesAt(map, 0.0, 0.0)[0].end, Seen::kSurface);
  EXPECT_EQ(passesAt(map, 1.0, 0.0)[0].end, Seen::kNothing);
  EXPECT_EQ(passesAt(map, 2.0, 0.0)[0].end, Seen::kRobot);
}

TEST(LookMapTest, ASensorThatSwingsAboutItsMeanKeepsItsDirections) {
  LookMap map({});
  for (int i = 0; i < 500; ++i) {
    const double tilt = std::sin(0.11 * i);
    map.add(at(0.03 * i), {look(0.0, -0.5 + 0.4 * tilt, 1.0, Seen::kSurface,
                                kViewpoint + Vector3(0.008 * tilt, 0.0, 0.0))});
  }
  EXPECT_LT((map.image().viewpoint() - kViewpoint).norm(), 0.012);
}

TEST(LookMapTest, WhereTheSensorMovesWhatItSawIsFoundFromThere) {
  LookMap map({});
  const Vector3 surface = kViewpoint + 1.5 * direction(0.4, -0.6);
  map.add(at(1.0), {{kViewpoint, surface, Seen::kSurface}});
  const Vector3 moved = kViewpoint + Vector3(0.3, 0.2, 0.1);
  map.add(at(1.05), {look(2.5, 0.0, 1.0, Seen::kSurface, moved)});
  EXPECT_EQ(map.image().viewpoint(), moved);
  const Vector3 before = moved + 0.9 * (surface - moved);
  EXPECT_EQ(map.image().at(before, 0.0).kind, Kind::kSeen);
  EXPECT_EQ(map.image().at(before, 0.0).stamp, at(1.0));
  EXPECT_EQ(map.image().at(moved + 1.2 * (surface - moved), 0.0).kind, Kind::kBehind);
}

TEST(LookMapTest, WhereTheHeadHasTurnedTheSensorLooksNoMoreButHasLooked) {
  // A place is lost to a head that turns away; to a robot that drives on it was never the sensor's.
  const Vector3 surface = kViewpoint + 1.5 * direction(0.4, -0.6);
  for (const double way : {0.12, 0.2, 0.35, 1.0}) {
    LookMap map({});
    for (const double stamp : {1.0, 2.0}) {
      map.add(at(stamp), {{kViewpoint, surface, Seen::kSurface}});
    }
    for (int i = 1; i <= 40; ++i) {
      const Vector3 place = kViewpoint + Vector3(0.0, std::min(way, 0.04 * i), 0.0);
      map.add(at(2.0 + 0.03 * i), {look(2.5, 0.0, 1.0, Seen::kSurface, place)});
    }
    const auto looked = map.image().at(surface, 0.05).looked;
    ASSERT_EQ(looked.has_value(), way < 0.25) << way;
    EXPECT_EQ(looked.value_or(at(2.0)), at(2.0));
    EXPECT_EQ(map.image().at(surface, 0.05).kind, Kind::kSeen) << way;
  }
}

TEST(LookMapTest, MovingThereAndBackManyTimesSpreadsNothing) {
  LookMap map({});
  const Vector3 surface = kViewpoint + 1.5 * direction(0.4, -0.6);
  map.add(at(1.0), {{kViewpoint, surface, Seen::kSurface}});
  const auto pixels = [&map] {
    int count = 0;
    for (std::size_t p = 0; p < map.image().grid().pixels(); ++p) {
      const auto& pass = map.image().passes(p)[0];
      count += pass.end != Seen::kNever && pass.range() > 1.0 ? 1 : 0;
    }
    return count;
  };
  const int before = pixels();
  for (int i = 0; i < 40; ++i) {
    const Vector3 place = kViewpoint + Vector3(0.0, i % 2 == 0 ? 0.1 : 0.0, 0.0);
    map.add(at(1.0 + 0.01 * i), {look(2.5, 0.0, 0.5, Seen::kSurface, place)});
  }
  EXPECT_LE(std::abs(pixels() - before), 3);
}

TEST(LookMapTest, WhatIsNotFiniteOrAtTheViewpointIsNoLook) {
  LookMap map({});
  const double nan = std::numeric_limits<double>::quiet_NaN();
  map.add(at(1.0), {{kViewpoint, Vector3::Constant(nan), Seen::kSurface},
                    {kViewpoint, kViewpoint, Seen::kSurface}});
  map.add(at(1.1), {});
  EXPECT_TRUE(map.image().empty());
}

TEST(LookMapTest, ClearedItHasSeenNothing) {
  LookMap map({});
  map.add(at(1.0), {look(0.0, 0.0, 1.0)});
  map.clear();
  EXPECT_TRUE(map.image().empty());
  map.add(at(0.5), {look(0.0, 0.0, 1.0)});
  EXPECT_EQ(map.image().epoch(), at(0.5));
}

TEST(LookMapTest, WhatIsOutOfRangeIsRefusedByItsName) {
  const auto refused = [](auto&& change, const std::string& name) {
    LookMap::Config config;
    change(config);
    try {
      LookMap map(config);
      ADD_FAILURE() << name;
    } catch (const ConfigError& error) {
      EXPECT_NE(std::string(error.what()).find(name), std::string::npos) << error.what();
    }
  };
  refused([](LookMap::Config& c) { c.resolution_rad = 0.0; }, "look_resolution_rad");
  refused([](LookMap::Config& c) { c.spread_rad = -1.0; }, "look_spread_rad");
  refused([](LookMap::Config& c) { c.pass_gap_s = 0.0; }, "look_pass_gap_s");
}

}  // namespace
}  // namespace tccm
