#include "scan/scan_assembler.h"

#include <gtest/gtest.h>

#include <limits>

#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

using K = BeamKind;

Time atSeconds(double seconds) { return Time(fromSeconds(seconds)); }

/// 9 beams a milliradian apart around x; one of them splits between two surfaces.
LaserScan scanAlongX() {
  LaserScan scan;
  scan.stamp = atSeconds(10.0);
  scan.angle_min = -0.004;
  scan.angle_increment = 0.001;
  scan.time_increment = fromSeconds(0.001);
  scan.range_min = 0.1;
  scan.range_max = 5.0;
  scan.ranges = {1.0F, 1.0F, 1.0F, 1.5F, 2.0F, 2.0F, std::numeric_limits<float>::infinity(),
                 0.5F, 0.5F};
  return scan;
}

PosePath stillPath(double first, double last) {
  PosePath path;
  EXPECT_TRUE(path.add(atSeconds(first), Pose::Identity()));
  EXPECT_TRUE(path.add(atSeconds(last), Pose::Identity()));
  return path;
}

/// A ball of the robot's whose padded surface holds the points at 0.5 m, and shadows up to 0.91 m.
std::vector<BodySample> ballInFront() {
  Pose pose = Pose::Identity();
  pose.translation().x() = 0.5;
  return {{atSeconds(10.0), {{Sphere{0.1}}, {pose}, {0.05}}}};
}

std::vector<K> kindsOf(const AssembledScan& scan) {
  std::vector<K> kinds;
  for (const Beam& beam : scan.beams) kinds.push_back(beam.kind);
  return kinds;
}

TEST(ScanAssemblerTest, ProjectsThenRemovesMixedPixelsThenTheRobot) {
  AssembledScan result;
  ASSERT_EQ(ScanAssembler{}.assemble(scanAlongX(), stillPath(9.0, 11.0), ballInFront(), result),
            "");
  EXPECT_EQ(kindsOf(result),
            (std::vector<K>{K::kReturn, K::kReturn, K::kReturn, K::kMixedPixel, K::kReturn,
                            K::kReturn, K::kNoReturn, K::kSelf, K::kSelf}));
  EXPECT_EQ(result.stamp, atSeconds(10.0));
}

TEST(ScanAssemblerTest, ADeeperShadowTakesThePointsBehindTheRobot) {
  ScanAssembler config;
  config.body.shadow_depth_m = 0.6;
  AssembledScan result;
  ASSERT_EQ(
      ScanAssembler(config).assemble(scanAlongX(), stillPath(9.0, 11.0), ballInFront(), result),
      "");
  EXPECT_EQ(kindsOf(result),
            (std::vector<K>{K::kShadow, K::kShadow, K::kShadow, K::kMixedPixel, K::kReturn,
                            K::kReturn, K::kNoReturn, K::kSelf, K::kSelf}));
}

TEST(ScanAssemblerTest, WithoutABodyNothingIsTakenForTheRobot) {
  AssembledScan result;
  ASSERT_EQ(ScanAssembler{}.assemble(scanAlongX(), stillPath(9.0, 11.0), {}, result), "");
  EXPECT_EQ(result.counts()[static_cast<std::size_t>(K::kReturn)], 7U);
}

TEST(ScanAssemblerTest, ADefectiveScanIsDroppedWithItsReason) {
  LaserScan scan = scanAlongX();
  scan.range_max = std::numeric_limits<double>::quiet_NaN();
  AssembledScan result;
  result.beams.resize(5);
  const std::string reason = ScanAssembler{}.assemble(scan, stillPath(9.0, 11.0), {}, result);
  EXPECT_EQ(reason, "malformed");
  EXPECT_TRUE(result.beams.empty());
}

TEST(ScanAssemblerTest, MoreBeamsThanConfiguredAreDropped) {
  ScanAssembler config;
  config.scan_beams_max = 8;
  AssembledScan result;
  EXPECT_NE(ScanAssembler(config).assemble(scanAlongX(), stillPath(9.0, 11.0), {}, result), "");
  EXPECT_TRUE(result.beams.empty());
}

TEST(ScanAssemblerTest, AScanWhoseLastBeamThePosesDoNotCoverIsDroppedWithItsReason) {
  AssembledScan result;
  result.beams.resize(5);
  const ScanAssembler assembler;
  EXPECT_EQ(assembler.assemble(scanAlongX(), stillPath(9.0, 10.008), {}, result), "");
  EXPECT_EQ(assembler.assemble(scanAlongX(), stillPath(9.0, 10.0079), {}, result), "no_transform");
  EXPECT_TRUE(result.beams.empty());
}

TEST(ScanAssemblerTest, ABlindSensorsScanDoesNotPassForOneThatSawNothing) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinity = std::numeric_limits<float>::infinity();
  LaserScan scan = scanAlongX();
  AssembledScan result;
  scan.ranges.assign(20, infinity);
  EXPECT_EQ(ScanAssembler{}.assemble(scan, stillPath(9.0, 11.0), {}, result), "");
  for (const float blind : {nan, -infinity, 0.0F}) {
    scan.ranges.assign(20, blind);
    scan.ranges[3] = infinity;
    EXPECT_EQ(ScanAssembler{}.assemble(scan, stillPath(9.0, 11.0), {}, result), "blind") << blind;
    EXPECT_TRUE(result.beams.empty());
    scan.ranges[4] = infinity;  // 18 of 20 are 0.9
    EXPECT_EQ(ScanAssembler{}.assemble(scan, stillPath(9.0, 11.0), {}, result), "") << blind;
  }
}

TEST(ScanAssemblerTest, AResultIsReusedFromScanToScan) {
  AssembledScan result;
  const ScanAssembler assembler;
  ASSERT_EQ(assembler.assemble(scanAlongX(), stillPath(9.0, 11.0), ballInFront(), result), "");
  const std::vector<K> first = kindsOf(result);
  ASSERT_EQ(assembler.assemble(scanAlongX(), stillPath(9.0, 11.0), ballInFront(), result), "");
  EXPECT_EQ(kindsOf(result), first);
}

TEST(ScanAssemblerTest, ABadConfigurationOfAnyStageIsRefused) {
  ScanAssembler config;
  config.scan_beams_max = 0;
  EXPECT_THROW(validated(config), ConfigError);
  config = {};
  config.mixed_pixel.separation_m = -1.0;
  EXPECT_THROW(validated(config), ConfigError);
  config = {};
  config.body.grazing_m = -1.0;
  EXPECT_THROW(validated(config), ConfigError);
}

}  // namespace
}  // namespace tccm
