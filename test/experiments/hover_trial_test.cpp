#include "experiments/hover_trial.h"

#include <gtest/gtest.h>

#include <array>

#include "simulation/robot/dual_arm.h"
#include "support/trial_config.h"

namespace tccm::simulation {
namespace {

HoverTrial::Config shipped() { return test::trialConfig<HoverTrial>(); }

// Whose objects the sensor loses sight of altogether.
constexpr std::array<std::uint64_t, 4> kHidden = {1000005, 1000006, 1000010, 1000027};

std::string outcomeOf(const HoverTrial::Config& config, std::uint64_t seed) {
  return name(HoverTrial(config, dualArm(), seed).run().outcome);
}

TEST(HoverTrialTest, AHandStopsBeforeWhatItHides) {
  for (const std::uint64_t seed : kHidden) {
    const HoverTrial::Result result = HoverTrial(shipped(), dualArm(), seed).run();
    EXPECT_STREQ(name(result.outcome), "stopped") << seed;
    EXPECT_GT(result.left_m, 0.0) << seed;
    EXPECT_GE(result.stop_left_m, result.left_m - 1e-9) << seed;
    EXPECT_GT(result.held_max, 0U) << seed;
  }
}

TEST(HoverTrialTest, WithoutHoldingWhatIsHiddenSomeAreTouched) {
  HoverTrial::Config config = shipped();
  config.monitor.sensors.front().mapper.hold.longest_s = 0.0;
  int touched = 0;
  for (const std::uint64_t seed : kHidden) {
    const HoverTrial::Result result = HoverTrial(config, dualArm(), seed).run();
    EXPECT_EQ(result.held_max, 0U);
    if (result.outcome == Outcome::kTouched) {
      EXPECT_EQ(result.left_m, 0.0);
      ++touched;
    }
  }
  EXPECT_GT(touched, 0);
}

TEST(HoverTrialTest, AMonitorThatNeverPermitsDoesNotStartIt) {
  HoverTrial::Config config = shipped();
  config.monitor.checker.inputs.map_age_max_s = 1e-3;
  EXPECT_EQ(outcomeOf(config, 1), "not_started");
}

TEST(HoverTrialTest, TheSameSeedGivesTheSameTrial) {
  const HoverTrial::Result once = HoverTrial(shipped(), dualArm(), 4).run();
  const HoverTrial::Result again = HoverTrial(shipped(), dualArm(), 4).run();
  EXPECT_EQ(once.left_m, again.left_m);
  EXPECT_EQ(once.held_mean, again.held_mean);
  EXPECT_EQ(once.simulated_s, again.simulated_s);
}

TEST(HoverTrialTest, ASpeedThatIsNoneIsRefused) {
  HoverTrial::Config config = shipped();
  config.down_mps = 0.0;
  EXPECT_ANY_THROW(HoverTrial(config, dualArm(), 1));
}

}  // namespace
}  // namespace tccm::simulation
