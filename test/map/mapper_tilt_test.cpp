#include <gtest/gtest.h>

#include "map/mapper.h"
#include "support/small_map.h"
#include "support/tilted_scans.h"

namespace tccm {
namespace {

using test::snapshotOf;
using test::tilted::kScanPeriod;
using test::tilted::lastComplete;
using test::tilted::scanAt;
using test::tilted::tiltAt;

TEST(MapperTiltTest, ATiltThatStopsMakesTheMapIncompleteThoughScansKeepComing) {
  Mapper mapper(test::smallMapper());
  EXPECT_GT(lastComplete(mapper, 0.0, 10.0, tiltAt), 9.97);
  // The last turning point was at 10.0; strokes take 1 s.
  const double frozen = lastComplete(mapper, 10.025, 30.0, [](double) { return 0.1; });
  EXPECT_NEAR(frozen, 11.5, 0.15);
  EXPECT_GT(lastComplete(mapper, 30.025, 40.0, tiltAt), 39.97) << "it recovers";
}

/// Of a map whose window is set by seconds, which needs no tilt to be complete.
Mapper tiltedThrough(double until) {
  Mapper::Config config = test::smallMapper();
  config.window_s = 0.4;
  Mapper mapper(config);
  lastComplete(mapper, 0.0, until, tiltAt);
  EXPECT_FALSE(snapshotOf(mapper).tilt_stopped);
  return mapper;
}

TEST(MapperTiltTest, ATiltThatDoesNotGoOnAfterAGapStandsStill) {
  const auto freeze = [](double) { return 0.1; };
  Mapper mapper = tiltedThrough(10.0);
  // A stroke takes 1 s, a quarter of a period 0.5 s.
  lastComplete(mapper, 11.0, 12.45, freeze);
  EXPECT_FALSE(snapshotOf(mapper).tilt_stopped);
  lastComplete(mapper, 12.475, 12.6, freeze);
  EXPECT_TRUE(snapshotOf(mapper).tilt_stopped);
  lastComplete(mapper, 13.0, 30.0, freeze);
  EXPECT_TRUE(snapshotOf(mapper).tilt_stopped) << "after another gap too";
  lastComplete(mapper, 30.025, 36.0, tiltAt);
  EXPECT_FALSE(snapshotOf(mapper).tilt_stopped) << "it recovers";
}

TEST(MapperTiltTest, ATiltThatGoesOnAfterAGapDoesNotStandStillWhereverItBegins) {
  for (double gap = 0.3; gap < 2.4; gap += 0.1) {
    Mapper mapper = tiltedThrough(10.0);
    for (double stamp = 10.0 + gap; stamp < 16.0; stamp += kScanPeriod) {
      mapper.add(scanAt(stamp));
      ASSERT_FALSE(snapshotOf(mapper).tilt_stopped) << gap << " s, at " << stamp;
    }
  }
}

TEST(MapperTiltTest, ATiltOfAnotherTempoAfterAGapRecovers) {
  Mapper mapper = tiltedThrough(10.0);
  lastComplete(mapper, 11.0, 40.0, [](double stamp) { return tiltAt(0.3 * stamp); });
  EXPECT_FALSE(snapshotOf(mapper).tilt_stopped);
}

TEST(MapperTiltTest, AMapThatIsClearedKnowsStillThatTheTiltStands) {
  const auto freeze = [](double) { return 0.1; };
  Mapper mapper = tiltedThrough(10.0);
  lastComplete(mapper, 10.025, 12.0, freeze);
  ASSERT_TRUE(snapshotOf(mapper).tilt_stopped);
  mapper.clear();
  lastComplete(mapper, 12.025, 14.0, freeze);
  EXPECT_TRUE(snapshotOf(mapper).tilt_stopped);
  Mapper moves = tiltedThrough(10.0);
  moves.clear();
  lastComplete(moves, 10.025, 12.0, freeze);
  EXPECT_TRUE(snapshotOf(moves).tilt_stopped) << "and has to go on";
}

TEST(MapperTiltTest, ASensorThatNeverTiltedDoesNotStandStill) {
  Mapper::Config config = test::smallMapper();
  config.window_s = 0.4;
  Mapper mapper(config);
  for (const double begin : {0.0, 12.0})
    lastComplete(mapper, begin, begin + 10.0, [](double) { return 0.1; });
  EXPECT_FALSE(snapshotOf(mapper).tilt_stopped);
  EXPECT_TRUE(snapshotOf(mapper).complete);
}

}  // namespace
}  // namespace tccm
