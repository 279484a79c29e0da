#include "experiments/small_object_trial.h"

#include <gtest/gtest.h>

#include "simulation/robot/dual_arm.h"
#include "support/trial_config.h"
#include "tccm_monitor/config_error.h"

namespace tccm::simulation {
namespace {

SmallObjectTrial::Config config() {
  SmallObjectTrial::Config config = test::trialConfig<SmallObjectTrial>();
  config.settle_s = 3.0;
  return config;
}

TEST(SmallObjectTrialTest, ABoxIsFoundAfterItsFirstBeamAndWithinATilt) {
  const std::vector<Vector3> places = smallObjectPlaces(config(), dualArm(), 1.0, 0.3);
  ASSERT_GT(places.size(), 3U);
  for (std::size_t i = 0; i < 4; ++i) {
    const Vector3& place = places[i * (places.size() - 1) / 3];
    const SmallObjectTrial::Result result =
        SmallObjectTrial(config(), dualArm(), place, i + 1).run();
    ASSERT_TRUE(result.beam_s && result.found_s) << place.transpose();
    EXPECT_GE(*result.beam_s, 0.0);
    EXPECT_GE(*result.found_s, *result.beam_s);
    EXPECT_LT(*result.found_s, 1.63);
  }
}

TEST(SmallObjectTrialTest, WhatIsBehindTheLaserIsNeverFoundAndNoPlace) {
  const Vector3 laser = laserOrigin(dualArm(), TiltMotion().mean_rad);
  const Vector3 behind = laser - Vector3(0.6, 0.0, 0.3);
  const SmallObjectTrial::Result result = SmallObjectTrial(config(), dualArm(), behind, 1).run();
  EXPECT_FALSE(result.beam_s);
  EXPECT_FALSE(result.found_s);
  for (const Vector3& place : smallObjectPlaces(config(), dualArm(), 1.0, 0.2)) {
    EXPECT_GT(place.x(), laser.x());
    EXPECT_LE((place - laser).norm(), 1.0);
  }
}

TEST(SmallObjectTrialTest, TheSameSeedGivesTheSame) {
  const Vector3 place = smallObjectPlaces(config(), dualArm(), 1.0, 0.3).front();
  const auto first = SmallObjectTrial(config(), dualArm(), place, 3).run();
  const auto second = SmallObjectTrial(config(), dualArm(), place, 3).run();
  EXPECT_EQ(first.found_s, second.found_s);
  EXPECT_EQ(first.tilt_phase, second.tilt_phase);
}

SmallObjectTrial::Config ofCamera() {
  SmallObjectTrial::Config small = config();
  small.settle_s = 1.0;
  small.sensors.kinds = {SensorKind::kCamera};
  small.sensors.clouds.camera_mount = cameraMount("head");
  small.monitor.sensors.front().cloud.emplace();
  small.monitor.sensors.front().mapper.window_s = 0.3;
  small.monitor.sensors.front().mapper.map.returns_max = 4000000;
  return small;
}

TEST(SmallObjectTrialTest, ACameraFindsABoxWithinAFrame) {
  const std::vector<Vector3> places = smallObjectPlaces(ofCamera(), dualArm(), 1.0, 0.3);
  ASSERT_GT(places.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    const SmallObjectTrial::Result result =
        SmallObjectTrial(ofCamera(), dualArm(), places[i * (places.size() - 1) / 2], i + 1).run();
    ASSERT_TRUE(result.beam_s && result.found_s);
    EXPECT_EQ(*result.found_s, *result.beam_s);
    EXPECT_LE(*result.found_s, ofCamera().limit());
  }
}

TEST(SmallObjectTrialTest, ASecondSensorIsRefused) {
  SmallObjectTrial::Config both = ofCamera();
  both.sensors.kinds.push_back(SensorKind::kLaser);
  EXPECT_THROW(both.validate(), ConfigError);
}

}  // namespace
}  // namespace tccm::simulation
