#include "map/mapper.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "support/small_map.h"
#include "support/tilted_scans.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

using test::snapshotOf;
using test::tilted::kScanPeriod;
using test::tilted::kTiltPeriod;
using test::tilted::lastComplete;
using test::tilted::scanAt;
using test::tilted::tiltAt;

Time at(double seconds) { return Time(fromSeconds(seconds)); }

Mapper::Config smallMap() { return test::smallMapper(); }

bool isComplete(Mapper& mapper) { return snapshotOf(mapper).complete; }

/// Adds scans until one makes the map complete; its stamp, or nothing until `last`.
std::optional<double> completeFrom(Mapper& mapper, double first, double last) {
  for (int i = 0; first + i * kScanPeriod <= last; ++i) {
    const double stamp = first + i * kScanPeriod;
    mapper.add(scanAt(stamp));
    if (isComplete(mapper)) return stamp;
  }
  return std::nullopt;
}

TEST(MapperTest, BeforeTheFirstScanTheMapIsEmptyAndNotComplete) {
  const CuboidMap map = snapshotOf(Mapper(smallMap()));
  EXPECT_FALSE(map.complete);
  EXPECT_EQ(map.serial, 0U);
  EXPECT_EQ(map.window_scans, 0U);
  EXPECT_TRUE(map.cuboids.empty());
}

TEST(MapperTest, AWindowOfScansHoldsTheLastOnesAndIsCompleteOnceItIsFull) {
  Mapper::Config config = smallMap();
  config.window_scans = 4;
  Mapper mapper(config);
  for (int i = 1; i <= 10; ++i) {
    const double height = 0.1 * i;
    EXPECT_EQ(mapper.add(scanAt(kScanPeriod * i, {Vector3(0.05, 0.05, height)})).dropped, "");
    const CuboidMap map = snapshotOf(mapper);
    EXPECT_EQ(map.complete, i >= 4) << i;
    EXPECT_EQ(map.window_scans, static_cast<unsigned>(std::min(i, 4)));
    EXPECT_EQ(map.serial, static_cast<unsigned>(i));
    ASSERT_EQ(map.cuboids.size(), map.window_scans);
    EXPECT_EQ(map.cuboids.back().top, 100 * i);
    EXPECT_EQ(map.cuboids.front().top, 100 * std::max(1, i - 3));
  }
  EXPECT_EQ(snapshotOf(mapper).window,
            fromSeconds(kScanPeriod * 10) - fromSeconds(kScanPeriod * 7));
}

TEST(MapperTest, AWindowOfSecondsDropsWhatIsOlderAndNotWhatIsExactlyAsOld) {
  Mapper::Config config = smallMap();
  config.window_s = 0.1;
  Mapper mapper(config);
  EXPECT_EQ(mapper.window(), fromSeconds(0.1));
  for (int i = 0; i <= 4; ++i) {
    EXPECT_FALSE(isComplete(mapper));
    mapper.add(scanAt(1.0 + kScanPeriod * i));
  }
  EXPECT_TRUE(isComplete(mapper));
  EXPECT_EQ(snapshotOf(mapper).window_scans, 5U);
  mapper.add(scanAt(1.0 + kScanPeriod * 5));
  EXPECT_EQ(snapshotOf(mapper).window_scans, 5U);
  EXPECT_TRUE(isComplete(mapper));
}

TEST(MapperTest, AWindowOfTheTiltIsCompleteOnlyAfterAFullMeasuredPeriod) {
  Mapper mapper(smallMap());
  EXPECT_FALSE(mapper.window());
  // Turning points at 0.5 (if the start is at 0.25: up), 1, 2, 3 s: the first full period ends
  // at 3.
  const auto complete = completeFrom(mapper, 0.25, 10.0);
  ASSERT_TRUE(complete);
  EXPECT_GE(*complete, 3.0);
  EXPECT_LE(*complete, 3.2);
  ASSERT_TRUE(mapper.tiltPeriod());
  EXPECT_NEAR(toSeconds(*mapper.tiltPeriod()), kTiltPeriod, 2.0 * kScanPeriod);
  EXPECT_NEAR(toSeconds(*mapper.window()), 1.1 * kTiltPeriod, 3.0 * kScanPeriod);
}

TEST(MapperTest, AWindowOfTheTiltHoldsAsManyScansAsItsLengthNeeds) {
  Mapper mapper(smallMap());
  for (int i = 0; i < 600; ++i) mapper.add(scanAt(kScanPeriod * i));
  const CuboidMap map = snapshotOf(mapper);
  EXPECT_TRUE(map.complete);
  EXPECT_LE(map.window, *mapper.window());
  EXPECT_GT(map.window, *mapper.window() - fromSeconds(1.01 * kScanPeriod));
}

TEST(MapperTest, ATiltThatStandsStillNeverMakesTheMapComplete) {
  Mapper mapper(smallMap());
  for (int i = 0; i < 400; ++i) {
    ScanReturns scan = scanAt(kScanPeriod * i);
    scan.tilt = 0.3;
    mapper.add(scan);
    EXPECT_FALSE(isComplete(mapper));
  }
}

TEST(MapperTest, AWindowThatGrowsIsCompleteOnlyOnceItHoldsAPeriodAgain) {
  Mapper mapper(smallMap());
  lastComplete(mapper, 0.0, 10.0, tiltAt);
  // From 10 s on the tilt takes twice as long.
  for (int i = 1; i <= 1200; ++i) {
    const double stamp = 10.0 + i * kScanPeriod;
    ScanReturns scan = scanAt(stamp);
    scan.tilt = tiltAt(10.0 + 0.5 * (stamp - 10.0));
    mapper.add(scan);
    const CuboidMap map = snapshotOf(mapper);
    if (stamp < 14.2 || !map.complete) continue;  // until then it may still take 3 s
    ASSERT_GE(toSeconds(map.window), 2.0 * kTiltPeriod - 2.0 * kScanPeriod) << stamp;
  }
  EXPECT_TRUE(isComplete(mapper));
}

TEST(MapperTest, AStepBackAmidAStrokeDoesNotShrinkTheWindow) {
  Mapper mapper(smallMap());
  lastComplete(mapper, 0.0, 10.0, tiltAt);
  lastComplete(mapper, 10.025, 14.0, [](double stamp) {
    return tiltAt(stamp) - (stamp > 10.5 && stamp < 10.6 ? 0.2 : 0.0);
  });
  EXPECT_GE(toSeconds(*mapper.window()), 1.1 * kTiltPeriod - 0.05);
  EXPECT_GE(toSeconds(snapshotOf(mapper).window), kTiltPeriod);
}

TEST(MapperTest, AfterAGapTheWindowHasToFillAgain) {
  for (const int scans : {0, 4}) {
    Mapper::Config config = smallMap();
    config.window_scans = scans;
    Mapper mapper(config);
    const auto first = completeFrom(mapper, 0.0, 10.0);
    ASSERT_TRUE(first);
    mapper.add(scanAt(*first + 0.24));
    EXPECT_TRUE(isComplete(mapper)) << "no longer than allowed";
    const double after_gap = *first + 0.24 + 0.26;
    mapper.add(scanAt(after_gap));
    EXPECT_FALSE(isComplete(mapper));
    const auto again = completeFrom(mapper, after_gap + kScanPeriod, after_gap + 10.0);
    ASSERT_TRUE(again);
    EXPECT_GE(*again - after_gap, scans > 0 ? 3 * kScanPeriod - 1e-9 : kTiltPeriod);
  }
}

TEST(MapperTest, AfterAGapOrClearedWhatTiltedHasToSweepAgainHoweverShortTheWindowIs) {
  Mapper::Config by_scans = smallMap(), by_seconds = smallMap();
  by_scans.window_scans = 4;
  by_seconds.window_s = 0.2;
  for (const Mapper::Config& config : {by_scans, by_seconds}) {
    for (const int run : {0, 1, 2, 3}) {
      const bool goes_on = run % 2 == 0, is_cleared = run / 2 == 0;
      Mapper mapper(config);
      EXPECT_TRUE(completeFrom(mapper, 0.0, 0.5)) << "it may be one that does not tilt";
      EXPECT_GT(lastComplete(mapper, 0.5, 10.0, tiltAt), 9.9);
      if (is_cleared) mapper.clear();
      double first = 0.0;
      for (double stamp = 12.0; stamp < 18.0; stamp += kScanPeriod) {
        ScanReturns scan = scanAt(stamp);
        if (!goes_on) scan.tilt = 0.1;
        mapper.add(scan);
        if (first == 0.0 && isComplete(mapper)) first = stamp;
      }
      EXPECT_EQ(first > 0.0, goes_on) << first;
      EXPECT_TRUE(first == 0.0 || first - 12.0 >= kTiltPeriod) << first;
    }
  }
}

TEST(MapperTest, ScansThatAreNotNewerAreDroppedAndChangeNothing) {
  Mapper mapper(smallMap());
  mapper.add(scanAt(1.0, {Vector3(0.05, 0.05, 0.5)}));
  for (const double stamp : {1.0, 0.9}) {
    EXPECT_NE(mapper.add(scanAt(stamp, {Vector3(0.05, 0.05, 0.9)})).dropped, "");
  }
  const CuboidMap map = snapshotOf(mapper);
  EXPECT_EQ(map.serial, 1U);
  EXPECT_EQ(map.cuboids.size(), 1U);
  EXPECT_EQ(map.stamp, at(1.0));
}

TEST(MapperTest, AScanWithoutAViewpointIsDropped) {
  Mapper mapper(smallMap());
  ScanReturns scan = scanAt(1.0);
  scan.viewpoint.z() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(mapper.add(scan).dropped, "");
  EXPECT_EQ(snapshotOf(mapper).serial, 0U);
}

TEST(MapperTest, EmptyScansCountAsScans) {
  Mapper::Config config = smallMap();
  config.window_scans = 2;
  Mapper mapper(config);
  mapper.add(scanAt(1.0, {Vector3(0.05, 0.05, 0.5)}));
  mapper.add(scanAt(1.1));
  EXPECT_TRUE(isComplete(mapper));
  EXPECT_EQ(snapshotOf(mapper).cuboids.size(), 1U);
  mapper.add(scanAt(1.2));
  EXPECT_EQ(snapshotOf(mapper).cuboids.size(), 0U) << "the first scan has left the window";
  EXPECT_EQ(snapshotOf(mapper).serial, 3U);
}

TEST(MapperTest, PointsOutsideTheAreaAreCounted) {
  Mapper mapper(smallMap());
  const auto outcome =
      mapper.add(scanAt(1.0, {Vector3(0.05, 0.05, 0.5), Vector3(9.0, 0.0, 0.5),
                              Vector3(0.05, 0.05, std::numeric_limits<double>::quiet_NaN())}));
  EXPECT_EQ(outcome.added.mapped, 1U);
  EXPECT_EQ(outcome.added.out_of_area, 2U);
}

TEST(MapperTest, AWindowThatNeedsMoreScansThanThereIsMemoryForIsNeverComplete) {
  Mapper::Config config = smallMap();
  config.map.scans_max = 50;  // a period has 80
  Mapper by_tilt(config);
  EXPECT_FALSE(completeFrom(by_tilt, 0.0, 20.0));
  config.window_s = 50 * kScanPeriod;
  Mapper by_seconds(config);
  EXPECT_FALSE(completeFrom(by_seconds, 0.0, 20.0));
  config.window_s = 48 * kScanPeriod;
  Mapper fits(config);
  EXPECT_TRUE(completeFrom(fits, 0.0, 20.0));
}

TEST(MapperTest, ClearForgetsScansAndTiltAndSerialsGoOn) {
  Mapper mapper(smallMap());
  ASSERT_TRUE(completeFrom(mapper, 0.0, 10.0));
  const std::uint32_t serial = snapshotOf(mapper).serial;
  mapper.clear();
  EXPECT_FALSE(isComplete(mapper));
  EXPECT_FALSE(mapper.tiltPeriod());
  EXPECT_EQ(snapshotOf(mapper).window_scans, 0U);
  EXPECT_EQ(mapper.add(scanAt(0.5)).dropped, "") << "older than before is fine now";
  EXPECT_EQ(snapshotOf(mapper).serial, serial + 1);
  EXPECT_FALSE(isComplete(mapper));
}

/// 10 mm around a place in the first cell, which all its returns are near to.
Region around(const Vector3& p_fixed) {
  return {{{Sphere{0.01}, Pose(Eigen::Translation3d(p_fixed))}, 0.0}};
}

TEST(MapperTest, WhatIsForgottenLeavesTheMapAndScansStampedUpToThen) {
  Mapper::Config config = smallMap();
  config.window_scans = 3;
  Mapper mapper(config);
  const Vector3 object(0.055, 0.055, 0.5), beside(0.155, 0.055, 0.5);
  for (const double stamp : {1.0, 1.1, 1.2}) mapper.add(scanAt(stamp, {object, beside}));
  EXPECT_EQ(mapper.forget(around(object), at(1.4)), 3U);
  CuboidMap map = snapshotOf(mapper);
  EXPECT_TRUE(map.complete) << "the window is as it was";
  EXPECT_EQ(map.window_scans, 3U);
  ASSERT_EQ(map.cuboids.size(), 1U);
  EXPECT_EQ(map.cuboids[0].points, 3U);
  EXPECT_EQ(map.cuboids[0].age_scans, 2U);
  for (const double stamp : {1.3, 1.4}) {
    const auto outcome = mapper.add(scanAt(stamp, {object, beside}));
    EXPECT_EQ(outcome.added.forgotten, 1U);
    EXPECT_EQ(outcome.added.mapped, 1U);
    EXPECT_EQ(snapshotOf(mapper).cuboids.size(), 1U);
  }
  EXPECT_EQ(mapper.add(scanAt(1.5, {object, beside})).added.forgotten, 0U);
  map = snapshotOf(mapper);
  ASSERT_EQ(map.cuboids.size(), 2U);
  EXPECT_EQ(map.cuboids[0].age_scans, 0U) << "what is there now is new";
  EXPECT_EQ(map.cuboids[0].points, 1U);
}

TEST(MapperTest, AJumpBackInTimeEndsWhatIsForgotten) {
  Mapper mapper(smallMap());
  const Vector3 object(0.055, 0.055, 0.5);
  mapper.add(scanAt(5.0, {object}));
  mapper.forget(around(object), at(6.0));
  EXPECT_EQ(mapper.add(scanAt(4.0, {object})).added.mapped, 1U);
  EXPECT_EQ(mapper.add(scanAt(5.5, {object})).added.mapped, 1U);
}

TEST(MapperTest, ARegionMayBeForgottenBeforeTheFirstScanAndAfterClearing) {
  Mapper mapper(smallMap());
  const Vector3 object(0.055, 0.055, 0.5);
  EXPECT_EQ(mapper.forget(around(object), at(1.0)), 0U);
  EXPECT_EQ(mapper.add(scanAt(0.9, {object})).added.forgotten, 1U);
  EXPECT_EQ(mapper.add(scanAt(1.1, {object})).added.mapped, 1U);
  mapper.clear();
  EXPECT_EQ(mapper.forget(around(object), at(1.0)), 0U);
  EXPECT_EQ(mapper.add(scanAt(0.9, {object})).added.forgotten, 1U);
}

TEST(MapperTest, TheSnapshotHasTheNewestScansStampAndViewpoint) {
  Mapper mapper(smallMap());
  ScanReturns scan = scanAt(1.0);
  scan.viewpoint = Vector3(1.0, 2.0, 3.0);
  mapper.add(scan);
  const CuboidMap map = snapshotOf(mapper);
  EXPECT_EQ(map.stamp, at(1.0));
  EXPECT_EQ(map.viewpoint, scan.viewpoint);
  EXPECT_EQ(map.window, Duration::zero());
}

TEST(MapperTest, AReservedSnapshotIsNotAllocatedAnew) {
  Mapper mapper(smallMap());
  CuboidMap map;
  mapper.reserve(map);
  const Cuboid* cuboids = map.cuboids.data();
  const std::uint32_t* cells = map.cell_begin.data();
  mapper.add(scanAt(1.0, {Vector3(0.05, 0.05, 0.5), Vector3(0.15, 0.05, 0.5)}));
  mapper.snapshot(map);
  EXPECT_EQ(map.cuboids.size(), 2U);
  EXPECT_EQ(map.cuboids.data(), cuboids);
  EXPECT_EQ(map.cell_begin.data(), cells);
}

TEST(MapperTest, ValuesOutOfRangeAndTwoWindowsAtOnceAreRefused) {
  const auto refused = [](auto change) {
    Mapper::Config config = smallMap();
    change(config);
    EXPECT_THROW(Mapper{config}, ConfigError);
  };
  refused([](Mapper::Config& c) { c.window_scans = -1; });
  refused([](Mapper::Config& c) { c.window_scans = static_cast<int>(c.map.scans_max) + 1; });
  refused([](Mapper::Config& c) { c.window_s = -0.1; });
  refused([](Mapper::Config& c) { c.window_tilt_periods = 0.75; });
  refused([](Mapper::Config& c) { c.scan_gap_max_s = 0.0; });
  refused([](Mapper::Config& c) { c.window_scans = 40, c.window_s = 1.0; });
}

TEST(MapperTest, AMapOfATiltThatTurnsFasterThanAnyIsNotComplete) {
  for (const double period : {0.05, 0.1, 0.2, 0.29, 0.31, 0.5, 1.0, 2.0}) {
    Mapper mapper(smallMap());
    bool was_complete = false;
    for (int i = 0; i < 600; ++i) {
      ScanReturns scan = scanAt(0.01 * i);
      scan.tilt = 0.5 * std::sin(2.0 * M_PI * 0.01 * i / period + 0.3);
      mapper.add(scan);
      was_complete = was_complete || isComplete(mapper);
    }
    EXPECT_EQ(was_complete, period > 0.3) << period;
    EXPECT_EQ(mapper.tiltTooFast(), period < 0.3) << period;
  }
}

}  // namespace
}  // namespace tccm
