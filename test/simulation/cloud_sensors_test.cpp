#include "simulation/cloud_sensors.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "simulation/robot/dual_arm.h"
#include "simulation/simulator.h"

namespace tccm::simulation {
namespace {

/// A small picture and a coarse turn, without noise.
Simulator::Config withSensors(const std::vector<SensorKind>& kinds) {
  Simulator::Config config;
  config.sensors = kinds;
  config.clouds.camera.pinhole = {80, 60, 50.0};
  config.clouds.camera.noise_m = config.clouds.camera.noise_per_m2 = 0.0;
  config.clouds.camera.noise_slant = 0.0;
  config.clouds.camera.mixed_share = config.clouds.camera.hole_share =
      config.clouds.camera.outline_share = 0.0;
  config.clouds.lidar.rows = 16;
  config.clouds.lidar.columns = 128;
  config.clouds.lidar.noise_m = 0.0;
  return config;
}

struct Seen {
  std::vector<SimulatedScan> scans;
  std::vector<SimulatedCloud> frames, turns;
  std::vector<RobotSample> samples;
};

Seen watch(const Simulator::Config& config, double seconds) {
  Simulator simulator(config);
  Seen seen;
  while (simulator.now() < config.start + fromSeconds(seconds)) {
    StepOutput output = simulator.step();
    if (output.scan) seen.scans.push_back(std::move(*output.scan));
    if (output.clouds.camera) seen.frames.push_back(std::move(*output.clouds.camera));
    if (output.clouds.lidar) seen.turns.push_back(std::move(*output.clouds.lidar));
    if (output.robot) seen.samples.push_back(*output.robot);
  }
  return seen;
}

TEST(CloudSensorsTest, TheRobotHasTheSensorsThatAreNamed) {
  const Seen laser = watch(withSensors({SensorKind::kLaser}), 0.5);
  EXPECT_TRUE(laser.frames.empty() && laser.turns.empty());
  EXPECT_FALSE(laser.scans.empty());
  const Seen camera = watch(withSensors({SensorKind::kCamera}), 0.5);
  EXPECT_TRUE(camera.scans.empty() && camera.turns.empty());
  EXPECT_EQ(camera.frames.size(), 15U);
  const Seen lidar = watch(withSensors({SensorKind::kLidar}), 0.5);
  EXPECT_TRUE(lidar.scans.empty() && lidar.frames.empty());
  EXPECT_EQ(lidar.turns.size(), 4U);  // the fifth ends later
}

TEST(CloudSensorsTest, FramesAndTurnsComeAtTheirRates) {
  const Seen seen = watch(withSensors({SensorKind::kCamera, SensorKind::kLidar}), 3.0);
  for (std::size_t i = 1; i < seen.frames.size(); ++i) {
    EXPECT_NEAR(toSeconds(seen.frames[i].cloud.stamp - seen.frames[i - 1].cloud.stamp), 1.0 / 30.0,
                0.0011);
  }
  EXPECT_NEAR(static_cast<double>(seen.frames.size()), 90.0, 1.0);
  for (std::size_t i = 1; i < seen.turns.size(); ++i) {
    EXPECT_EQ(seen.turns[i].cloud.stamp - seen.turns[i - 1].cloud.stamp,
              std::chrono::milliseconds(100));
  }
}

TEST(CloudSensorsTest, TheLaserMeasuresTheSameWhateverIsBesideIt) {
  const Seen alone = watch(withSensors({SensorKind::kLaser}), 1.0);
  const Seen beside =
      watch(withSensors({SensorKind::kLidar, SensorKind::kLaser, SensorKind::kCamera}), 1.0);
  ASSERT_EQ(alone.scans.size(), beside.scans.size());
  for (std::size_t i = 0; i < alone.scans.size(); ++i) {
    EXPECT_EQ(alone.scans[i].scan.ranges, beside.scans[i].scan.ranges);
  }
}

/// Placed from where the robot really was, the floor's points are on the floor. @return how many.
std::size_t expectOnTheFloor(const SimulatedCloud& seen, const PosePath& T_fixed_sensor) {
  const Cloud& cloud = seen.cloud;
  if (!T_fixed_sensor.covers(cloud.first(), cloud.last())) return 0;
  std::size_t floor = 0;
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    if (!isMeasured(cloud.points[i]) || seen.truth[i].label != Simulator::kFirstObject) continue;
    const double offset_s = cloud.offsets_s.empty() ? 0.0 : static_cast<double>(cloud.offsets_s[i]);
    const Pose pose = *T_fixed_sensor.at(cloud.stamp + fromSeconds(offset_s));
    EXPECT_NEAR((pose * cloud.points[i].cast<double>()).z(), 0.0, 2e-3);
    ++floor;
  }
  return floor;
}

TEST(CloudSensorsTest, SensorsOnTheMovingRobotMeasureFromWhereTheyAre) {
  Simulator::Config config = withSensors({SensorKind::kCamera, SensorKind::kLidar});
  config.scene = "empty";
  config.clouds.camera_mount = cameraMount("wrist");
  config.clouds.lidar_mount.link = "right_elbow_link";
  const auto linkOf = [model = dualArm()](const Mount& mount) {
    return linkIndex(*model, mount.link);
  };
  const Seen seen = watch(config, 3.0);
  PosePath T_fixed_camera, T_fixed_lidar;
  for (const RobotSample& sample : seen.samples) {
    const Mount& camera = config.clouds.camera_mount;
    const Mount& lidar = config.clouds.lidar_mount;
    T_fixed_camera.add(sample.stamp, sample.link_poses[linkOf(camera)] * camera.T_link_sensor);
    T_fixed_lidar.add(sample.stamp, sample.link_poses[linkOf(lidar)] * lidar.T_link_sensor);
  }
  std::size_t by_lidar = 0, by_camera = 0;
  for (const SimulatedCloud& turn : seen.turns) by_lidar += expectOnTheFloor(turn, T_fixed_lidar);
  for (const SimulatedCloud& frame : seen.frames) {
    by_camera += expectOnTheFloor(frame, T_fixed_camera);
  }
  EXPECT_GT(by_lidar, 1000U);
  EXPECT_GT(by_camera, 10000U);
}

TEST(CloudSensorsTest, TheFirstLookAtAnObstacleIsNotedOfACameraToo) {
  Simulator::Config config = withSensors({SensorKind::kCamera});
  config.clouds.camera_mount = cameraMount("side");
  config.obstacle = ObstacleKind::kPole;
  config.appear_s = 1.0;
  Simulator simulator(config);
  while (!simulator.truth().appeared) static_cast<void>(simulator.step());
  const Time appeared = simulator.now();
  while (simulator.now() < appeared + std::chrono::milliseconds(100)) {
    static_cast<void>(simulator.step());
  }
  ASSERT_TRUE(simulator.truth().first_beam);
  EXPECT_GE(*simulator.truth().first_beam, appeared);
  EXPECT_LE(*simulator.truth().first_beam, appeared + std::chrono::milliseconds(35));
}

}  // namespace
}  // namespace tccm::simulation
