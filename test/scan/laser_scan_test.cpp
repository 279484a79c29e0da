#include "tccm_monitor/laser_scan.h"

#include <gtest/gtest.h>

namespace tccm {
namespace {

LaserScan scanOf(std::size_t beams, Duration time_increment) {
  LaserScan scan;
  scan.stamp = Time(fromSeconds(10.0));
  scan.time_increment = time_increment;
  scan.ranges.assign(beams, 1.0F);
  return scan;
}

TEST(LaserScanTest, EachBeamIsOneIncrementLater) {
  const LaserScan scan = scanOf(4, fromSeconds(0.001));
  EXPECT_EQ(scan.beamTime(0), scan.stamp);
  EXPECT_EQ(scan.beamTime(3), scan.stamp + fromSeconds(0.003));
  EXPECT_EQ(scan.lastBeamTime(), scan.stamp + fromSeconds(0.003));
}

TEST(LaserScanTest, WithoutATimeIncrementAllBeamsAreAtTheStamp) {
  const LaserScan scan = scanOf(100, Duration(0));
  EXPECT_EQ(scan.beamTime(99), scan.stamp);
  EXPECT_EQ(scan.lastBeamTime(), scan.stamp);
}

TEST(LaserScanTest, AScanWithoutBeamsEndsAtItsStamp) {
  EXPECT_EQ(scanOf(0, fromSeconds(0.001)).lastBeamTime(), scanOf(0, Duration(0)).stamp);
}

}  // namespace
}  // namespace tccm
