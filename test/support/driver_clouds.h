#pragma once

#include <sensor_msgs/PointCloud2.h>

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

namespace tccm::test {

/// Clouds as drivers lay them out; docs/sensors.md names the sources.
struct DriverCloud {
  std::string driver;
  sensor_msgs::PointCloud2 message;
  std::vector<Eigen::Vector3f> points;
  std::vector<double> offsets_s;  ///< empty: the driver gives none
};

struct DriverField {
  const char* name;
  std::uint32_t offset;
  std::uint8_t type;
};

inline void addField(sensor_msgs::PointCloud2& message, const std::string& name,
                     std::uint32_t offset, std::uint8_t type, std::uint32_t count = 1) {
  message.fields.emplace_back();
  message.fields.back().name = name;
  message.fields.back().offset = offset;
  message.fields.back().datatype = type;
  message.fields.back().count = count;
}

template <typename Number>
void put(sensor_msgs::PointCloud2& message, std::size_t point, std::uint32_t offset,
         Number number) {
  std::memcpy(&message.data[point * message.point_step + offset], &number, sizeof number);
}

inline sensor_msgs::PointCloud2 emptyCloud(std::uint32_t width, std::uint32_t height,
                                           std::uint32_t point_step,
                                           const std::vector<DriverField>& fields) {
  sensor_msgs::PointCloud2 message;
  message.header.frame_id = "sensor";
  message.header.stamp = ros::Time(1700000000, 250000000);
  message.width = width;
  message.height = height;
  message.point_step = point_step;
  message.row_step = width * point_step;
  message.data.resize(static_cast<std::size_t>(height) * message.row_step);
  for (const DriverField& field : fields) addField(message, field.name, field.offset, field.type);
  return message;
}

/// A wall at x = 2 m or so; every 17th point was not measured.
inline Eigen::Vector3f wallPoint(std::size_t row, std::size_t column) {
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
  if ((row * 31 + column) % 17 == 5) return Eigen::Vector3f::Constant(kNaN);
  return {2.0F + 0.001F * static_cast<float>((row + column) % 7),
          0.004F * static_cast<float>(column) - 1.0F, 0.02F * static_cast<float>(row) - 0.5F};
}

inline void putPoints(DriverCloud& cloud) {
  sensor_msgs::PointCloud2& message = cloud.message;
  for (std::size_t i = 0; i < static_cast<std::size_t>(message.width) * message.height; ++i) {
    cloud.points.push_back(wallPoint(i / message.width, i % message.width));
    for (int k = 0; k < 3; ++k) {
      put(message, i, message.fields[static_cast<std::size_t>(k)].offset, cloud.points.back()[k]);
    }
  }
}

constexpr std::uint8_t kU8 = sensor_msgs::PointField::UINT8, kU16 = sensor_msgs::PointField::UINT16,
                       kU32 = sensor_msgs::PointField::UINT32,
                       kF32 = sensor_msgs::PointField::FLOAT32,
                       kF64 = sensor_msgs::PointField::FLOAT64;

/// realsense2_camera with ordered_pc: rgb is put behind the 16 bytes of xyz.
inline DriverCloud realSenseCloud() {
  DriverCloud cloud{"realsense", {}, {}, {}};
  cloud.message =
      emptyCloud(640, 480, 20, {{"x", 0, kF32}, {"y", 4, kF32}, {"z", 8, kF32}, {"rgb", 16, kF32}});
  putPoints(cloud);
  return cloud;
}

/// The same with ordered_pc:=false, the driver's default: what was measured alone, in one row.
inline DriverCloud unorderedRealSenseCloud() {
  const DriverCloud ordered = realSenseCloud();
  DriverCloud cloud{"realsense, not ordered", {}, {}, {}};
  for (const Eigen::Vector3f& p : ordered.points) {
    if (p.allFinite()) cloud.points.push_back(p);
  }
  cloud.message = emptyCloud(static_cast<std::uint32_t>(cloud.points.size()), 1, 20,
                             {{"x", 0, kF32}, {"y", 4, kF32}, {"z", 8, kF32}, {"rgb", 16, kF32}});
  cloud.message.is_dense = 1;
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    for (int k = 0; k < 3; ++k) {
      put(cloud.message, i, 4 * static_cast<std::uint32_t>(k), cloud.points[i][k]);
    }
  }
  return cloud;
}

/// depth_image_proc/point_cloud_xyzrgb, which openni, freenect and azure_kinect drivers use.
inline DriverCloud kinectCloud() {
  DriverCloud cloud{"kinect", {}, {}, {}};
  cloud.message =
      emptyCloud(640, 480, 32, {{"x", 0, kF32}, {"y", 4, kF32}, {"z", 8, kF32}, {"rgb", 16, kF32}});
  putPoints(cloud);
  return cloud;
}

/// depth_image_proc/point_cloud_xyz
inline DriverCloud depthImageCloud() {
  DriverCloud cloud{"depth_image_proc", {}, {}, {}};
  cloud.message = emptyCloud(640, 480, 16, {{"x", 0, kF32}, {"y", 4, kF32}, {"z", 8, kF32}});
  putPoints(cloud);
  return cloud;
}

/// velodyne_pointcloud, XYZIRT, not organised: stamped with the last packet, so that times are
/// before the stamp; row_step is left 0.
inline DriverCloud velodyneCloud() {
  DriverCloud cloud{"velodyne", {}, {}, {}};
  cloud.message = emptyCloud(16 * 1800, 1, 22,
                             {{"x", 0, kF32},
                              {"y", 4, kF32},
                              {"z", 8, kF32},
                              {"intensity", 12, kF32},
                              {"ring", 16, kU16},
                              {"time", 18, kF32}});
  cloud.message.row_step = 0;
  putPoints(cloud);
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    const std::size_t firing = i / 16;
    const float time =
        -0.0995F + 55.296e-6F * static_cast<float>(firing) + 2.304e-6F * static_cast<float>(i % 16);
    put(cloud.message, i, 18, time);
    cloud.offsets_s.push_back(static_cast<double>(time));
  }
  return cloud;
}

/// ouster_ros, OS1-64, 1024 x 10, destaggered: each row is turned by its own share of a turn. A
/// point without a return is at the origin.
inline DriverCloud ousterCloud() {
  DriverCloud cloud{"ouster", {}, {}, {}};
  cloud.message = emptyCloud(1024, 64, 48,
                             {{"x", 0, kF32},
                              {"y", 4, kF32},
                              {"z", 8, kF32},
                              {"intensity", 16, kF32},
                              {"t", 20, kU32},
                              {"reflectivity", 24, kU16},
                              {"ring", 26, kU16},
                              {"ambient", 28, kU16},
                              {"range", 32, kU32}});
  putPoints(cloud);
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    const std::size_t row = i / 1024, measured = (i % 1024 + 1024 - 6 * (row % 4)) % 1024;
    const bool returned = cloud.points[i].allFinite();
    if (!returned) {
      cloud.points[i].setZero();
      for (std::uint32_t k = 0; k < 3; ++k) put(cloud.message, i, 4 * k, 0.0F);
    }
    // Of a packet that was lost all columns have time 0.
    const auto t = static_cast<std::uint32_t>(returned ? 97656 * measured : 0);
    put(cloud.message, i, 20, t);
    cloud.offsets_s.push_back(1e-9 * t);
  }
  return cloud;
}

/// The same with `organized: false`: row after row as one.
inline DriverCloud unorganisedOusterCloud() {
  DriverCloud cloud = ousterCloud();
  cloud.driver = "ouster, not organised";
  cloud.message.width *= cloud.message.height;
  cloud.message.height = 1;
  cloud.message.row_step = cloud.message.width * cloud.message.point_step;
  return cloud;
}

/// livox_ros_driver2, PointXYZRTLT, packed: nanoseconds since the epoch as a double.
inline DriverCloud livoxCloud() {
  DriverCloud cloud{"livox", {}, {}, {}};
  cloud.message = emptyCloud(20000, 1, 26,
                             {{"x", 0, kF32},
                              {"y", 4, kF32},
                              {"z", 8, kF32},
                              {"intensity", 12, kF32},
                              {"tag", 16, kU8},
                              {"line", 17, kU8},
                              {"timestamp", 18, kF64}});
  putPoints(cloud);
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    put(cloud.message, i, 18, 1700000000.25e9 + 5000.0 * static_cast<double>(i));
    cloud.offsets_s.push_back(5e-6 * static_cast<double>(i));
  }
  return cloud;
}

/// hesai_ros_driver, and rslidar_sdk with XYZIRT: seconds since the epoch as a double.
inline DriverCloud hesaiCloud() {
  DriverCloud cloud{"hesai", {}, {}, {}};
  cloud.message = emptyCloud(32 * 900, 1, 26,
                             {{"x", 0, kF32},
                              {"y", 4, kF32},
                              {"z", 8, kF32},
                              {"intensity", 12, kF32},
                              {"ring", 16, kU16},
                              {"timestamp", 18, kF64}});
  putPoints(cloud);
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    const std::size_t firing = i / 32;
    const double offset = 111e-6 * static_cast<double>(firing);
    put(cloud.message, i, 18, 1700000000.25 + offset);
    cloud.offsets_s.push_back(offset);
  }
  return cloud;
}

inline std::vector<DriverCloud> driverClouds() {
  return {realSenseCloud(),
          unorderedRealSenseCloud(),
          kinectCloud(),
          depthImageCloud(),
          velodyneCloud(),
          ousterCloud(),
          unorganisedOusterCloud(),
          livoxCloud(),
          hesaiCloud()};
}

}  // namespace tccm::test
