/// IntegrationMap on random and recorded streams, compared after every step with a brute-force
/// union, with the paper's literal three steps, and with births kept for every quantum.

#include <gtest/gtest.h>

#include <algorithm>
#include <deque>
#include <functional>
#include <limits>
#include <optional>

#include "map/integration_map.h"
#include "support/birth_array.h"
#include "support/literal_map.h"
#include "support/part_union.h"
#include "support/random.h"
#include "support/shared_data.h"
#include "support/small_map.h"

namespace tccm {
namespace {

using test::Run;
using Points = std::vector<Vector3>;

/// The literal map's cuboids by cell, then from low to high; it keeps no returns.
std::vector<Run> runsOf(const std::vector<test::LiteralColumn>& columns) {
  std::vector<Run> runs;
  for (CellIndex cell = 0; cell < columns.size(); ++cell) {
    const std::size_t first = runs.size();
    for (const test::LiteralCuboid& c : columns[cell]) runs.push_back({cell, c.bottom(), c.u, 0});
    std::sort(runs.begin() + static_cast<std::ptrdiff_t>(first), runs.end(),
              [](const Run& a, const Run& b) { return a.bottom < b.bottom; });
  }
  return runs;
}

std::vector<Run> withoutPoints(std::vector<Run> runs) {
  for (Run& run : runs) run.points = 0;
  return runs;
}

/// The same stream through the map and its three slower doubles.
class Comparison {
 public:
  enum class Births { kCompared, kLeftOut };

  Comparison(const IntegrationMap::Config& config, Births births)
      : map_(config),
        thickness_(map_.grid().heightOf(config.thickness_m)),
        lowest_(map_.grid().heightOf(config.grid.height_min_m)),
        literal_(map_.grid().cells(), thickness_) {
    if (births == Births::kCompared) {
      births_.emplace(map_.grid().cells(),
                      static_cast<std::size_t>(map_.grid().heightCeil(config.grid.height_max_m)),
                      lowest_);
    }
  }

  void add(const Points& points) {
    map_.add(Time(Duration(map_.serial())), points);
    part_maps_.push_back(test::mappedReturns(map_.grid(), points));
    literal_.add(part_maps_.back());
    if (births_) births_->add(part_maps_.back(), thickness_, map_.serial());
  }

  void expireOldest() {
    const auto oldest = map_.serial() - static_cast<std::uint32_t>(map_.scans()) + 1;
    map_.expireOldest();
    part_maps_.pop_front();
    literal_.expireOldest();
    if (births_) births_->expire(oldest);
  }

  void expectEqual() {
    map_.snapshot(snapshot_);
    const std::vector<Run> runs = test::runsOf(snapshot_);
    ASSERT_EQ(runs, test::clippedAt(lowest_, test::unionOf(part_maps_, thickness_)))
        << "scan " << map_.serial();
    ASSERT_EQ(withoutPoints(runs), test::clippedAt(lowest_, runsOf(literal_.columns())))
        << "scan " << map_.serial();
    ASSERT_FALSE(map_.overflowed());
    ASSERT_EQ(snapshot_.window_scans, part_maps_.size());
    cuboids_ += runs.size();
    if (!births_) return;
    for (const Cuboid& cuboid : snapshot_.cuboids) {
      const auto age = map_.serial() - births_->born(cuboid.cell, cuboid.bottom, cuboid.top);
      ASSERT_EQ(cuboid.age_scans, age) << "scan " << map_.serial();
    }
  }

  [[nodiscard]] std::size_t scans() const { return map_.scans(); }
  [[nodiscard]] std::size_t cuboidsCompared() const { return cuboids_; }

 private:
  IntegrationMap map_;
  int thickness_;
  int lowest_;
  test::LiteralMap literal_;
  std::deque<std::vector<MappedReturn>> part_maps_;
  std::optional<test::BirthArray> births_;
  CuboidMap snapshot_;
  std::size_t cuboids_ = 0;
};

IntegrationMap::Config crowdedConfig() { return test::crowdedMap(20000, 20000); }

struct Stream {
  int returns_max;  ///< in a scan; 0 to this many
  double empty;     ///< share of scans without returns
  double repeated;  ///< share of scans that repeat the one before with a small shift
};

Points nextScan(test::Random& random, const Stream& stream, const Points& last) {
  Points points;
  if (random.chance(stream.empty)) return points;
  if (random.chance(stream.repeated)) {
    points = last;
    const double shift = 0.001 * random.integer(-25, 25);
    for (Vector3& p : points) p.z() += shift;
    return points;
  }
  for (int i = random.integer(0, stream.returns_max); i > 0; --i) {
    points.emplace_back(random.uniform(-0.005, 0.085), random.uniform(-0.005, 0.065),
                        random.uniform(0.0, 0.42));
    if (random.chance(0.3)) points.back().z() = 0.02 * random.integer(0, 21);
    if (random.chance(0.01)) points.back().y() = std::numeric_limits<double>::quiet_NaN();
  }
  return points;
}

const std::vector<Stream> kStreams = {
    {4, 0.1, 0.1}, {40, 0.1, 0.2}, {150, 0.0, 0.0}, {20, 0.5, 0.3}};

/// @param window how many scans are to be left of a stream, asked after each.
void expectEqualAlong(Comparison& comparison, test::Random& random, const Stream& stream, int scans,
                      const std::function<std::size_t()>& window) {
  Points points;
  for (int scan = 0; scan < scans; ++scan) {
    points = nextScan(random, stream, points);
    comparison.add(points);
    ASSERT_NO_FATAL_FAILURE(comparison.expectEqual());
    const std::size_t left = window();
    while (comparison.scans() > left) {
      comparison.expireOldest();
      ASSERT_NO_FATAL_FAILURE(comparison.expectEqual());
    }
  }
}

TEST(IntegrationMapStreamsTest, RandomStreamsThroughFixedWindowsAreExactAfterEveryStep) {
  unsigned seed = 50;
  for (const Stream& stream : kStreams) {
    for (const std::size_t window : {1U, 2U, 5U, 40U}) {
      SCOPED_TRACE(testing::Message() << "window " << window << ", up to " << stream.returns_max);
      test::Random random(++seed);
      Comparison comparison(crowdedConfig(), Comparison::Births::kCompared);
      ASSERT_NO_FATAL_FAILURE(
          expectEqualAlong(comparison, random, stream, 200, [window] { return window; }));
      EXPECT_GT(comparison.cuboidsCompared(), 200U);
    }
  }
}

/// So many that a cell is met again and again, by a few returns each time.
Points nextCloud(test::Random& random) {
  Points points;
  for (int i = random.integer(4000, 12000); i > 0; --i) {
    points.emplace_back(random.uniform(-0.01, 1.01), random.uniform(-0.01, 0.81),
                        random.uniform(0.0, 0.42));
    while (random.chance(0.4)) points.push_back(points.back() + 0.02 * random.point(1.0));
  }
  return points;
}

TEST(IntegrationMapStreamsTest, CloudsOfThousandsOfReturnsAreExactAfterEveryStep) {
  for (const std::size_t window : {1U, 3U}) {
    test::Random random(static_cast<unsigned>(70 + window));
    IntegrationMap::Config config = test::crowdedMap(100000, 60000);
    config.grid = test::smallGrid(1.0, 0.8, 0.4);
    Comparison comparison(config, Comparison::Births::kCompared);
    for (int scan = 0; scan < 6; ++scan) {
      comparison.add(nextCloud(random));
      ASSERT_NO_FATAL_FAILURE(comparison.expectEqual());
      if (comparison.scans() > window) comparison.expireOldest();
      ASSERT_NO_FATAL_FAILURE(comparison.expectEqual());
    }
    EXPECT_GT(comparison.cuboidsCompared(), 10000U);
  }
}

TEST(IntegrationMapStreamsTest, GrowingAndShrinkingWindowsAreExactAfterEveryStep) {
  unsigned seed = 90;
  for (const Stream& stream : kStreams) {
    test::Random random(++seed);
    Comparison comparison(crowdedConfig(), Comparison::Births::kCompared);
    const auto window = [&random] {
      return static_cast<std::size_t>(random.integer(1, random.chance(0.1) ? 2 : 60));
    };
    ASSERT_NO_FATAL_FAILURE(expectEqualAlong(comparison, random, stream, 300, window));
  }
}

/// A recorded scan over the paper's area, the tilt's axis 1.4 m above its floor.
Points recordedPoints(const test::RecordedSweep& sweep, std::size_t scan) {
  const Eigen::Isometry3d T_fixed_laser = Eigen::Translation3d(0.0, 0.0, 1.4) *
                                          Eigen::AngleAxisd(sweep.tilts[scan], Vector3::UnitY()) *
                                          Eigen::Translation3d(0.0, 0.0, 0.03);
  Points points;
  for (std::size_t i = 0; i < sweep.ranges[scan].size(); ++i) {
    const double range = sweep.ranges[scan][i];
    if (range >= 999.0) continue;
    const double angle = sweep.angle_min + static_cast<double>(i) * sweep.angle_increment;
    points.push_back(T_fixed_laser *
                     Vector3(range * std::cos(angle), range * std::sin(angle), 0.0));
  }
  return points;
}

TEST(IntegrationMapStreamsTest, ARecordedSweepOverATableIsExactAfterEveryStep) {
  const auto sweep = test::recordedSweep();
  if (!sweep) GTEST_SKIP() << "no recording " << test::kRecordedSweepFile << " in TCCM_SHARED_DATA";
  for (const std::size_t window : {40U, 100U}) {
    Comparison comparison(IntegrationMap::Config(), Comparison::Births::kLeftOut);
    for (std::size_t stroke = 0; stroke < 2; ++stroke) {
      for (std::size_t i = 0; i < sweep->tilts.size(); ++i) {
        comparison.add(recordedPoints(*sweep, stroke == 0 ? i : sweep->tilts.size() - 1 - i));
        if (comparison.scans() > window) comparison.expireOldest();
        ASSERT_NO_FATAL_FAILURE(comparison.expectEqual());
      }
    }
    EXPECT_GT(comparison.cuboidsCompared(), 50000U);
  }
}

TEST(IntegrationMapStreamsTest, AddingAllPartMapsAnewGivesTheSameMap) {
  test::Random random(99);
  const IntegrationMap::Config config = crowdedConfig();
  IntegrationMap map(config);
  std::deque<test::LiteralPartMap> part_maps;
  Points points;
  for (int scan = 0; scan < 200; ++scan) {
    points = nextScan(random, kStreams[1], points);
    map.add(Time(Duration(scan)), points);
    part_maps.push_back(
        test::literalPartMap(test::mappedReturns(map.grid(), points), 20, map.serial()));
    if (map.scans() > 10) {
      map.expireOldest();
      part_maps.pop_front();
    }
    CuboidMap snapshot;
    map.snapshot(snapshot);
    ASSERT_EQ(withoutPoints(test::runsOf(snapshot)),
              test::clippedAt(20, runsOf(test::additionOfAll(part_maps, map.grid().cells()))));
  }
}

}  // namespace
}  // namespace tccm
