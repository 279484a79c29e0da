#include "ros/cloud_reader.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <functional>
#include <iterator>

#include "ros/conversions.h"
#include "scan/scan_assembler.h"
#include "support/driver_clouds.h"
#include "support/random.h"
#include "support/refusal.h"

namespace tccm {
namespace {

using sensor_msgs::PointCloud2;
using sensor_msgs::PointField;
using test::addField;
using test::DriverCloud;
using test::names;
using test::put;
using test::Random;

const CloudReader kReader{CloudLimits{}};

std::string refusalOf(const PointCloud2& message, const CloudReader& reader = kReader) {
  Cloud cloud;
  std::string defect = reader.read(message, cloud);
  EXPECT_EQ(defect.find('\n'), std::string::npos) << defect;
  return defect;
}

TEST(CloudReaderTest, OfEachDriverPointsAndTimesAreRead) {
  for (const DriverCloud& driver : test::driverClouds()) {
    Cloud cloud;
    ASSERT_EQ(kReader.read(driver.message, cloud), "") << driver.driver;
    EXPECT_EQ(cloud.stamp, Time(std::chrono::nanoseconds(1700000000250000000LL)));
    EXPECT_EQ(cloud.width, driver.message.width);
    EXPECT_EQ(cloud.height, driver.message.height);
    ASSERT_EQ(cloud.points.size(), driver.points.size()) << driver.driver;
    ASSERT_EQ(cloud.offsets_s.size(), driver.offsets_s.size()) << driver.driver;
    for (std::size_t i = 0; i < cloud.points.size(); ++i) {
      ASSERT_EQ(isMeasured(cloud.points[i]), isMeasured(driver.points[i])) << driver.driver << i;
      if (!isMeasured(cloud.points[i])) continue;
      ASSERT_EQ(cloud.points[i], driver.points[i]) << driver.driver << i;
      if (driver.offsets_s.empty()) continue;
      ASSERT_NEAR(cloud.offsets_s[i], driver.offsets_s[i], 2e-6) << driver.driver << i;
    }
    const auto& times = driver.offsets_s;
    const double first = times.empty() ? 0.0 : *std::min_element(times.begin(), times.end());
    const double last = times.empty() ? 0.0 : *std::max_element(times.begin(), times.end());
    EXPECT_NEAR(toSeconds(cloud.first() - cloud.stamp), first, 2e-4) << driver.driver;
    EXPECT_NEAR(toSeconds(cloud.last() - cloud.stamp), last, 2e-4) << driver.driver;
  }
}

TEST(CloudReaderTest, ThePageOnSensorsHasEachDriversFieldsAndTime) {
  std::ifstream file(std::string(TCCM_SOURCE_DIR) + "/docs/sensors.md");
  std::vector<std::string> rows;
  for (std::string line; std::getline(file, line);) {
    if (line.rfind("| ", 0) == 0) rows.push_back(line);
  }
  const std::pair<const char*, DriverCloud> drivers[] = {
      {"| RealSense |", test::realSenseCloud()},
      {"| Kinect |", test::kinectCloud()},
      {"| any depth image |", test::depthImageCloud()},
      {"| Velodyne |", test::velodyneCloud()},
      {"| Ouster |", test::ousterCloud()},
      {"| Livox |", test::livoxCloud()},
      {"| Hesai, RoboSense |", test::hesaiCloud()}};
  for (const auto& [begin, driver] : drivers) {
    std::string fields = "|", time = "none: all at the stamp";
    for (const PointField& field : driver.message.fields) {
      fields += " " + field.name;
      if (field.name[0] == 't' && field.name != "tag") time = "`" + field.name + "`";
    }
    const auto row = std::find_if(
        rows.begin(), rows.end(),
        [begin = begin](const std::string& line) { return line.rfind(begin, 0) == 0; });
    ASSERT_NE(row, rows.end()) << begin;
    fields.append(" | ").append(time);
    EXPECT_NE(row->find(fields), std::string::npos) << *row << "\nshould have " << fields;
  }
}

/// As urg_node writes it for a UTM-30LX, the tilting Hokuyo's row: no cloud, but a scan.
TEST(CloudReaderTest, ThePageOnSensorsHasTheTiltingHokuyosScanAndTimes) {
  sensor_msgs::LaserScan message;
  message.header.stamp = ros::Time(1700000000, 250000000);
  message.angle_min = -2.35619F;
  message.angle_max = 2.35619F;
  message.angle_increment = 0.00436332F;
  message.time_increment = 1.7361e-05F;
  message.scan_time = 0.025F;
  message.range_min = 0.023F;
  message.range_max = 60.0F;
  message.ranges.assign(1081, 2.0F);
  message.intensities.assign(1081, 700.0F);
  LaserScan scan;
  fromMessage(message, scan);
  EXPECT_EQ(defectOf(scan, ScanAssembler().scan_beams_max), "");
  EXPECT_NEAR(toSeconds(scan.lastBeamTime() - scan.stamp), 1080 * 1.7361e-05, 1e-6);
  std::ifstream file(std::string(TCCM_SOURCE_DIR) + "/docs/sensors.md");
  const std::string page{std::istreambuf_iterator<char>(file), {}};
  EXPECT_NE(page.find("a LaserScan | `time_increment` | 0: measured | `TiltScanAssembler`"),
            std::string::npos);
}

TEST(CloudReaderTest, WhatIsNoTimeIsRefusedHoweverManyChannelsThereMayBe) {
  DriverCloud cloud = test::unorganisedOusterCloud();
  Random random(3);
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    put(cloud.message, i, 20, static_cast<std::uint32_t>(random.integer(0, 99000000)));
  }
  EXPECT_NE(refusalOf(cloud.message).find("times have to rise"), std::string::npos);
}

/// A small cloud of any layout: fields in any order, gaps and padding, float32 or float64, with
/// or without a time of any kind that is understood.
struct AnyCloud {
  PointCloud2 message;
  std::vector<Eigen::Vector3f> points;
  std::string time;
};

AnyCloud anyCloud(Random& random) {
  AnyCloud any;
  PointCloud2& message = any.message;
  const std::uint8_t type = random.chance(0.5) ? test::kF32 : test::kF64;
  struct Wanted {
    std::string name;
    std::uint8_t type;
    std::uint32_t size;
  };
  const std::uint32_t size = type == test::kF32 ? 4 : 8;
  std::vector<Wanted> wanted{{"x", type, size}, {"y", type, size}, {"z", type, size}};
  const int clock = random.integer(0, 4);
  const Wanted times[] = {{"t", test::kU32, 4},
                          {"time", test::kF32, 4},
                          {"timestamp", test::kF64, 8},
                          {"offset_time", test::kU32, 4}};
  if (clock < 4) wanted.push_back(times[clock]);
  if (clock < 4) any.time = times[clock].name;
  if (random.chance(0.5)) wanted.push_back({"ring", test::kU16, 2});
  if (random.chance(0.5)) wanted.push_back({"intensity", test::kF32, 4});
  for (std::size_t i = wanted.size() - 1; i > 0; --i) {
    std::swap(wanted[i], wanted[static_cast<std::size_t>(random.integer(0, static_cast<int>(i)))]);
  }
  std::uint32_t offset = 0;
  for (const Wanted& field : wanted) {
    offset += static_cast<std::uint32_t>(random.integer(0, 5));
    addField(message, field.name, offset, field.type,
             static_cast<std::uint32_t>(random.integer(0, 1)));
    offset += field.size;
  }
  message.point_step = offset + static_cast<std::uint32_t>(random.integer(0, 9));
  message.width = static_cast<std::uint32_t>(random.integer(1, 20));
  message.height = random.chance(0.5) ? 1 : static_cast<std::uint32_t>(random.integer(2, 10));
  message.row_step = message.width * message.point_step +
                     (random.chance(0.5) ? 0 : static_cast<std::uint32_t>(random.integer(1, 30)));
  message.data.resize(static_cast<std::size_t>(message.row_step) * message.height);
  message.header.stamp = ros::Time(1700000000, 0);
  return any;
}

void fill(AnyCloud& any, Random& random) {
  PointCloud2& message = any.message;
  const auto at = [&message](std::size_t i, std::uint32_t offset) {
    return &message.data[i / message.width * message.row_step +
                         i % message.width * message.point_step + offset];
  };
  const double span = random.uniform(0.0, 0.15), start = random.uniform(-0.04, 0.04);
  for (std::size_t i = 0; i < static_cast<std::size_t>(message.width) * message.height; ++i) {
    const Vector3 p = random.point(3.0);
    any.points.push_back(p.cast<float>());
    // Channels of one firing are stamped to and fro by less than a millisecond.
    const double late = start + span * static_cast<double>(i % message.width) / message.width +
                        random.uniform(0.0, 9e-4);
    for (const PointField& field : message.fields) {
      const int axis = field.name == "x" ? 0 : field.name == "y" ? 1 : field.name == "z" ? 2 : -1;
      if (axis >= 0 && field.datatype == test::kF32) {
        std::memcpy(at(i, field.offset), &any.points.back()[axis], 4);
      } else if (axis >= 0) {
        std::memcpy(at(i, field.offset), &p[axis], 8);
      } else if (field.name == "t" || field.name == "offset_time") {
        const auto nanoseconds = static_cast<std::uint32_t>(1e9 * std::max(0.0, late));
        std::memcpy(at(i, field.offset), &nanoseconds, 4);
      } else if (field.name == "time") {
        const auto seconds = static_cast<float>(late);
        std::memcpy(at(i, field.offset), &seconds, 4);
      } else if (field.name == "timestamp") {
        const double seconds = 1700000000.0 + late;
        std::memcpy(at(i, field.offset), &seconds, 8);
      }
    }
  }
}

TEST(CloudReaderTest, AnyLayoutAndOrderOfFieldsIsRead) {
  for (unsigned seed = 0; seed < 200; ++seed) {
    Random random(seed);
    AnyCloud any = anyCloud(random);
    fill(any, random);
    Cloud cloud;
    ASSERT_EQ(kReader.read(any.message, cloud), "") << seed;
    ASSERT_EQ(cloud.points, any.points) << seed;
    EXPECT_EQ(cloud.offsets_s.empty(), any.time.empty()) << seed;
    EXPECT_LE(toSeconds(cloud.last() - cloud.first()), 0.2) << seed;
  }
}

TEST(CloudReaderTest, EachWrongLayoutIsRefusedByALineThatNamesIt) {
  struct Wrong {
    const char* named;
    std::function<void(PointCloud2&, Random&)> make;
  };
  const auto any_of_xyz = [](PointCloud2& m, Random& random) -> PointField& {
    const std::string name(1, static_cast<char>('x' + random.integer(0, 2)));
    return *std::find_if(m.fields.begin(), m.fields.end(),
                         [&](const PointField& field) { return field.name == name; });
  };
  const std::vector<Wrong> wrongs{
      {"big-endian", [](PointCloud2& m, Random&) { m.is_bigendian = true; }},
      {"has no field",
       [&](PointCloud2& m, Random& random) { any_of_xyz(m, random).name = "intensity"; }},
      {"two fields",
       [&](PointCloud2& m, Random& random) {
         const PointField twice = any_of_xyz(m, random);
         m.fields.push_back(twice);
       }},
      {"float32, or all float64",
       [&](PointCloud2& m, Random& random) {
         any_of_xyz(m, random).datatype = static_cast<std::uint8_t>(random.integer(1, 6));
       }},
      {"values a point",
       [&](PointCloud2& m, Random& random) {
         any_of_xyz(m, random).count = static_cast<std::uint32_t>(random.integer(2, 1000000));
       }},
      {"point_step",
       [&](PointCloud2& m, Random& random) {
         any_of_xyz(m, random).offset =
             m.point_step - static_cast<std::uint32_t>(random.integer(0, 3));
       }},
      {"point_step",
       [&](PointCloud2& m, Random& random) { any_of_xyz(m, random).offset = 0xFFFFFFFFU; }},
      {"overlap",
       [&](PointCloud2& m, Random& random) {
         PointField& field = any_of_xyz(m, random);
         field.offset = any_of_xyz(m, random).offset;
         if (field.name != "x") return;
         for (PointField& other : m.fields) {
           if (other.name == "z") field.offset = other.offset;
         }
       }},
      {"bytes", [](PointCloud2& m, Random&) { m.data.pop_back(); }},
      {"bytes",
       [](PointCloud2& m, Random& random) {
         m.data.resize(m.data.size() + static_cast<std::size_t>(random.integer(1, 100)));
       }},
      {"bytes", [](PointCloud2& m, Random&) { m.height += 1; }},
      {"no points", [](PointCloud2& m, Random&) { m.width = 0; }},
      {"cloud_points_max", [](PointCloud2& m, Random&) { m.width = 0xFFFFFFFFU; }},
      {"cloud_points_max", [](PointCloud2& m, Random&) { m.height = m.width = 0x10000U; }},
      {"time that is understood",
       [](PointCloud2& m, Random& random) {
         const char* names[] = {"time_us", "stamp", "t", "ts", "timestampSec"};
         addField(m, names[random.integer(0, 4)], 0, test::kF32);
       }},
      {"two fields of time", [](PointCloud2& m, Random&) {
         addField(m, "t", 0, test::kU32);
         addField(m, "time", 0, test::kF32);
       }}};
  for (std::size_t kind = 0; kind < wrongs.size(); ++kind) {
    int made = 0;
    for (unsigned seed = 0; made < 20; ++seed) {
      Random random(seed);
      AnyCloud any = anyCloud(random);
      if (!any.time.empty()) continue;
      any.message.row_step = any.message.width * any.message.point_step;
      any.message.data.resize(static_cast<std::size_t>(any.message.row_step) * any.message.height);
      fill(any, random);
      ASSERT_EQ(refusalOf(any.message), "") << kind << " " << seed;
      const PointCloud2 healthy = any.message;
      wrongs[kind].make(any.message, random);
      if (kind == 7 && any.message.fields == healthy.fields) continue;  // a field over itself
      EXPECT_TRUE(names(refusalOf(any.message), wrongs[kind].named))
          << wrongs[kind].named << ": " << refusalOf(any.message);
      ++made;
    }
  }
}

/// A lidar's turn of 0.1 s, unorganised.
DriverCloud turn(const std::function<double(std::size_t)>& time) {
  DriverCloud cloud = test::velodyneCloud();
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    put(cloud.message, i, 18, static_cast<float>(time(i)));
  }
  return cloud;
}

TEST(CloudReaderTest, TimesThatCannotBeAreRefused) {
  const double n = static_cast<double>(test::velodyneCloud().points.size());
  for (unsigned seed = 0; seed < 20; ++seed) {
    Random random(seed);
    const double too_long = random.uniform(0.201, 1e5);
    EXPECT_TRUE(names(refusalOf(turn([&](std::size_t i) {
                                  return too_long * static_cast<double>(i) / n;
                                }).message),
                      "cloud_duration_max_s"));
    const double away = (random.chance(0.5) ? 1.0 : -1.0) * random.uniform(0.301, 1e9);
    EXPECT_TRUE(names(refusalOf(turn([&](std::size_t i) {
                                  return away + 0.1 * static_cast<double>(i) / n;
                                }).message),
                      "cloud_duration_max_s"));
    EXPECT_TRUE(
        names(refusalOf(turn([&](std::size_t) { return random.uniform(0.0, 0.1); }).message),
              "have to rise"));
    const auto broken = static_cast<std::size_t>(17 * random.integer(1, 1000));
    EXPECT_TRUE(names(refusalOf(turn([&](std::size_t i) {
                                  return i == broken ? std::nan("")
                                                     : 0.1 * static_cast<double>(i) / n;
                                }).message),
                      "not finite"));
  }
}

TEST(CloudReaderTest, TimesThatJitterOrGoBeforeTheStampAreRead) {
  const double n = static_cast<double>(test::velodyneCloud().points.size());
  for (unsigned seed = 0; seed < 20; ++seed) {
    Random random(seed);
    const double duration = random.uniform(0.0, 0.199), start = -random.uniform(0.0, duration);
    EXPECT_EQ(refusalOf(turn([&](std::size_t i) {
                          return start + (duration - 1e-3) * static_cast<double>(i) / n +
                                 random.uniform(0.0, 9e-4);
                        }).message),
              "")
        << seed;
  }
}

TEST(CloudReaderTest, AbsoluteTimesFarFromTheStampAreRefused) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    Random random(seed);
    DriverCloud livox = test::livoxCloud();
    const double away = (random.chance(0.5) ? 1.0 : -1.0) * random.uniform(0.4, 1e6);
    livox.message.header.stamp = ros::Time(1700000000.25 + away);
    EXPECT_TRUE(names(refusalOf(livox.message), "'timestamp' (float64)")) << away;
  }
}

TEST(CloudReaderTest, AFullBufferIsUsedAgain) {
  const DriverCloud large = test::ousterCloud(), small = test::livoxCloud();
  Cloud cloud;
  ASSERT_EQ(kReader.read(large.message, cloud), "");
  const auto* const points = cloud.points.data();
  const auto* const times = cloud.offsets_s.data();
  ASSERT_EQ(kReader.read(small.message, cloud), "");
  EXPECT_EQ(cloud.points.size(), small.points.size());
  ASSERT_EQ(kReader.read(test::realSenseCloud().message, cloud), "");
  EXPECT_TRUE(cloud.offsets_s.empty());
  ASSERT_EQ(kReader.read(large.message, cloud), "");
  EXPECT_EQ(cloud.offsets_s.data(), times);
  EXPECT_NE(points, nullptr);
}

}  // namespace
}  // namespace tccm
