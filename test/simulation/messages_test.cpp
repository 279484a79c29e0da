#include "simulation/messages.h"

#include <gtest/gtest.h>

#include <map>
#include <utility>

#include "ros/cloud_reader.h"
#include "support/driver_clouds.h"

namespace tccm::simulation {
namespace {

/// What each field is, by its name.
std::map<std::string, std::pair<std::uint32_t, int>> fieldsOf(
    const sensor_msgs::PointCloud2& message) {
  std::map<std::string, std::pair<std::uint32_t, int>> fields;
  for (const auto& field : message.fields) fields[field.name] = {field.offset, field.datatype};
  return fields;
}

Simulator::Config withClouds() {
  Simulator::Config config;
  config.sensors = {SensorKind::kCamera, SensorKind::kLidar};
  config.clouds.camera.pinhole = {64, 48, 40.0};
  config.clouds.lidar.rows = 16;
  config.clouds.lidar.columns = 128;
  return config;
}

CloudSensors::Output measured() {
  Simulator simulator(withClouds());
  CloudSensors::Output clouds;
  while (!clouds.camera || !clouds.lidar) {
    CloudSensors::Output output = simulator.step().clouds;
    if (output.camera) clouds.camera = std::move(output.camera);
    if (output.lidar) clouds.lidar = std::move(output.lidar);
  }
  return clouds;
}

void expectReadAs(const Cloud& sent, const sensor_msgs::PointCloud2& message) {
  Cloud read;
  ASSERT_EQ(CloudReader(CloudLimits{}).read(message, read), "");
  EXPECT_EQ(read.stamp, sent.stamp);
  EXPECT_EQ(read.width, sent.width);
  EXPECT_EQ(read.height, sent.height);
  EXPECT_NEAR(read.first_offset_s, sent.first_offset_s, 1e-6);
  EXPECT_NEAR(read.last_offset_s, sent.last_offset_s, 1e-6);
  ASSERT_EQ(read.points.size(), sent.points.size());
  for (std::size_t i = 0; i < sent.points.size(); ++i) {
    ASSERT_EQ(isMeasured(read.points[i]), isMeasured(sent.points[i]));
    if (!isMeasured(sent.points[i])) continue;
    ASSERT_EQ(read.points[i], sent.points[i]);
    if (!sent.offsets_s.empty()) {
      ASSERT_NEAR(read.offsets_s[i], sent.offsets_s[i], 1e-7);
    }
  }
}

TEST(SimulationMessagesTest, CloudsAreReadAsTheyWereMeasured) {
  const CloudSensors::Output clouds = measured();
  expectReadAs(clouds.camera->cloud, cameraMessage(clouds.camera->cloud));
  expectReadAs(clouds.lidar->cloud, lidarMessage(clouds.lidar->cloud));
}

TEST(SimulationMessagesTest, CloudsAreLaidOutAsTheirDriversDo) {
  const CloudSensors::Output clouds = measured();
  const auto camera = cameraMessage(clouds.camera->cloud);
  EXPECT_EQ(fieldsOf(camera), fieldsOf(test::realSenseCloud().message));
  EXPECT_EQ(camera.point_step, test::realSenseCloud().message.point_step);
  const auto lidar = lidarMessage(clouds.lidar->cloud);
  EXPECT_EQ(fieldsOf(lidar), fieldsOf(test::ousterCloud().message));
  EXPECT_EQ(lidar.point_step, test::ousterCloud().message.point_step);
}

TEST(SimulationMessagesTest, FramesOfTheSensorsThatThereAreHangOnTheRobot) {
  EXPECT_TRUE(mountMessage({}).transforms.empty());
  const tf2_msgs::TFMessage mounts = mountMessage(withClouds());
  ASSERT_EQ(mounts.transforms.size(), 2U);
  EXPECT_EQ(mounts.transforms[0].child_frame_id, kCameraFrame);
  EXPECT_EQ(mounts.transforms[0].header.frame_id, "chest_link");
  EXPECT_EQ(mounts.transforms[1].child_frame_id, kLidarFrame);
  const Mount camera = cameraMount("chest");
  EXPECT_EQ(mounts.transforms[0].transform.translation.z, camera.T_link_sensor.translation().z());
}

}  // namespace
}  // namespace tccm::simulation
