#include "experiments/self_filter_trial.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "simulation/robot/dual_arm.h"
#include "simulation/wander.h"

namespace tccm::simulation {
namespace {

/// Shipped defaults, 1 cm noise, mixed pixels in runs and a body 5 mm thicker than described.
SelfFilterTrial::Config halfAMinute() {
  SelfFilterTrial::Config config;
  config.simulator.motion = kWander;
  config.simulator.wander_length_m = 8.0;
  config.simulator.body_error = {BodyError::Kind::kThicker, 0.005};
  config.duration_s = 30.0;
  config.monitor.sensors.front().mapper.map.grid.height_min_m = 0.1;
  return config;
}

SelfFilterTally run(const SelfFilterTrial::Config& config) {
  SelfFilterTrial trial(config, dualArm());
  return trial.run({});
}

TEST(SelfFilterTrialTest, WithTheDefaultsNoOwnPointIsMappedAndNothingIsTouched) {
  for (const std::uint64_t seed : {1U, 2U}) {
    SelfFilterTrial::Config config = halfAMinute();
    config.simulator.seed = seed;
    const SelfFilterTally tally = run(config);
    EXPECT_EQ(SelfFilterLimits().missed(tally), std::vector<std::string>());
    EXPECT_EQ(tally.of(BeamSource::kOwn).mapped(), 0U);
    EXPECT_GT(tally.of(BeamSource::kOwn).measuredInArea(), 10000U);
    EXPECT_GT(tally.of(BeamSource::kOwnMixed).measuredInArea(), 300U);
    EXPECT_GT(tally.of(BeamSource::kScene).measuredInArea(), 30000U);
    EXPECT_GT(tally.sceneShareRemoved(), 0.0);
    EXPECT_LT(tally.sceneShareRemoved(), 0.02);
  }
}

TEST(SelfFilterTrialTest, WithoutTheSelfFilterTheRobotTouchesItself) {
  SelfFilterTrial::Config config = halfAMinute();
  config.duration_s = 20.0;
  config.monitor.sensors.front().scan.self_filter = false;
  const SelfFilterTally tally = run(config);
  EXPECT_EQ(SelfFilterLimits().missed(tally),
            (std::vector<std::string>{"own_points", "contacts_with_body"}));
}

TEST(SelfFilterTrialTest, With10MmOfPaddingAloneNoisePutsTheBodyIntoTheMap) {
  SelfFilterTrial::Config config = halfAMinute();
  config.duration_s = 20.0;
  config.monitor.sensors.front().scan.body.filtered.expansion.padding_m = 0.01;
  config.monitor.sensors.front().scan.assembler.body.range_tolerance_m = 0.0;
  const SelfFilterTally tally = run(config);
  EXPECT_GT(tally.of(BeamSource::kOwn).mapped(), 100U);
  EXPECT_GT(tally.contacts_with_body, 0U);
}

TEST(SelfFilterTrialTest, ADeepShadowAndAWideGrazingRadiusCostMoreOfTheSceneThanAllowed) {
  SelfFilterTrial::Config config = halfAMinute();
  config.duration_s = 20.0;
  config.monitor.sensors.front().scan.assembler.body.shadow_depth_m = 100.0;
  config.monitor.sensors.front().scan.assembler.body.grazing_m = 0.04;
  const std::vector<std::string> missed = SelfFilterLimits().missed(run(config));
  EXPECT_EQ(missed, std::vector<std::string>{"scene_removed"});
}

TEST(SelfFilterTrialTest, TheSameSeedGivesTheSameFigures) {
  SelfFilterTrial::Config config = halfAMinute();
  config.duration_s = 3.0;
  EXPECT_EQ(toJson(run(config)).dump(), toJson(run(config)).dump());
}

TEST(SelfFilterTrialTest, RefusesADurationThatIsNoTime) {
  SelfFilterTrial::Config config = halfAMinute();
  config.duration_s = 0.0;
  EXPECT_THROW(SelfFilterTrial(config, dualArm()), std::runtime_error);
}

}  // namespace
}  // namespace tccm::simulation
