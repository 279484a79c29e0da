// Place by place: which were free before, and how many returns in such make a cuboid appear.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>
#include <vector>

#include "map/appearances.h"
#include "map/mapper.h"
#include "support/random.h"
#include "support/small_map.h"

namespace tccm {
namespace {

using test::Random;
using Points = std::vector<Vector3>;

constexpr double kFrame = 0.09;  // [s]
constexpr double kFar = 3.0;     // [m], behind everything
constexpr double kCell = 0.02;   // [m], also of a layer
constexpr double kPixel = 0.02;  // [rad], half a cell wide there
const Vector3 kEye(0.213, -0.1, 0.8);

Time at(double seconds) { return Time(fromSeconds(seconds)); }

/// How far was seen in a pixel's direction [m]; 0: nobody looked there.
using Sight = std::function<double(std::size_t pixel)>;

double through(std::size_t /*pixel*/) { return kFar; }
double nowhere(std::size_t /*pixel*/) { return 0.0; }

IntegrationMap::Config mapConfig() {
  IntegrationMap::Config config;
  config.grid = test::smallGrid(0.4, 0.4, 1.0);
  config.grid.height_min_m = 0.1;
  config.returns_max = 200000;
  return config;
}

/// Frames of which is said what each direction saw.
struct Places {
  explicit Places(double the_window_s = 0.05) : window_s(the_window_s) { begin(10.0); }

  /// @return how many cuboids have appeared after it.
  std::size_t frame(const Points& returns, const Sight& sight, double after_s = kFrame) {
    now_s += after_s;
    map.add(at(now_s), returns);
    while (at(now_s) - map.oldestStamp() > fromSeconds(window_s)) map.expireOldest();
    appearances.follow(map, looks);
    look(sight);
    map.snapshot(snapshot, &held);
    appearances.apply(map, snapshot);
    return snapshot.appeared;
  }
  void frames(int count, const Points& returns, const Sight& sight) {
    for (int i = 0; i < count; ++i) frame(returns, sight);
  }
  void look(const Sight& sight) {
    const LookImage::Ticks stamp = looks.ticksAt(at(now_s));
    const DirectionGrid& grid = looks.grid();
    const int last = grid.rowOf(-0.2), last_column = grid.columnOf(M_PI_2 + 0.5);
    for (int row = grid.rowOf(-1.3); row <= last; ++row) {
      for (int column = grid.columnOf(M_PI_2 - 0.5); column <= last_column; ++column) {
        const double range = sight(grid.index(row, column));
        if (range == 0.0) continue;
        LookImage::Passes& passes = looks.edit(row, column);
        passes[1] = passes[0];
        passes[0] = {stamp, stamp, static_cast<std::uint16_t>(1e3 * range), Seen::kSurface, false};
      }
    }
  }
  void begin(double seconds) {
    now_s = seconds;
    looks.clear();
    looks.begin(at(now_s - 1.0), kEye);
  }
  [[nodiscard]] std::size_t pixelOf(const Vector3& place) const {
    return looks.grid().pixelOf(place - kEye);
  }
  /// The directions of a place, and those beside, above and below it.
  [[nodiscard]] std::set<std::size_t> aroundOf(const Vector3& place) const {
    const std::size_t pixel = pixelOf(place);
    const auto row = static_cast<std::size_t>(looks.grid().columns());
    return {pixel, pixel - 1, pixel + 1, pixel - row, pixel + row};
  }

  double window_s, now_s = 0.0;
  IntegrationMap map{mapConfig()};
  LookImage looks{kPixel};
  Appearances appearances{{}, map, kPixel};
  CuboidMap snapshot;
  HeldLayer held{map.grid().cells(), 1};
};

/// The middle of a cell at the middle of a layer, in view.
Vector3 anyPlace(Random& random) {
  return {kCell * (random.integer(7, 13) + 0.5), kCell * (random.integer(7, 13) + 0.5),
          0.1 + kCell * (random.integer(16, 23) + 0.5)};
}

Points returnsAt(const Vector3& place, int count) {
  return Points(static_cast<std::size_t>(count), place);
}

Points operator+(Points points, const Points& others) {
  points.insert(points.end(), others.begin(), others.end());
  return points;
}

Sight in(const std::set<std::size_t>& pixels) {
  return [pixels](std::size_t pixel) { return pixels.count(pixel) > 0 ? kFar : 0.0; };
}

TEST(AppearancesPlacesTest, ALookHasToHaveGoneOnFiveCentimetresBehindAPlace) {
  for (unsigned seed = 0; seed < 60; ++seed) {
    Random random(seed);
    const Vector3 place = anyPlace(random);
    const double behind = random.uniform(0.03, 0.07);
    if (std::abs(behind - 0.05) < 0.002) continue;
    Places places;
    const double range = (place - kEye).norm() + behind;
    places.frames(6, {}, [range](std::size_t) { return range; });
    EXPECT_EQ(places.frame(returnsAt(place, 10), through), behind > 0.05 ? 1U : 0U) << seed;
  }
}

TEST(AppearancesPlacesTest, OneDirectionAroundItThatNobodyLookedInIsEnoughForAPlaceNotToBeFree) {
  Random random(1);
  const Vector3 place = anyPlace(random);
  Places all;
  all.frames(6, {}, in(all.aroundOf(place)));
  EXPECT_EQ(all.frame(returnsAt(place, 10), through), 1U);
  for (const std::size_t hidden : all.aroundOf(place)) {
    Places places;
    places.frames(6, {}, [hidden](std::size_t pixel) { return pixel == hidden ? 0.0 : kFar; });
    EXPECT_EQ(places.frame(returnsAt(place, 10), through), 0U) << hidden;
  }
}

TEST(AppearancesPlacesTest, WhatWasFreeAFewTenthsOfASecondAgoCountsInWhicheverFrameItComes) {
  Random random(2);
  for (int phase = 0; phase < 7; ++phase) {
    for (const int since : {1, 3, 5, 7, 10, 15}) {
      const Vector3 place = anyPlace(random);
      Places places;
      places.frames(12 + phase, {}, through);
      places.frames(since - 1, {}, nowhere);
      EXPECT_EQ(places.frame(returnsAt(place, 10), through), since <= 7 ? 1U : 0U)
          << phase << ", " << since;
    }
    // The robot has just left the place.
    Places places;
    places.frames(12 + phase, {}, nowhere);
    places.frames(3, {}, through);
    EXPECT_EQ(places.frame(returnsAt(anyPlace(random), 10), through), 1U) << phase;
  }
}

TEST(AppearancesPlacesTest, AfterALongerGapOfFramesNothingHasAppeared) {
  for (unsigned seed = 0; seed < 30; ++seed) {
    Random random(seed);
    const double gap = random.uniform(0.3, 0.9);
    if (std::abs(gap - 0.6) < 0.005) continue;
    Places places;
    places.frames(7, {}, through);
    EXPECT_EQ(places.frame(returnsAt(anyPlace(random), 10), through, gap), gap < 0.6 ? 1U : 0U)
        << gap;
  }
}

TEST(AppearancesPlacesTest, WhatWasMissedForLessThanFourTenthsOfASecondIsStillTheSame) {
  Random random(3);
  for (const int missed : {0, 1, 2, 3, 4, 6, 8}) {
    const Vector3 place = anyPlace(random);
    Places places;
    places.frames(12, returnsAt(place, 10), through);
    places.frames(missed, {}, through);
    EXPECT_EQ(places.frame(returnsAt(place, 10), through), missed >= 4 ? 1U : 0U) << missed;
  }
}

TEST(AppearancesPlacesTest, EightReturnsOfTheNewestFrameAreNeeded) {
  Random random(4);
  const Vector3 place = anyPlace(random);
  for (int returns = 1; returns < 40; ++returns) {
    Places places(10.0);
    places.frames(6, {}, through);
    EXPECT_EQ(places.frame(returnsAt(place, returns), through), returns >= 8 ? 1U : 0U) << returns;
    EXPECT_EQ(places.frame({}, through), 0U);
    EXPECT_EQ(places.frame(returnsAt(place, 7), through), 0U);
    EXPECT_EQ(places.frame(returnsAt(place, 8), through), 1U);
  }
}

TEST(AppearancesPlacesTest, MostReturnsAroundHaveToBeInPlacesWhereSomethingAppeared) {
  std::size_t most = 0, fewer = 0;
  for (unsigned seed = 0; seed < 150; ++seed) {
    Random random(seed);
    const Vector3 place = anyPlace(random);
    // Whether what has long stood there is beside it, two layers or two cells away.
    const int x = random.integer(-1, 2), z = random.integer(-2, 1);
    const int y = x == 0 ? 1 : random.integer(-1, 1);
    const Vector3 standing = place + kCell * Vector3(x, y, z);
    const bool is_around = std::max({std::abs(x), std::abs(y), std::abs(z)}) == 1;
    Places places(10.0);
    places.frames(6, returnsAt(standing, 5), through);
    const int returns = random.integer(30, 120), all = returns + (is_around ? 35 : 0);
    const bool are_most = returns >= 0.65 * all;
    // What stands beside it has not appeared, whatever is around it.
    EXPECT_EQ(places.frame(returnsAt(place, returns) + returnsAt(standing, 5), through),
              are_most ? 1U : 0U)
        << seed;
    ++(are_most ? most : fewer);
  }
  EXPECT_GT(most, 50U);
  EXPECT_GT(fewer, 20U);
}

/// A place that is free all around, and another one.
struct Pair {
  Vector3 free, other;
  Sight sight;  ///< before

  /// @return of how many, where the other comes so many frames later.
  [[nodiscard]] std::size_t appeared(int later) const {
    Places places;
    places.frames(8, {}, sight);
    places.frames(later, returnsAt(free, 30), sight);
    return places.frame(returnsAt(free, 30) + returnsAt(other, 10), sight);
  }
};

TEST(AppearancesPlacesTest, BesideWhatHasAppearedItIsEnoughThatThePlaceItselfWasFree) {
  const Places any;
  std::size_t beside = 0, apart = 0;
  for (unsigned seed = 0; seed < 150; ++seed) {
    Random random(seed);
    Pair pair{anyPlace(random), {}, {}};
    const int x = random.integer(-2, 2), y = random.integer(-2, 2), z = random.integer(-2, 2);
    pair.other = pair.free + kCell * Vector3(x, y, z);
    std::set<std::size_t> pixels = any.aroundOf(pair.free);
    const std::size_t own = any.pixelOf(pair.other);
    if ((x == 0 && y == 0) || pixels.count(own) > 0) continue;
    const bool is_beside = std::max({std::abs(x), std::abs(y), std::abs(z)}) == 1;
    ++(is_beside ? beside : apart);
    for (const int later : {0, 3}) {
      pair.sight = in(pixels);
      EXPECT_EQ(pair.appeared(later), 1U) << seed << ": nobody looked at the other";
      const double short_of = (pair.other - kEye).norm();
      pair.sight = [&](std::size_t p) {
        return p == own ? short_of : pixels.count(p) > 0 ? kFar : 0.0;
      };
      EXPECT_EQ(pair.appeared(later), 1U) << seed << ": nobody looked through it";
      std::set<std::size_t> both = pixels;
      both.insert(own);
      pair.sight = in(both);
      EXPECT_EQ(pair.appeared(later), is_beside ? 2U : 1U) << seed << ", " << later;
    }
  }
  EXPECT_GT(beside, 15U);
  EXPECT_GT(apart, 50U);
}

TEST(AppearancesPlacesTest, BesideWhatHasAppearedAPlaceHasToHaveBeenFreeLatelyAsWell) {
  const Vector3 free(0.21, 0.21, 0.51), other(0.23, 0.21, 0.51);
  const Points both = returnsAt(free, 30) + returnsAt(other, 10);
  for (int phase = 0; phase < 7; ++phase) {
    for (const int since : {1, 3, 5, 7, 10, 15}) {
      Places places;
      const std::set<std::size_t> pixels = places.aroundOf(free);
      std::set<std::size_t> all = pixels;
      all.insert(places.pixelOf(other));
      places.frames(12 + phase, {}, in(all));
      places.frames(since - 1, {}, in(pixels));
      EXPECT_EQ(places.frame(both, through), since <= 7 ? 2U : 1U) << phase << ", " << since;
      Places latest;
      latest.frames(12 + phase, {}, in(pixels));
      latest.frames(3, {}, in(all));
      EXPECT_EQ(latest.frame(both, through), 2U) << phase;
    }
  }
  for (const double gap : {0.5, 0.7}) {
    Places places;
    places.frames(9, {}, through);
    ASSERT_EQ(places.frame(returnsAt(free, 30), through), 1U);
    EXPECT_EQ(places.frame(both, through, gap), gap < 0.6 ? 2U : 1U) << gap;
  }
}

TEST(AppearancesPlacesTest, WhatIsThereInTheFirstFrameIsKnownAndWhatComesSoonAfterItIsNot) {
  Random random(5);
  const Vector3 old = anyPlace(random), young = old + Vector3(0.0, 3.0 * kCell, 0.0);
  Places places;
  for (int i = 0; i < 3; ++i) EXPECT_EQ(places.frame(returnsAt(old, 10), through), 0U) << i;
  EXPECT_EQ(places.frame(returnsAt(old, 10) + returnsAt(young, 10), through), 1U);
}

TEST(AppearancesPlacesTest, WhatIsHeldHasNotAppearedAlsoWhereSomethingDidBesideIt) {
  Random random(6);
  const Vector3 left = anyPlace(random), beside = left + Vector3(kCell, 0.0, 0.0);
  Places places;
  places.frames(6, {}, through);
  ASSERT_EQ(places.frame(returnsAt(left, 10), through), 1U);
  const Cuboid cuboid = places.snapshot.cuboids.front();
  HeldLayer::Interval interval;
  interval.cell = cuboid.cell;
  interval.heights = {cuboid.bottom, cuboid.top};
  ASSERT_TRUE(places.held.hold(interval));
  EXPECT_EQ(places.frame(returnsAt(beside, 10), through), 1U);
  ASSERT_EQ(places.snapshot.cuboids.size(), 2U);
  for (const Cuboid& c : places.snapshot.cuboids) EXPECT_NE(c.appeared, c.held);
}

TEST(AppearancesPlacesTest, OnceClearedItTellsWhatANewOneTellsAlsoWhenTimeJumpsBack) {
  for (unsigned seed = 0; seed < 10; ++seed) {
    Random random(seed);
    const Vector3 first = anyPlace(random);
    Places cleared, fresh;
    const auto step = [&](bool both) {
      Points returns;
      for (int i = 0; i < 5; ++i) {
        if (random.chance(0.1))
          returns = returns + returnsAt(first + i * kCell * Vector3::UnitX(), 12);
      }
      const Sight sight = random.chance(0.9) ? through : nowhere;
      const std::size_t appeared = cleared.frame(returns, sight);
      if (!both) return;
      EXPECT_EQ(appeared, fresh.frame(returns, sight)) << seed;
    };
    for (int i = 0; i < 30; ++i) step(false);
    cleared.appearances.clear();
    cleared.map.clear();
    cleared.begin(fresh.now_s);
    for (int i = 0; i < 30; ++i) step(true);
  }
}

TEST(AppearancesPlacesTest, AfterMonthsNothingOfTheFirstOfThemCountsAndItGoesOnAsBefore) {
  constexpr double kTurn = 4294967.296;  // [s]: so many milliseconds are counted in 32 bits
  const Vector3 place(0.21, 0.21, 0.51);
  Places places;
  places.frames(6, {}, through);
  ASSERT_EQ(places.frame(returnsAt(place, 10), through), 1U);
  places.begin(places.now_s + kTurn);
  EXPECT_EQ(places.frame(returnsAt(place, 10), through), 0U);
  places.appearances.clear();
  for (int i = 0; i < 3; ++i) {
    places.begin(places.now_s + kTurn);
    places.frames(8, {}, through);
    EXPECT_EQ(places.frame(returnsAt(place, 10), through), 1U) << i;
  }
}

TEST(AppearancesPlacesTest, HoweverMuchComesIntoSightAtOnceNoMemoryIsAskedFor) {
  IntegrationMap::Config config = mapConfig();
  config.grid.size_x_m = config.grid.size_y_m = 0.8;
  IntegrationMap map(config);
  Appearances appearances({}, map, kPixel);
  const LookImage looks(kPixel);
  map.add(at(1.0), {});
  appearances.follow(map, looks);
  const std::size_t bytes = appearances.memoryBytes();
  Points everywhere;
  for (double x = 0.5 * kCell; x < 0.8; x += kCell) {
    for (double y = 0.5 * kCell; y < 0.8; y += kCell) {
      for (double z = 0.11; z < 1.0; z += kCell) everywhere.emplace_back(x, y, z);
    }
  }
  EXPECT_GT(everywhere.size(), 60000U);
  map.add(at(1.1), everywhere);
  appearances.follow(map, looks);
  EXPECT_EQ(appearances.memoryBytes(), bytes);
}

/// A net, between whose threads others of a frame's looks pass.
TEST(AppearancesPlacesTest, WhatTheRobotUncoversHasNotAppearedAlsoWhereLooksPassThroughIt) {
  for (int phase = 0; phase < 5; ++phase) {
    Mapper::Config config;
    config.map = mapConfig();
    config.window_s = 0.05;
    Mapper mapper(config);
    const Vector3 place(0.21, 0.21, 0.51);
    CuboidMap snapshot;
    for (int i = 0; i < 20 + phase; ++i) {
      const bool is_uncovered = i >= 12 + phase;
      ScanReturns frame;
      frame.stamp = at(10.0 + kFrame * i);
      frame.viewpoint = kEye;
      frame.is_whole = true;
      const Vector3 ahead = place - kEye;
      for (int x = -20; x <= 20; ++x) {
        for (int z = -20; z <= 20; ++z) {
          const Vector3 end = kEye + (is_uncovered ? 3.0 : 0.5) * (ahead + 0.01 * Vector3(x, 0, z));
          frame.looks.push_back({kEye, end, is_uncovered ? Seen::kSurface : Seen::kRobot});
        }
      }
      if (is_uncovered) frame.points = returnsAt(place, 10);
      ASSERT_EQ(mapper.add(frame).dropped, "");
      mapper.snapshot(snapshot);
      EXPECT_EQ(snapshot.appeared, 0U) << phase << ", " << i;
    }
    EXPECT_EQ(snapshot.cuboids.size(), 1U);
  }
}

}  // namespace
}  // namespace tccm
