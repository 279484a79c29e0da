#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "ros/conversions.h"
#include "scan/assembled_scan.h"

namespace tccm {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

Time at(double seconds) { return Time(fromSeconds(seconds)); }

LaserScan read(const sensor_msgs::LaserScan& message) {
  LaserScan scan;
  fromMessage(message, scan);
  return scan;
}

sensor_msgs::LaserScan scanMessage() {
  sensor_msgs::LaserScan message;
  message.header.stamp = ros::Time(12, 345);
  message.angle_min = -0.5F;
  message.angle_increment = 0.25F;
  message.time_increment = 1e-4F;
  message.range_min = 0.1F;
  message.range_max = 4.0F;
  message.ranges = {1.0F, 2.0F, 3.0F};
  return message;
}

TEST(LaserScanConversionTest, AScanKeepsItsNumbers) {
  const LaserScan scan = read(scanMessage());
  EXPECT_EQ(scan.stamp, Time(Duration(12000000345LL)));
  EXPECT_EQ(scan.angle_min, -0.5);
  EXPECT_EQ(scan.angle_increment, 0.25);
  EXPECT_NEAR(toSeconds(scan.time_increment), 1e-4, 1e-9);
  EXPECT_EQ(scan.ranges, scanMessage().ranges);
  EXPECT_EQ(defectOf(scan, 100), "");
}

TEST(LaserScanConversionTest, AnAbsurdTimeIncrementMakesADefectiveScan) {
  for (const double increment : {kNaN, kInf, -kInf, 1e30, -1e-4}) {
    sensor_msgs::LaserScan message = scanMessage();
    message.time_increment = static_cast<float>(increment);
    EXPECT_NE(defectOf(read(message), 100), "") << increment;
  }
}

TEST(LaserScanConversionTest, WithoutATimeIncrementAllBeamsAreAtTheStamp) {
  sensor_msgs::LaserScan message = scanMessage();
  message.time_increment = 0.0F;
  const LaserScan scan = read(message);
  EXPECT_EQ(defectOf(scan, 100), "");
  EXPECT_EQ(scan.lastBeamTime(), scan.stamp);
}

/// Beams of every kind; those that are kept lie at x = 1, 2, ...
AssembledScan assembledScan(std::size_t beams) {
  AssembledScan scan;
  scan.stamp = at(12.5);
  for (std::size_t i = 0; i < beams; ++i) {
    Beam beam;
    beam.stamp = scan.stamp;
    beam.p_fixed = Vector3(static_cast<double>(i + 1), 0.5, -0.25);
    beam.viewpoint = Vector3(0.0, static_cast<double>(i), 1.5);
    beam.tilt = 0.5 + static_cast<double>(i);
    beam.kind = static_cast<BeamKind>(i % kBeamKinds);
    scan.beams.push_back(beam);
  }
  return scan;
}

TEST(CloudConversionTest, OfAScanTheKeptPointsComeBack) {
  sensor_msgs::PointCloud2 cloud;
  toMessage(assembledScan(17), "base_link", cloud);
  EXPECT_EQ(cloud.header.frame_id, "base_link");
  EXPECT_EQ(cloud.width * cloud.height, 17U);
  EXPECT_EQ(cloud.row_step * cloud.height, cloud.data.size());
  ScanReturns returns;
  returns.points.emplace_back(9.0, 9.0, 9.0);  // of an earlier use
  ASSERT_EQ(fromMessage(cloud, returns), "");
  EXPECT_EQ(returns.stamp, at(12.5));
  EXPECT_EQ(returns.tilt, 0.5);
  EXPECT_EQ(returns.viewpoint, Vector3(0.0, 16.0, 1.5));
  ASSERT_EQ(returns.points.size(), 3U);
  EXPECT_EQ(returns.points[0], Vector3(1.0, 0.5, -0.25));
  EXPECT_EQ(returns.points[1], Vector3(9.0, 0.5, -0.25));
  EXPECT_EQ(returns.points[2], Vector3(17.0, 0.5, -0.25));
}

TEST(CloudConversionTest, AScanWithoutReturnsIsAScanAllTheSame) {
  AssembledScan scan = assembledScan(3);
  for (Beam& beam : scan.beams) beam.kind = BeamKind::kNoReturn;
  sensor_msgs::PointCloud2 cloud;
  toMessage(scan, "base_link", cloud);
  ScanReturns returns;
  ASSERT_EQ(fromMessage(cloud, returns), "");
  EXPECT_TRUE(returns.points.empty());
  EXPECT_EQ(returns.viewpoint, Vector3(0.0, 2.0, 1.5));
}

TEST(CloudConversionTest, AMessageThatIsUsedAgainHoldsTheNewScanAlone) {
  sensor_msgs::PointCloud2 cloud;
  toMessage(assembledScan(100), "base_link", cloud);
  toMessage(assembledScan(2), "base_link", cloud);
  ScanReturns returns;
  ASSERT_EQ(fromMessage(cloud, returns), "");
  EXPECT_EQ(returns.points.size(), 1U);
  EXPECT_EQ(cloud.data.size(), 2U * cloud.point_step);
}

TEST(CloudConversionTest, ACloudThatLacksAFieldIsRefusedNamingIt) {
  for (const char* const name : {"x", "y", "z", "vp_x", "vp_y", "vp_z", "tilt"}) {
    sensor_msgs::PointCloud2 cloud;
    toMessage(assembledScan(3), "base_link", cloud);
    for (auto& field : cloud.fields) {
      if (field.name == name) field.name = "other";
    }
    ScanReturns returns;
    EXPECT_NE(fromMessage(cloud, returns).find(std::string("'") + name + "'"), std::string::npos);
  }
}

TEST(CloudConversionTest, AFieldOfAnotherTypeIsRefused) {
  sensor_msgs::PointCloud2 cloud;
  toMessage(assembledScan(3), "base_link", cloud);
  cloud.fields[1].datatype = sensor_msgs::PointField::FLOAT64;
  ScanReturns returns;
  EXPECT_NE(fromMessage(cloud, returns), "");
}

TEST(CloudConversionTest, ACloudThatDoesNotHoldWhatItSaysIsRefused) {
  sensor_msgs::PointCloud2 whole;
  toMessage(assembledScan(3), "base_link", whole);
  ScanReturns returns;
  sensor_msgs::PointCloud2 cloud = whole;
  cloud.data.pop_back();
  EXPECT_NE(fromMessage(cloud, returns), "");
  cloud = whole;
  cloud.width = 0;
  EXPECT_NE(fromMessage(cloud, returns), "");
  cloud = whole;
  cloud.is_bigendian = true;
  EXPECT_NE(fromMessage(cloud, returns), "");
  EXPECT_NE(fromMessage(sensor_msgs::PointCloud2(), returns), "");
}

TEST(CloudConversionTest, FieldsThatReachBeyondAPointAreRefused) {
  sensor_msgs::PointCloud2 cloud;
  toMessage(assembledScan(3), "base_link", cloud);
  ScanReturns returns;
  cloud.fields[2].offset = cloud.point_step - 2;
  EXPECT_NE(fromMessage(cloud, returns), "");
  toMessage(assembledScan(3), "base_link", cloud);
  cloud.point_step = 0;
  EXPECT_NE(fromMessage(cloud, returns), "");
}

}  // namespace
}  // namespace tccm
