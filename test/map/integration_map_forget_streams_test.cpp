/// IntegrationMap::forget() on random returns and streams, against a list of returns that is
/// filtered and united anew after every step.

#include <gtest/gtest.h>

#include <algorithm>
#include <deque>
#include <limits>

#include "map/integration_map.h"
#include "support/beyond_padding.h"
#include "support/birth_array.h"
#include "support/part_union.h"
#include "support/random.h"
#include "support/small_map.h"

namespace tccm {
namespace {

using test::atScan;
using test::snapshotOf;
using Points = std::vector<Vector3>;

Region everything() { return {{{Box{{5.0, 5.0, 5.0}}, Pose::Identity()}, 0.0}}; }

/// Randomly placed shapes in and about a region of space.
Region randomRegion(test::Random& random, const UprightBox& where) {
  Region region;
  for (int i = random.integer(0, 3); i > 0; --i) {
    const auto kind = static_cast<std::size_t>(random.integer(0, test::kShapeKinds - 1));
    Pose pose = random.pose(0.0);
    pose.translation() = random.pointIn(where);
    region.push_back(
        {{random.shape(kind), pose}, random.chance(0.3) ? 0.0 : random.uniform(0.0, 0.02)});
  }
  return region;
}

/// 20 x 20 cells of 20 mm from 0 to 1 m.
IntegrationMap::Config wideConfig() {
  IntegrationMap::Config config;
  config.grid = test::smallGrid(0.4, 0.4, 1.0);
  config.returns_max = config.intervals_max = 1000;
  return config;
}

TEST(ForgetStreamsTest, AllThatWereInsideLeaveAndNoneFromFurtherThanACellsDiagonalAndAQuantum) {
  test::Random random(72);
  IntegrationMap map(wideConfig());
  const CellIndex cells = map.grid().cells();
  const UprightBox where(Vector3(0.0, 0.0, 0.4), Vector3(0.4, 0.4, 0.6));
  const Vector3 micrometre = Vector3::Constant(1e-6);
  std::size_t inside = 0, outside = 0, between = 0;
  for (int round = 0; round < 200; ++round) {
    map.clear();
    Points points;
    for (CellIndex cell = 0; cell < cells; ++cell) {
      const UprightBox box = map.grid().box(cell, 400, 600);
      // A point within half a micrometre of the border would be rounded into the next cell.
      points.push_back(random.pointIn({box.min() + micrometre, box.max() - micrometre}));
    }
    ASSERT_EQ(map.add(atScan(round), points).mapped, cells);
    const Region region = randomRegion(random, where);
    map.forget(region, atScan(round));
    const CuboidMap snapshot = snapshotOf(map);
    for (CellIndex cell = 0; cell < cells; ++cell) {
      const double beyond = test::distanceBeyondPadding(region, points[cell]);
      const bool stayed = snapshot.cell_begin[cell + 1] > snapshot.cell_begin[cell];
      if (beyond <= 0.0) {
        ASSERT_FALSE(stayed);
        ++inside;
      } else if (beyond > std::sqrt(2.0) * 0.02 + 0.001) {
        ASSERT_TRUE(stayed);
        ++outside;
      } else {
        ++between;
      }
    }
  }
  EXPECT_GT(inside, 3000U);
  EXPECT_GT(outside, 3000U);
  EXPECT_LT(between, inside + outside);
}

/// The map beside a list of the window's returns. There is room for all intervals at once, not for
/// any that leak.
class Comparison {
 public:
  Comparison() : map_(test::crowdedMap(3000, 1200)), births_(map_.grid().cells(), 400, 20) {}

  void add(Points points) {
    const Time stamp = atScan(scan_++);
    const std::size_t forgotten = map_.add(stamp, points).forgotten;
    const std::size_t before = test::mappedReturns(map_.grid(), points).size();
    const auto gone = [&](const Vector3& p) {
      return std::any_of(told_.begin(), told_.end(), [&](const auto& told) {
        return stamp <= told.second && test::distanceBeyondPadding(told.first, p) <= 0.0;
      });
    };
    points.erase(std::remove_if(points.begin(), points.end(), gone), points.end());
    part_maps_.push_back(test::mappedReturns(map_.grid(), points));
    ASSERT_EQ(forgotten, before - part_maps_.back().size());
    births_.add(part_maps_.back(), 20, map_.serial());
    forgotten_late_ += forgotten;
  }

  void forget(const Region& region, Time until) {
    const std::size_t removed = map_.forget(region, until);
    told_.emplace_back(region, until);
    const Grid& grid = map_.grid();
    const double grown = std::sqrt(2 * 0.01 * 0.01 + 0.0005 * 0.0005) + 1e-6;
    std::size_t expected = 0;
    for (auto& part_map : part_maps_) {
      const auto gone = [&](const MappedReturn& entry) {
        const auto column = entry.cell % grid.cellsX(), row = entry.cell / grid.cellsX();
        const Vector3 p(0.02 * column + 0.01, 0.02 * row + 0.01, 0.001 * entry.height);
        return test::distanceBeyondPadding(region, p) <= grown;
      };
      const auto end = std::remove_if(part_map.begin(), part_map.end(), gone);
      expected += static_cast<std::size_t>(part_map.end() - end);
      part_map.erase(end, part_map.end());
    }
    ASSERT_EQ(removed, expected);
    births_.reown(part_maps_, 20, oldestSerial());
    forgotten_at_once_ += removed;
  }

  void expireOldest() {
    births_.expire(oldestSerial());
    map_.expireOldest();
    part_maps_.pop_front();
  }

  void expectEqual() {
    const CuboidMap snapshot = snapshotOf(map_);
    ASSERT_EQ(test::runsOf(snapshot), test::clippedAt(20, test::unionOf(part_maps_, 20)))
        << "scan " << scan_;
    ASSERT_FALSE(map_.overflowed());
    ASSERT_EQ(snapshot.window_scans, part_maps_.size());
    for (const Cuboid& cuboid : snapshot.cuboids) {
      ASSERT_EQ(cuboid.age_scans,
                map_.serial() - births_.born(cuboid.cell, cuboid.bottom, cuboid.top))
          << "scan " << scan_;
    }
  }

  [[nodiscard]] std::size_t scans() const { return map_.scans(); }
  [[nodiscard]] Time newest() const { return atScan(scan_ - 1); }
  [[nodiscard]] std::size_t forgottenAtOnce() const { return forgotten_at_once_; }
  [[nodiscard]] std::size_t forgottenLate() const { return forgotten_late_; }

 private:
  [[nodiscard]] std::uint32_t oldestSerial() const {
    return map_.serial() - static_cast<std::uint32_t>(map_.scans()) + 1;
  }

  IntegrationMap map_;
  test::BirthArray births_;
  std::deque<std::vector<MappedReturn>> part_maps_;
  std::vector<std::pair<Region, Time>> told_;
  int scan_ = 0;
  std::size_t forgotten_at_once_ = 0;
  std::size_t forgotten_late_ = 0;
};

TEST(ForgetStreamsTest, RandomStreamsWithRegionsForgottenAtAnyTimeAreExactAfterEveryStep) {
  const UprightBox about(Vector3(-0.005, -0.005, 0.0), Vector3(0.085, 0.065, 0.42));
  const UprightBox where(Vector3(-0.05, -0.05, 0.0), Vector3(0.13, 0.11, 0.42));
  for (unsigned seed = 1; seed <= 12; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    test::Random random(seed);
    Comparison comparison;
    const int returns_max = seed % 3 == 0 ? 4 : seed % 3 == 1 ? 40 : 100;
    for (int step = 0; step < 400; ++step) {
      Points points;
      for (int i = random.integer(0, returns_max); i > 0; --i) {
        points.push_back(random.pointIn(about));
      }
      ASSERT_NO_FATAL_FAILURE(comparison.add(points));
      ASSERT_NO_FATAL_FAILURE(comparison.expectEqual());
      const auto window = static_cast<std::size_t>(random.integer(1, 25));
      for (int times = random.chance(0.2) ? random.integer(1, 3) : 0; times > 0; --times) {
        const Region region = random.chance(0.05) ? everything() : randomRegion(random, where);
        const Time until = comparison.newest() + fromSeconds(0.028 * random.integer(-3, 5));
        ASSERT_NO_FATAL_FAILURE(comparison.forget(region, until));
        ASSERT_NO_FATAL_FAILURE(comparison.expectEqual());
      }
      while (comparison.scans() > window) {
        comparison.expireOldest();
        ASSERT_NO_FATAL_FAILURE(comparison.expectEqual());
      }
    }
    while (comparison.scans() > 0) comparison.expireOldest();
    ASSERT_NO_FATAL_FAILURE(comparison.expectEqual());
    EXPECT_GT(comparison.forgottenAtOnce(), 50U);
    EXPECT_GT(comparison.forgottenLate(), 50U);
  }
}

}  // namespace
}  // namespace tccm
