#include "robot/body_sampler.h"

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

PosePath standingRoot() {
  PosePath root;
  root.add(at(0.9), Pose::Identity());
  root.add(at(1.1), Pose::Identity());
  return root;
}

/// Of a robot that stands.
const Body& sampledBody(BodySampler& sampler, double glide) {
  sampler.joints().add(at(1.0), {"slide", "glide"}, {0.0, glide}, {});
  EXPECT_EQ(sampler.sample(at(1.0), at(1.0), {standingRoot()}), "");
  return sampler.samples().front().body;
}

/// Of one that glides so far within 20 ms.
const std::vector<BodySample>& samplesOfAMove(BodySampler& sampler, double glide) {
  sampler.joints().add(at(1.0), {"slide", "glide"}, {0.0, 0.0}, {});
  sampler.joints().add(at(1.02), {"slide", "glide"}, {0.0, glide}, {});
  EXPECT_EQ(sampler.sample(at(1.0), at(1.02), {standingRoot()}), "");
  return sampler.samples();
}

TEST(BodySamplerUseTest, ScaleGrowsTheShapesAndPaddingComesWithThemLinkByLink) {
  BodySampler::Config config;
  config.filtered.expansion = Expansion{1.5, 0.02};
  config.filtered.exceptions = {{{"hand"}, std::nullopt, 0.07}, {{"oth*"}, 2.0, std::nullopt}};
  BodySampler sampler(test::sliderModel(), config);
  const Body& body = sampledBody(sampler, 0.0);
  ASSERT_EQ(body.shapes.size(), 2U);
  EXPECT_NEAR(std::get<Sphere>(body.shapes[0]).radius, 1.5 * 0.05, 1e-12) << "no padding in it";
  EXPECT_NEAR(std::get<Sphere>(body.shapes[1]).radius, 2.0 * 0.05, 1e-12);
  ASSERT_EQ(body.paddings_m.size(), 2U);
  EXPECT_EQ(body.paddings_m[0], 0.07);
  EXPECT_EQ(body.paddings_m[1], 0.02);
}

TEST(BodySamplerUseTest, ALinkThatIsNotFilteredOutIsInNoSample) {
  BodySampler::Config config;
  config.filtered.ignored = {"hand"};
  BodySampler sampler(test::sliderModel(), config);
  const Body& body = sampledBody(sampler, 0.3);
  ASSERT_EQ(body.poses.size(), 1U);
  EXPECT_NEAR(body.poses[0].translation().x(), 0.3, 1e-12);
}

TEST_F(BodySamplerTest, WhatIsHeldIsFilteredOutFromTheNextSampleOn) {
  AttachedObject mug{"mug", "hand", {Sphere{0.03}}};
  mug.primitive.pose.translation().x() = 0.12;
  ASSERT_EQ(sampler_.sample(at(1.0), at(1.0), {root_}), "");
  sampler_.setModel(std::make_shared<const RobotModel>(sampler_.model().holding({mug})));
  EXPECT_EQ(sampler_.samples().front().body.shapes.size(), 2U);
  ASSERT_EQ(sampler_.sample(at(1.02), at(1.02), {root_}), "") << "joint states are kept";
  const Body& body = sampler_.samples().front().body;
  ASSERT_EQ(body.shapes.size(), 3U);
  EXPECT_TRUE(test::isNearly(Vector3(body.poses[2].translation()), Vector3(0.14, 0.0, 0.62), 1e-9));
  EXPECT_EQ(body.paddings_m[2], 0.06) << "it is known less well than the hand";
  EXPECT_EQ(body.paddings_m[0], 0.025);
}

TEST(BodySamplerUseTest, PaddingsGrowWithTheSpeedOfWhatMayBeLate) {
  BodySampler::Config config;
  config.lateness_s = 0.03;
  BodySampler sampler(test::sliderModel(), config);
  ASSERT_GT(samplesOfAMove(sampler, 0.01).size(), 2U);
  for (const BodySample& sample : sampler.samples()) {
    EXPECT_NEAR(sample.body.paddings_m[0], 0.025, 1e-9) << "it stands";
    EXPECT_NEAR(sample.body.paddings_m[1], 0.025 + 0.03 * 0.5, 1e-6) << "half a metre a second";
  }
  ASSERT_EQ(sampler.sample(at(1.0), at(1.0), {standingRoot()}), "");
  EXPECT_EQ(sampler.samples().front().body.paddings_m[1], 0.025) << "one instant tells no speed";
}

TEST(BodySamplerUseTest, JointStatesThatJumpGrowNoPaddingByMoreThanItsLimit) {
  BodySampler sampler(test::sliderModel(), BodySampler::Config{});
  EXPECT_NEAR(samplesOfAMove(sampler, 0.9).back().body.paddings_m[1], 0.025 + 0.05, 1e-9);
}

/// A base and a trailer, each on a path of its own.
class TwoRootsTest : public ::testing::Test {
 protected:
  TwoRootsTest() {
    using namespace test;
    model_ = modelOf(robotOf(
        ballLink("base") + ballLink("trailer") + ballLink("mast") +
        jointOf("hitch", "floating", "base", "trailer") +
        jointOf("lift", "prismatic", "trailer", "mast", axisOf("0 0 1") + limitOf("0", "1"))));
    sampler_ = std::make_unique<BodySampler>(model_, BodySampler::Config{});
    sampler_->joints().add(at(1.0), {"lift"}, {0.5}, {});
    sampler_->joints().add(at(1.02), {"lift"}, {0.5}, {});
    for (const double stamp : {0.9, 1.1}) {
      Pose base = Pose::Identity(), trailer = Pose::Identity();
      base.translation().x() = stamp;
      trailer.translation().y() = -stamp;
      base_.add(at(stamp), base);
      trailer_.add(at(stamp), trailer);
    }
  }
  std::shared_ptr<const RobotModel> model_;
  std::unique_ptr<BodySampler> sampler_;
  PosePath base_, trailer_;
};

TEST_F(TwoRootsTest, EachLinkMovesWithItsOwnRoot) {
  ASSERT_EQ(model_->rootLinks(), (std::vector<std::string>{"base", "trailer"}));
  ASSERT_EQ(sampler_->sample(at(1.0), at(1.02), {base_, trailer_}), "");
  for (const BodySample& sample : sampler_->samples()) {
    const double now = toSeconds(sample.stamp.time_since_epoch());
    const auto& poses = sample.body.poses;
    ASSERT_EQ(poses.size(), 3U);
    EXPECT_TRUE(test::isNearly(Vector3(poses[0].translation()), Vector3(now, 0.0, 0.0), 1e-9));
    EXPECT_TRUE(test::isNearly(Vector3(poses[1].translation()), Vector3(0.0, -now, 0.0), 1e-9));
    EXPECT_TRUE(test::isNearly(Vector3(poses[2].translation()), Vector3(0.0, -now, 0.5), 1e-9));
  }
}

TEST_F(TwoRootsTest, OneThatIsMissingOrTooShortIsSaid) {
  PosePath late;
  late.add(at(1.01), Pose::Identity());
  late.add(at(1.2), Pose::Identity());
  EXPECT_EQ(sampler_->sample(at(1.0), at(1.02), {base_}), "no_transform");
  EXPECT_EQ(sampler_->sample(at(1.0), at(1.02), {base_, PosePath()}), "no_transform");
  EXPECT_EQ(sampler_->sample(at(1.0), at(1.02), {base_, late}), "no_transform");
  EXPECT_EQ(sampler_->sample(at(1.0), at(1.02), {late, trailer_}), "no_transform");
  EXPECT_EQ(sampler_->sample(at(1.0), at(1.02), {base_, trailer_, trailer_}), "no_transform");
}

TEST(BodySamplerConfigTest, AStepOutOfRangeIsRefused) {
  BodySampler::Config config;
  config.sample_s = 0.0;
  EXPECT_THROW(BodySampler(test::sliderModel(), config), ConfigError);
}

}  // namespace
}  // namespace tccm
