/// The monitor over a camera alone, and over a laser and a camera.

#include <gtest/gtest.h>

#include <limits>
#include <tuple>

#include "monitor_config.h"
#include "support/nodding_sensor.h"
#include "support/tiny_robot.h"

namespace tccm {
namespace {

using test::kSensor;
using test::kTableHeight;

constexpr double kFramePeriod = 0.05;

Time at(double seconds) { return Time(fromSeconds(seconds)); }

/// A ball of 50 mm on a vertical slide, 0.8 m ahead, at "height" above the floor.
std::string ballOnSlide() {
  return test::robotOf(
      test::linkOf("base") + test::ballLink("ball") +
      test::jointOf("height", "prismatic", "base", "ball",
                    "<origin xyz=\"0.8 0 0\"/>" + test::axisOf("0 0 1") + test::limitOf("0", "2")));
}

/// 1 m up; z ahead and down by 0.65 rad, x to the right.
Pose cameraPose() {
  Pose pose = Pose::Identity();
  const Vector3 z(std::cos(0.65), 0.0, -std::sin(0.65));
  const Vector3 x(0.0, -1.0, 0.0);
  pose.linear() << x, z.cross(x), z;
  pose.translation() = kSensor;
  return pose;
}

PosePath still(const Pose& pose) {
  PosePath path;
  path.add(at(0.0), pose);
  path.add(at(1000.0), pose);
  return path;
}

/// Of an endless table. @param measured_share of the rows, from the top; the others have no range.
Cloud cloudOfTable(double seconds, double measured_share = 1.0) {
  Cloud cloud;
  cloud.stamp = at(seconds);
  cloud.width = 160;
  cloud.height = 120;
  const Pose pose = cameraPose();
  for (std::size_t row = 0; row < cloud.height; ++row) {
    for (std::size_t column = 0; column < cloud.width; ++column) {
      const Vector3 d_sensor((static_cast<double>(column) - 79.5) / 120.0,
                             (static_cast<double>(row) - 59.5) / 120.0, 1.0);
      const double down = -(pose.linear() * d_sensor).z();
      const bool is_measured = down > 0.0 && static_cast<double>(row) <
                                                 measured_share * static_cast<double>(cloud.height);
      const double along = is_measured ? (kSensor.z() - kTableHeight) / down
                                       : std::numeric_limits<double>::quiet_NaN();
      cloud.points.emplace_back((along * d_sensor).cast<float>());
    }
  }
  return cloud;
}

Monitor::Config::Sensor camera() {
  Monitor::Config::Sensor sensor;
  sensor.cloud.emplace();
  sensor.mapper.window_s = 0.3;
  sensor.mapper.looks.pass_gap_s = 0.001;
  return sensor;
}

class MonitorCloudsTest : public ::testing::Test {
 protected:
  /// Clouds, and scans where a laser is there, up to a time. @param clouds whether they come.
  void runUntil(Monitor& monitor, double end, double height, bool clouds = true,
                double measured_share = 1.0) {
    const std::size_t camera_index = monitor.sensors() - 1;
    const std::vector<PosePath> roots{still(Pose::Identity())};
    for (; now_ < end; now_ += kFramePeriod) {
      const Time heard = at(now_ + 0.02);
      monitor.addJoints(at(now_), at(now_ - 0.005), {"height"}, {height}, {0.0});
      monitor.addJoints(at(now_ + 0.01), at(now_ + 0.01), {"height"}, {height}, {0.0});
      monitor.checker().setRootPose(0, Time(), Pose::Identity(), true);
      if (clouds) {
        monitor.scanArrived(heard, at(now_), camera_index);
        outcome_ = monitor.addCloud(heard, cloudOfTable(now_, measured_share), still(cameraPose()),
                                    roots, camera_index);
      }
      if (camera_index > 0) addScan(monitor, heard, roots);
      verdict_ = &monitor.checker().check(heard);
    }
  }
  /// Of a table that is not there: the laser looks through it to the floor.
  void addScan(Monitor& monitor, Time heard, const std::vector<PosePath>& roots) {
    const auto pose = [](double seconds) { return test::noddingSensor(seconds, 0.25); };
    PosePath path;
    for (const double offset : {-0.001, 0.0, 0.001})
      path.add(at(now_ + offset), pose(now_ + offset));
    monitor.scanArrived(heard, at(now_), 0);
    const LaserScan scan = test::scanBy(pose(now_), at(now_), [](const Vector3& direction) {
      return -kSensor.z() / direction.z();
    });
    EXPECT_EQ(monitor.addScan(heard, scan, path, roots, 0).dropped, "");
  }
  static Monitor::Config cameraAlone() {
    Monitor::Config config;
    config.sensors = {camera()};
    config.checker.inputs.sensors = {{"camera", true}};
    config.checker.pose.check_occlusion = false;
    config.checker.permission.hold_until_reset = false;
    return config;
  }
  static Monitor::Config laserAndCamera() {
    Monitor::Config config = cameraAlone();
    config.sensors.insert(config.sensors.begin(), Monitor::Config::Sensor());
    config.sensors.front().mapper.map.scans_max = 256;
    config.checker.inputs.sensors.insert(config.checker.inputs.sensors.begin(), {"laser", true});
    return config;
  }

  double now_ = 100.0;
  Monitor::ScanOutcome outcome_;
  const Verdict* verdict_ = nullptr;
};

TEST_F(MonitorCloudsTest, ACameraAloneIsUnknownThenFreeThenInCollision) {
  Monitor monitor(cameraAlone(), test::modelOf(ballOnSlide()));
  runUntil(monitor, 100.1, 0.8);
  EXPECT_EQ(verdict_->reason, Reason::kInit);
  EXPECT_TRUE(verdict_->stop);
  runUntil(monitor, 101.0, 0.8);
  EXPECT_EQ(verdict_->reason, Reason::kClear) << verdict_->detail;
  EXPECT_EQ(outcome_.dropped, "");
  EXPECT_GT(outcome_.added.mapped, 1000U);
  for (const Cuboid& cuboid : monitor.map()->cuboids) {
    EXPECT_NEAR(monitor.map()->grid.metres(cuboid.top), kTableHeight, 0.0021);
  }
  runUntil(monitor, 101.1, kTableHeight + 0.05);
  EXPECT_EQ(verdict_->reason, Reason::kCollision);
  EXPECT_EQ(verdict_->link, "ball");
}

TEST_F(MonitorCloudsTest, TheRobotIsFilteredOutOfClouds) {
  Monitor monitor(cameraAlone(), test::modelOf(ballOnSlide()));
  ASSERT_NE(monitor.body(), nullptr);
  runUntil(monitor, 100.5, kTableHeight);
  EXPECT_GT(outcome_.beams[static_cast<std::size_t>(BeamKind::kSelf)], 20U);
}

TEST_F(MonitorCloudsTest, ACameraThatGoesBlindIsAFaultThatNamesIt) {
  Monitor monitor(cameraAlone(), test::modelOf(ballOnSlide()));
  runUntil(monitor, 101.0, 0.8);
  ASSERT_EQ(verdict_->reason, Reason::kClear) << verdict_->detail;
  runUntil(monitor, 102.0, 0.8, true, 0.02);
  EXPECT_EQ(outcome_.dropped, "blind");
  EXPECT_EQ(verdict_->reason, Reason::kBlind) << verdict_->detail;
  EXPECT_NE(verdict_->detail.find("camera"), std::string::npos) << verdict_->detail;
  runUntil(monitor, 103.0, 0.8);
  EXPECT_EQ(verdict_->reason, Reason::kClear) << verdict_->detail;
}

TEST_F(MonitorCloudsTest, WhatTheCameraAloneSeesStopsARobotWithALaserToo) {
  Monitor monitor(laserAndCamera(), test::modelOf(ballOnSlide()));
  runUntil(monitor, 103.0, 0.8);
  EXPECT_EQ(verdict_->reason, Reason::kClear) << verdict_->detail;
  EXPECT_GT(monitor.map(1)->cuboids.size(), 500U);
  runUntil(monitor, 103.1, kTableHeight + 0.05);
  EXPECT_EQ(verdict_->reason, Reason::kCollision) << verdict_->detail;
}

TEST_F(MonitorCloudsTest, ACameraThatIsRequiredAndSilentStopsTheRobot) {
  Monitor monitor(laserAndCamera(), test::modelOf(ballOnSlide()));
  runUntil(monitor, 103.0, 0.8);
  ASSERT_EQ(verdict_->reason, Reason::kClear) << verdict_->detail;
  runUntil(monitor, 104.0, 0.8, false);
  EXPECT_TRUE(verdict_->stop);
  EXPECT_NE(verdict_->detail.find("'camera'"), std::string::npos) << verdict_->detail;
}

TEST_F(MonitorCloudsTest, TwoMonitorsGiveTheSameMapForTheSameClouds) {
  Monitor one(cameraAlone(), test::modelOf(ballOnSlide())),
      other(cameraAlone(), test::modelOf(ballOnSlide()));
  runUntil(one, 101.0, 0.6);
  now_ = 100.0;
  runUntil(other, 101.0, 0.6);
  ASSERT_EQ(one.map()->cuboids.size(), other.map()->cuboids.size());
  for (std::size_t i = 0; i < one.map()->cuboids.size(); ++i) {
    const Cuboid &a = one.map()->cuboids[i], &b = other.map()->cuboids[i];
    EXPECT_EQ(std::tie(a.cell, a.bottom, a.top, a.points, a.age_scans),
              std::tie(b.cell, b.bottom, b.top, b.points, b.age_scans));
  }
}

}  // namespace
}  // namespace tccm
