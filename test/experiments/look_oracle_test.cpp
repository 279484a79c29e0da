#include "experiments/look_oracle.h"

#include <gtest/gtest.h>

#include <cmath>

#include "simulation/robot/dual_arm.h"

namespace tccm::simulation {
namespace {

/// A robot that stands before nothing, watched for some seconds.
class LookOracleTest : public ::testing::Test {
 protected:
  LookOracleTest() {
    Simulator::Config config;
    config.scene = "empty";
    Simulator simulator(config);
    simulator.setStop(true);
    start_ = simulator.now();
    while (simulator.now() < start_ + std::chrono::seconds(10)) {
      const StepOutput output = simulator.step();
      if (output.scan) oracle_.add(output.scan->scan, simulator.now());
      if (output.robot) oracle_.add(*output.robot);
    }
  }

  /// Straight ahead, where the laser looks at a tilt.
  [[nodiscard]] Vector3 ahead(double tilt_rad, double range_m = 1.0) const {
    return laserOrigin(model_, tilt_rad) +
           range_m * Vector3(std::cos(tilt_rad), 0.0, -std::sin(tilt_rad));
  }
  /// In the middle of a camera's picture, where the robot's links are at rest.
  [[nodiscard]] Vector3 aheadOf(const Mount& mount, double depth_m) const {
    Kinematics kinematics(model_);
    kinematics.update(armPath(model_, "reach").positions(0.0), {Pose::Identity()});
    return kinematics.linkPoses()[linkIndex(*model_, mount.link)] * mount.T_link_sensor *
           Vector3(0.0, 0.0, depth_m);
  }
  /// [s] after the start
  [[nodiscard]] double firstLook(double after_s, const Vector3& p) const {
    const auto look = oracle_.firstLook(start_ + fromSeconds(after_s), p);
    return look ? toSeconds(look->beam - start_) : -1.0;
  }

  std::shared_ptr<const RobotModel> model_ = dualArm();
  LookOracle oracle_{{}, model_};
  Time start_;
};

TEST_F(LookOracleTest, TheMiddleOfTheTiltIsLookedAtTwiceAPeriod) {
  const Vector3 p = ahead(TiltMotion().mean_rad);
  double now = 0.5;
  for (int i = 0; i < 8; ++i) {
    const double look = firstLook(now, p);
    EXPECT_GT(look, now);
    const double phase = std::fmod(look + 0.03, TiltMotion().period_s / 2.0);
    EXPECT_LT(phase, 0.06) << look;
    now = look + 0.1;
  }
}

TEST_F(LookOracleTest, ATurningPointIsLookedAtOnceAPeriod) {
  const TiltMotion tilt;
  const Vector3 p = ahead(tilt.mean_rad + tilt.amplitude_rad);
  const double once = firstLook(1.0, p);
  EXPECT_NEAR(std::fmod(once, tilt.period_s), 0.25 * tilt.period_s, 0.15);
  EXPECT_NEAR(firstLook(once + 0.5, p), once + tilt.period_s, 0.05);
}

TEST_F(LookOracleTest, WhatLiesOutOfTheTiltsRangeIsNeverLookedAt) {
  EXPECT_EQ(firstLook(1.0, ahead(0.1)), -1.0);
  EXPECT_EQ(firstLook(1.0, ahead(1.45)), -1.0);
}

TEST_F(LookOracleTest, WhatTheRobotHidesIsNotLookedAt) {
  // Through the right hand, which rests ahead of the body.
  Simulator simulator({});
  Kinematics kinematics(model_);
  kinematics.update(armPath(model_, "reach").positions(0.0), {Pose::Identity()});
  const Vector3 hand =
      kinematics.linkPoses()[linkIndex(*model_, "right_palm_link")] * Vector3(0.0, 0.0, -0.045);
  const Vector3 sensor = laserOrigin(model_, TiltMotion().mean_rad);
  const Vector3 behind = sensor + 1.2 * (hand - sensor);
  EXPECT_EQ(firstLook(1.0, behind), -1.0);
}

TEST_F(LookOracleTest, ACamerasFrameMayComeBeforeTheRobotIsHeardOfAtItsEnd) {
  Simulator::Config config;
  config.scene = "empty";
  config.sensors = {SensorKind::kCamera};
  Simulator simulator(config);
  simulator.setStop(true);
  const Time start = simulator.now();
  LookOracle oracle({}, model_);
  std::size_t frames = 0;
  const Vector3 seen = aheadOf(config.clouds.camera_mount, 0.6);
  while (simulator.now() < start + std::chrono::seconds(1)) {
    const StepOutput output = simulator.step();
    if (output.clouds.camera) {
      oracle.add(config.clouds, output.clouds.camera->cloud.stamp, simulator.now());
      ++frames;
    }
    if (output.robot) oracle.add(*output.robot);
  }
  std::size_t looks = 0;
  Time now = start;
  for (auto look = oracle.firstLook(now, seen); look; look = oracle.firstLook(now, seen)) {
    now = look->beam;
    ++looks;
  }
  EXPECT_GT(frames, 25U);
  EXPECT_GE(looks + 2, frames);
}

TEST_F(LookOracleTest, AScanIsMappedAfterItsBeams) {
  const auto look = oracle_.firstLook(start_ + fromSeconds(1.0), ahead(TiltMotion().mean_rad));
  ASSERT_TRUE(look);
  EXPECT_GT(look->mapped, look->beam);
  EXPECT_LT(look->mapped - look->beam, fromSeconds(0.03));
}

TEST_F(LookOracleTest, AfterTheLastBeamThereIsNoLook) {
  EXPECT_EQ(firstLook(10.1, ahead(TiltMotion().mean_rad)), -1.0);
}

TEST_F(LookOracleTest, ACamerasFrameLooksAtWhatIsInItsPicture) {
  CloudSensors::Config camera;
  camera.camera_mount = {"base_link", Pose(Eigen::Translation3d(0.5, -1.0, 1.0))};
  camera.camera_mount.T_link_sensor.linear() << 1, 0, 0, 0, 0, 1, 0, -1, 0;  // it looks along y
  const Vector3 seen(0.8, -0.3, 1.25), aside(1.4, -0.4, 1.0), near(0.5, -0.8, 1.0);
  const Time frame = start_ + fromSeconds(4.0);
  oracle_.add(camera, frame, frame + fromSeconds(0.01));
  EXPECT_EQ(firstLook(3.99, seen), 4.0);
  EXPECT_NE(firstLook(4.0, seen), 4.0);
  EXPECT_NE(firstLook(3.99, aside), 4.0);
  EXPECT_NE(firstLook(3.99, near), 4.0);
  EXPECT_NE(firstLook(3.99, Vector3(-0.5, 1.0, 1.0)), 4.0);  // behind the chest
}

}  // namespace
}  // namespace tccm::simulation
