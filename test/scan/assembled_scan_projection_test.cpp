#include <gtest/gtest.h>
#include <laser_geometry/laser_geometry.h>
#include <sensor_msgs/point_cloud2_iterator.h>
#include <tf2/buffer_core.h>

#include <cmath>
#include <limits>

#include "scan/assembled_scan.h"
#include "support/near.h"
#include "support/random.h"

namespace tccm {
namespace {

using K = BeamKind;
using test::isNearly;

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

Time atSeconds(double seconds) { return Time(fromSeconds(seconds)); }

LaserScan scanOf(std::vector<float> ranges, double time_increment = 0.0) {
  LaserScan scan;
  scan.stamp = atSeconds(100.0);
  scan.angle_min = -1.0;
  scan.angle_increment = 0.01;
  scan.time_increment = fromSeconds(time_increment);
  scan.range_min = 0.1F;
  scan.range_max = 4.0F;
  scan.ranges = std::move(ranges);
  return scan;
}

PosePath still(const Pose& pose) {
  PosePath path;
  EXPECT_TRUE(path.add(atSeconds(99.0), pose));
  EXPECT_TRUE(path.add(atSeconds(101.0), pose));
  return path;
}

AssembledScan projected(const LaserScan& scan, const PosePath& path) {
  AssembledScan result;
  EXPECT_TRUE(project(scan, path, result));
  EXPECT_EQ(result.beams.size(), scan.ranges.size());
  EXPECT_EQ(result.stamp, scan.stamp);
  return result;
}

LaserScan randomScan(test::Random& random, double time_increment) {
  LaserScan scan = scanOf({}, time_increment);
  for (int i = 0; i < 200; ++i) scan.ranges.push_back(static_cast<float>(random.uniform(0.0, 4.5)));
  return scan;
}

sensor_msgs::LaserScan toMessage(const LaserScan& scan) {
  sensor_msgs::LaserScan message;
  message.header.frame_id = "laser";
  message.header.stamp.fromSec(toSeconds(scan.stamp));
  message.angle_min = static_cast<float>(scan.angle_min);
  message.angle_increment = static_cast<float>(scan.angle_increment);
  message.angle_max = message.angle_min + 199.0F * message.angle_increment;
  message.time_increment = static_cast<float>(toSeconds(scan.time_increment));
  message.range_min = static_cast<float>(scan.range_min);
  message.range_max = static_cast<float>(scan.range_max);
  message.ranges = scan.ranges;
  return message;
}

/// The message's angles and increments are floats: take them back, so that both project the same.
LaserScan roundedToFloat(LaserScan scan) {
  scan.angle_min = static_cast<float>(scan.angle_min);
  scan.angle_increment = static_cast<float>(scan.angle_increment);
  return scan;
}

/// The cloud leaves out what is no return, in the order of the beams. @param tolerance [m]
void expectSamePoints(const AssembledScan& scan, const sensor_msgs::PointCloud2& cloud,
                      double tolerance) {
  sensor_msgs::PointCloud2ConstIterator<float> x(cloud, "x");
  for (const Beam& beam : scan.beams) {
    if (beam.kind != K::kReturn) continue;
    ASSERT_TRUE(x != x.end());
    ASSERT_TRUE(isNearly(beam.p_fixed, Vector3(x[0], x[1], x[2]), tolerance));
    ++x;
  }
  EXPECT_FALSE(x != x.end());
}

TEST(ProjectionTest, RangesAreSortedByRep117AndTheLimits) {
  const LaserScan scan =
      scanOf({1.0F, kInfinity, -kInfinity, kNaN, 0.05F, 0.1F, 4.0F, 3.999F, 4.5F, -1.0F, 1000.0F});
  const AssembledScan result = projected(scan, still(Pose::Identity()));
  const std::vector<K> expected = {K::kReturn,   K::kNoReturn, K::kTooClose, K::kUnknown,
                                   K::kTooClose, K::kReturn,   K::kNoReturn, K::kReturn,
                                   K::kUnknown,  K::kTooClose, K::kUnknown};
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_EQ(result.beams[i].kind, expected[i]) << "range " << scan.ranges[i];
  }
}

TEST(ProjectionTest, ARangeOfZeroIsNoneAlsoWhereRangesMayBeAsShort) {
  LaserScan scan = scanOf({0.0F, 0.001F});
  scan.range_min = 0.0;
  const AssembledScan result = projected(scan, still(Pose::Identity()));
  EXPECT_EQ(result.beams[0].kind, K::kTooClose);
  EXPECT_EQ(result.beams[1].kind, K::kReturn);
}

TEST(ProjectionTest, ARangeAtALimitThatNoDoubleNamesExactlyIsStillAtTheLimit) {
  LaserScan scan = scanOf({5.6F, std::nextafter(5.6F, 0.0F)});
  scan.range_max = 5.6;  // below the float's value
  const AssembledScan result = projected(scan, still(Pose::Identity()));
  EXPECT_EQ(result.beams[0].kind, K::kNoReturn);
  EXPECT_EQ(result.beams[1].kind, K::kReturn);
}

TEST(ProjectionTest, AStandingSensorGivesPlainPolarCoordinatesInTheFixedFrame) {
  Pose pose(Eigen::AngleAxisd(0.5 * M_PI, Vector3::UnitZ()));
  pose.translation() = Vector3(1.0, 2.0, 3.0);
  LaserScan scan = scanOf({2.0F, 2.0F});
  scan.angle_min = 0.0;
  scan.angle_increment = -0.5 * M_PI;
  const AssembledScan result = projected(scan, still(pose));
  EXPECT_TRUE(isNearly(result.beams[0].p_fixed, {1.0, 4.0, 3.0}, 1e-9));
  EXPECT_TRUE(isNearly(result.beams[1].p_fixed, {3.0, 2.0, 3.0}, 1e-9));
  EXPECT_TRUE(isNearly(result.beams[1].viewpoint, {1.0, 2.0, 3.0}, 0.0));
}

TEST(ProjectionTest, TheTiltIsTheElevationOfTheSensorsXAxis) {
  const Pose down(Eigen::AngleAxisd(0.3, Vector3::UnitY()));  // x towards the floor
  EXPECT_NEAR(projected(scanOf({1.0F}), still(down)).beams[0].tilt, -0.3, 1e-12);
  const Pose turned(Eigen::AngleAxisd(1.0, Vector3::UnitZ()) *
                    Eigen::AngleAxisd(-0.4, Vector3::UnitY()));
  EXPECT_NEAR(projected(scanOf({1.0F}), still(turned)).beams[0].tilt, 0.4, 1e-12);
}

/// The sensor turns about its z axis by 2 rad/s and moves along z by 0.5 m/s.
TEST(ProjectionTest, EachBeamOfAMovingSensorIsProjectedAtItsOwnTime) {
  PosePath path;
  for (int i = 0; i <= 20; ++i) {
    const double t = -0.1 + 0.05 * i;
    Pose pose(Eigen::AngleAxisd(2.0 * t, Vector3::UnitZ()));
    pose.translation() = Vector3(0.0, 0.0, 0.5 * t);
    ASSERT_TRUE(path.add(atSeconds(100.0 + t), pose));
  }
  const LaserScan scan = scanOf(std::vector<float>(500, 2.0F), 0.001);
  const AssembledScan result = projected(scan, path);
  for (std::size_t i = 0; i < result.beams.size(); ++i) {
    const double t = 0.001 * static_cast<double>(i);
    const double angle = scan.angle_min + static_cast<double>(i) * scan.angle_increment + 2.0 * t;
    ASSERT_TRUE(isNearly(result.beams[i].p_fixed,
                         {2.0 * std::cos(angle), 2.0 * std::sin(angle), 0.5 * t}, 1e-9));
    ASSERT_TRUE(isNearly(result.beams[i].viewpoint, {0.0, 0.0, 0.5 * t}, 1e-9));
    ASSERT_EQ(result.beams[i].stamp, scan.stamp + fromSeconds(t));
  }
}

TEST(ProjectionTest, WithoutTimeIncrementAllBeamsTakeTheStampsPose) {
  PosePath path;
  ASSERT_TRUE(path.add(atSeconds(99.0), Pose::Identity()));
  Pose moved = Pose::Identity();
  moved.translation().x() = 2.0;
  ASSERT_TRUE(path.add(atSeconds(101.0), moved));
  for (const Beam& beam : projected(scanOf({1.0F, 1.0F, 1.0F}), path).beams) {
    EXPECT_TRUE(isNearly(beam.viewpoint, {1.0, 0.0, 0.0}, 1e-9));
    EXPECT_EQ(beam.stamp, atSeconds(100.0));
  }
}

TEST(ProjectionTest, AScanThatThePosesDoNotCoverIsNotGuessed) {
  AssembledScan result;
  result.beams.resize(3);
  EXPECT_FALSE(project(scanOf({1.0F}), PosePath(), result));
  EXPECT_TRUE(result.beams.empty());
  PosePath path;
  ASSERT_TRUE(path.add(atSeconds(100.0), Pose::Identity()));
  ASSERT_TRUE(path.add(atSeconds(100.01), Pose::Identity()));
  EXPECT_TRUE(project(scanOf(std::vector<float>(11, 1.0F), 0.001), path, result));
  result.beams.resize(3);
  EXPECT_FALSE(project(scanOf(std::vector<float>(12, 1.0F), 0.001), path, result));
  EXPECT_TRUE(result.beams.empty());
}

/// laser_geometry's clouds are floats: 1e-6 of a few metres.
TEST(ProjectionTest, AStandingSensorAgreesWithLaserGeometry) {
  test::Random random(15);
  laser_geometry::LaserProjection projection;
  for (int i = 0; i < 20; ++i) {
    LaserScan scan = roundedToFloat(randomScan(random, 0.0));
    scan.ranges[10] = kNaN;
    scan.ranges[20] = kInfinity;
    sensor_msgs::PointCloud2 cloud;
    projection.projectLaser(toMessage(scan), cloud);
    expectSamePoints(projected(scan, still(Pose::Identity())), cloud, 2e-6);
  }
}

geometry_msgs::TransformStamped toTransform(Time stamp, const Pose& pose) {
  geometry_msgs::TransformStamped message;
  message.header.frame_id = "fixed";
  message.child_frame_id = "laser";
  message.header.stamp.fromSec(toSeconds(stamp));
  const Eigen::Quaterniond q(pose.linear());
  message.transform.rotation.x = q.x();
  message.transform.rotation.y = q.y();
  message.transform.rotation.z = q.z();
  message.transform.rotation.w = q.w();
  message.transform.translation.x = pose.translation().x();
  message.transform.translation.y = pose.translation().y();
  message.transform.translation.z = pose.translation().z();
  return message;
}

/// laser_geometry interpolates between the poses at the first and the last beam, which is exact for
/// a straight and even motion; it computes in floats: 1e-5 of a few metres.
TEST(ProjectionTest, AMovingSensorAgreesWithLaserGeometryAndTf) {
  test::Random random(16);
  laser_geometry::LaserProjection projection;
  for (int i = 0; i < 20; ++i) {
    const LaserScan scan = roundedToFloat(randomScan(random, 0.0005));
    const Pose before = random.pose(1.0);
    Pose after = before * Pose(Eigen::AngleAxisd(0.15, random.direction()));
    after.translation() += random.point(0.2);
    PosePath path;
    tf2::BufferCore buffer;
    for (const auto& [stamp, pose] :
         {std::pair(atSeconds(99.9), before), std::pair(atSeconds(100.2), after)}) {
      ASSERT_TRUE(path.add(stamp, pose));
      ASSERT_TRUE(buffer.setTransform(toTransform(stamp, pose), "test"));
    }
    sensor_msgs::PointCloud2 cloud;
    projection.transformLaserScanToPointCloud("fixed", toMessage(scan), cloud, buffer);
    expectSamePoints(projected(scan, path), cloud, 1e-5);
  }
}

TEST(DefectTest, ASoundScanHasNone) {
  EXPECT_EQ(defectOf(scanOf({1.0F}), 1), "");
  LaserScan backwards = scanOf({1.0F, kNaN});
  backwards.angle_increment = -0.01;
  EXPECT_EQ(defectOf(backwards, 10), "");
}

TEST(DefectTest, NoBeamsAndTooManyBeamsAreNamed) {
  EXPECT_NE(defectOf(scanOf({}), 10).find("no beams"), std::string::npos);
  EXPECT_EQ(defectOf(scanOf({1.0F, 1.0F}), 2), "");
  EXPECT_NE(defectOf(scanOf({1.0F, 1.0F, 1.0F}), 2).find("scan_beams_max"), std::string::npos);
}

void expectDefect(double LaserScan::*field, double value, const std::string& word) {
  LaserScan scan = scanOf({1.0F});
  scan.*field = value;
  EXPECT_NE(defectOf(scan, 10).find(word), std::string::npos)
      << value << " gives '" << defectOf(scan, 10) << "'";
}

TEST(DefectTest, AnglesThatAreNotFiniteAreNamed) {
  for (const double bad : {std::nan(""), HUGE_VAL, -HUGE_VAL}) {
    expectDefect(&LaserScan::angle_min, bad, "angle_min");
    expectDefect(&LaserScan::angle_increment, bad, "angle_increment");
  }
}

TEST(DefectTest, RangeLimitsThatContradictOrAreNotFiniteAreNamed) {
  for (const double bad : {std::nan(""), HUGE_VAL, -HUGE_VAL, -0.1, 4.0, 5.0}) {
    expectDefect(&LaserScan::range_min, bad, "range_min");
  }
  for (const double bad : {std::nan(""), HUGE_VAL, -HUGE_VAL, 0.0, 0.05}) {
    expectDefect(&LaserScan::range_max, bad, "range_max");
  }
}

TEST(DefectTest, WhatNoFloatHoldsIsNoRangeAndNoAngle) {
  expectDefect(&LaserScan::range_max, 1e39, "range_max");
  LaserScan scan = scanOf({1.0F, 1.0F, 1.0F});
  scan.angle_increment = 1e308;
  EXPECT_NE(defectOf(scan, 10).find("last beam"), std::string::npos) << defectOf(scan, 10);
  scan.angle_increment = 0.01;
  scan.range_max = static_cast<double>(std::numeric_limits<float>::max());
  EXPECT_EQ(defectOf(scan, 10), "");
}

TEST(DefectTest, ANegativeTimeIncrementIsNamed) {
  EXPECT_NE(defectOf(scanOf({1.0F}, -0.001), 10).find("time_increment"), std::string::npos);
}

TEST(DefectTest, AScanThatTakesLongerThanASecondIsNamed) {
  EXPECT_EQ(defectOf(scanOf({1.0F, 1.0F, 1.0F}, 0.5), 10), "");
  const std::string defect = defectOf(scanOf({1.0F, 1.0F, 1.0F}, 0.51), 10);
  EXPECT_NE(defect.find("at most 1 s"), std::string::npos) << defect;
}

/// As drivers send it: rounded to floats, the last beam's angle or the end of the field of view.
LaserScan saidScan(test::Random& random) {
  LaserScan scan = scanOf({});
  const int beams = random.integer(2, 1500);
  const double step = (random.chance(0.2) ? -1.0 : 1.0) * random.uniform(0.001, 0.05);
  scan.angle_min = static_cast<float>(random.uniform(-3.2, 3.2));
  scan.angle_increment = static_cast<float>(step);
  scan.angle_max = static_cast<float>(scan.angle_min + (beams - 1) * step);
  scan.ranges.assign(static_cast<std::size_t>(beams), 1.0F);
  return scan;
}

TEST(DefectTest, AnglesThatDiffersByOneIncrementAreWhatDriversSend) {
  test::Random random(5);
  for (int neighbour = 0; neighbour < 200; ++neighbour) {
    LaserScan scan = saidScan(random);
    EXPECT_EQ(defectOf(scan, 2000), "");
    const double said = *scan.angle_max;
    for (const double increments : {-1.0, -0.5, 0.5, 1.0}) {
      scan.angle_max = static_cast<float>(said + increments * scan.angle_increment);
      EXPECT_EQ(defectOf(scan, 2000), "") << increments;
    }
    scan.angle_max.reset();
    EXPECT_EQ(defectOf(scan, 2000), "") << "not said";
  }
}

TEST(DefectTest, AnglesThatContradictEachOtherAreNamedWithTheirFigures) {
  test::Random random(6);
  for (int member = 0; member < 200; ++member) {
    LaserScan scan = saidScan(random);
    switch (member % 4) {
      case 0:
        scan.angle_increment *= random.chance(0.5) ? 180.0 / M_PI : M_PI / 180.0;
        break;
      case 1:
        scan.ranges.resize(scan.ranges.size() * 2 + 2, 1.0F);
        break;
      case 2:
        scan.angle_min -= 3.0 * std::abs(scan.angle_increment) + random.uniform(0.0, 1.0);
        break;
      default:
        *scan.angle_max += 3.0 * scan.angle_increment;
        break;
    }
    const std::string defect = defectOf(scan, 4000);
    for (const char* const word : {"angle_min", "angle_increment", "angle_max", "beams"}) {
      EXPECT_NE(defect.find(word), std::string::npos) << member << ": " << defect;
    }
  }
}

TEST(DefectTest, AnAngleMaxThatIsNotFiniteIsNamed) {
  LaserScan scan = scanOf({1.0F, 1.0F});
  for (const double bad : {std::nan(""), HUGE_VAL, -HUGE_VAL}) {
    scan.angle_max = bad;
    EXPECT_NE(defectOf(scan, 10).find("angle_max"), std::string::npos);
  }
}

}  // namespace
}  // namespace tccm
