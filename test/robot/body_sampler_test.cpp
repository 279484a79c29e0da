#include "tccm_monitor/robot/body_sampler.h"

#include <gtest/gtest.h>

#include "support/near.h"
#include "support/tiny_robot.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

Time at(double seconds) { return Time(fromSeconds(seconds)); }

/// The slider's hand moves at 1 m/s from x = 0 at 1.0 s, while the root rises at 1 m/s.
class BodySamplerTest : public ::testing::Test {
 protected:
  BodySamplerTest() {
    for (int i = 0; i <= 5; ++i) {
      sampler_.joints().add(at(1.0 + 0.01 * i), {"slide", "glide"}, {0.01 * i, 0.0}, {});
    }
    Pose root = Pose::Identity();
    root_.add(at(0.9), root);
    root.translation().z() = 0.2;
    root_.add(at(1.1), root);
  }

  BodySampler sampler_{test::sliderModel(), BodySampler::Config{}};
  PosePath root_;
};

TEST_F(BodySamplerTest, SamplesRunFromFirstToLastAtLeastAsDenseAsAsked) {
  ASSERT_EQ(sampler_.sample(at(1.0), at(1.03), {root_}), "");
  const auto& samples = sampler_.samples();
  ASSERT_EQ(samples.size(), 9U);  // 30 ms in steps of no more than 4
  EXPECT_EQ(samples.front().stamp, at(1.0));
  EXPECT_EQ(samples.back().stamp, at(1.03));
  for (const BodySample& sample : samples) {
    const double since = toSeconds(sample.stamp - at(1.0));
    ASSERT_EQ(sample.body.poses.size(), 2U);
    ASSERT_EQ(sample.body.shapes.size(), 2U);
    EXPECT_TRUE(test::isNearly(Vector3(sample.body.poses[0].translation()),
                               Vector3(since, 0.0, 0.6 + since), 1e-9));
  }
}

TEST_F(BodySamplerTest, OneInstantIsOneSample) {
  ASSERT_EQ(sampler_.sample(at(1.02), at(1.02), {root_}), "");
  EXPECT_EQ(sampler_.samples().size(), 1U);
}

TEST_F(BodySamplerTest, MissingJointStatesAreSaid) {
  EXPECT_NE(sampler_.sample(at(1.0), at(1.0501), {root_}), "");
  EXPECT_NE(sampler_.sample(at(0.99), at(1.01), {root_}), "");
}

TEST_F(BodySamplerTest, AMissingRootIsSaid) {
  PosePath late;
  late.add(at(1.01), Pose::Identity());
  late.add(at(1.2), Pose::Identity());
  EXPECT_NE(sampler_.sample(at(1.0), at(1.03), {late}), "");
  EXPECT_NE(sampler_.sample(at(1.0), at(1.03), {PosePath()}), "");
  EXPECT_NE(sampler_.sample(at(1.0), at(1.03), {}), "");
}

TEST(BodySamplerConfigTest, AStepOutOfRangeIsRefused) {
  BodySampler::Config config;
  config.sample_s = 0.0;
  EXPECT_THROW(BodySampler(test::sliderModel(), config), ConfigError);
}

}  // namespace
}  // namespace tccm
