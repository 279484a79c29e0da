#include "scan/cloud_stage.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "support/depth_view.h"
#include "support/near.h"
#include "support/random.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

using test::isNearly;
using test::Random;

Time at(double seconds) { return Time(fromSeconds(seconds)); }

Pose poseAt(double x, double y, double z) {
  Pose pose = Pose::Identity();
  pose.translation() = Vector3(x, y, z);
  return pose;
}

/// With each of the points.
CloudStage::Config unthinned() {
  CloudStage::Config config;
  config.thinning.spacing_m = 0.0;
  return config;
}

CloudStage::Config withoutRobot() {
  CloudStage::Config config = unthinned();
  config.self_filter = false;
  return config;
}

Cloud cloudOf(const std::vector<Vector3>& points, std::size_t width, std::size_t height) {
  Cloud cloud;
  cloud.stamp = at(10.0);
  cloud.width = width;
  cloud.height = height;
  for (const Vector3& p : points) cloud.points.push_back(p.cast<float>());
  return cloud;
}

PosePath standing(const Pose& pose) {
  PosePath path;
  path.add(at(9.0), pose);
  path.add(at(11.0), pose);
  return path;
}

/// A dense patch of wall before the sensor.
std::vector<Vector3> patch(double away, std::size_t edge) {
  std::vector<Vector3> points;
  for (std::size_t i = 0; i < edge * edge; ++i) {
    const std::size_t row = i / edge;
    points.emplace_back(0.002 * static_cast<double>(i % edge), 0.002 * static_cast<double>(row),
                        away);
  }
  return points;
}

TEST(CloudStageTest, PointsAreBroughtIntoTheFixedFrame) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    Random random(seed);
    const Pose pose = random.pose(2.0);
    const auto points = patch(1.0, 12);
    CloudStage stage(withoutRobot(), nullptr);
    ASSERT_EQ(stage.assemble(cloudOf(points, 12, 12), standing(pose), {}), "");
    ASSERT_EQ(stage.returns().points.size(), points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
      EXPECT_TRUE(isNearly(stage.returns().points[i], pose * points[i], 1e-6));
    }
    EXPECT_EQ(stage.returns().stamp, at(10.0));
    EXPECT_TRUE(isNearly(stage.returns().viewpoint, pose.translation(), 1e-12));
    EXPECT_EQ(stage.returns().tilt, 0.0);
    EXPECT_FALSE(stage.returns().looks.empty());
  }
}

TEST(CloudStageTest, EachPointOfAMovingSensorIsPlacedAtItsOwnTime) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    Random random(seed);
    const double duration = random.uniform(0.01, 0.1), start = -random.uniform(0.0, duration);
    PosePath path;
    const Vector3 velocity = random.point(1.0);
    for (int i = -20; i <= 20; ++i) {
      const double t = 0.01 * i;
      Pose pose = poseAt(0.0, 0.0, 0.0);
      pose.translation() = t * velocity;
      pose.linear() = Eigen::AngleAxisd(t, Vector3::UnitZ()).toRotationMatrix();
      path.add(at(10.0 + t), pose);
    }
    const auto points = patch(1.0, 40);
    Cloud cloud = cloudOf(points, points.size(), 1);
    for (std::size_t i = 0; i < points.size(); ++i) {
      cloud.offsets_s.push_back(static_cast<float>(start + duration * static_cast<double>(i) /
                                                               static_cast<double>(points.size())));
    }
    cloud.first_offset_s = static_cast<double>(cloud.offsets_s.front());
    cloud.last_offset_s = static_cast<double>(cloud.offsets_s.back());
    CloudStage stage(withoutRobot(), nullptr);
    ASSERT_EQ(stage.assemble(cloud, path, {}), "") << seed;
    ASSERT_EQ(stage.returns().points.size(), points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Pose pose = *path.at(at(10.0 + static_cast<double>(cloud.offsets_s[i])));
      EXPECT_TRUE(isNearly(stage.returns().points[i], pose * points[i], 1e-3)) << seed;
    }
  }
}

TEST(CloudStageTest, WhatIsBeyondTheLimitsOfRangeIsNeitherInTheMapNorFree) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    Random random(seed);
    CloudStage::Config config = withoutRobot();
    config.range_min_m = random.uniform(0.2, 0.6);
    config.range_max_m = random.uniform(2.0, 4.0);
    const bool is_far = random.chance(0.5);
    auto points = patch(1.0, 40);
    const double away = is_far ? config.range_max_m + 0.1 : config.range_min_m - 0.15;
    for (std::size_t i = 0; i < points.size() / 2; ++i) {
      points[i] = away * points[i].normalized();
    }
    CloudStage stage(config, nullptr);
    ASSERT_EQ(stage.assemble(cloudOf(points, 40, 40), standing(Pose::Identity()), {}), "");
    for (const Vector3& p : stage.returns().points) EXPECT_NEAR(p.z(), 1.0, 1e-6);
    for (const Look& look : stage.returns().looks) {
      EXPECT_TRUE(look.what == Seen::kUnclear || look.end.norm() < 1.1) << look.end.norm();
    }
  }
}

TEST(CloudStageTest, NaNIsUnknownAndABlindSensorIsTold) {
  auto points = patch(1.0, 20);
  CloudStage stage(withoutRobot(), nullptr);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (i % 2 == 0) points[i].setConstant(std::nan(""));
  }
  ASSERT_EQ(stage.assemble(cloudOf(points, 20, 20), standing(Pose::Identity()), {}), "");
  EXPECT_EQ(stage.counts()[static_cast<std::size_t>(BeamKind::kUnknown)], 200U);
  for (const Vector3& p : stage.returns().points) EXPECT_TRUE(p.allFinite());
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (i > 10) points[i].setConstant(std::nan(""));
  }
  EXPECT_EQ(stage.assemble(cloudOf(points, 20, 20), standing(Pose::Identity()), {}), "blind");
}

TEST(CloudStageTest, WithoutTransformsOverAllOfItACloudIsDropped) {
  const auto points = patch(1.0, 12);
  Cloud cloud = cloudOf(points, 144, 1);
  CloudStage stage(withoutRobot(), nullptr);
  EXPECT_EQ(stage.assemble(cloud, {}, {}), "no_transform");
  cloud.offsets_s.assign(144, 0.0F);
  cloud.last_offset_s = 1.5;
  EXPECT_EQ(stage.assemble(cloud, standing(Pose::Identity()), {}), "no_transform");
}

/// Whether the outcome is what comparing each point with each shape gives.
void expectExact(const test::DepthView& view, const Cloud& cloud, const CloudStage& stage,
                 const CloudStage::Config& config, const CloudStage& without_filter) {
  CloudStage::Config copy = config;
  BodySampler sampler(view.model(), copy.body);
  AssembledScan scan;
  std::vector<std::size_t> indices;
  for (std::size_t i = 0; i < cloud.points.size(); i += 7) {
    if (without_filter.kinds()[i] != BeamKind::kReturn) continue;
    Beam beam;
    beam.stamp = cloud.stamp;
    beam.viewpoint = view.sensorPose().translation();
    beam.p_fixed = view.sensorPose() * cloud.points[i].cast<double>();
    beam.kind = BeamKind::kReturn;
    scan.beams.push_back(beam);
    indices.push_back(i);
  }
  for (std::size_t k = 0; k < scan.beams.size(); ++k) {
    BodyFilter exact = config.body_filter;
    exact.range_tolerance_m =
        std::max(exact.range_tolerance_m,
                 5.0 * static_cast<double>(config.noise.at(cloud.points[indices[k]].norm())));
    AssembledScan one;
    one.beams = {scan.beams[k]};
    exact.apply(stage.body()->samples(), one);
    EXPECT_EQ(stage.kinds()[indices[k]], one.beams[0].kind) << indices[k];
  }
}

TEST(CloudStageTest, OfARobotInViewNoPointIsLeftAndTheFilterIsExact) {
  for (const double shoulder : {-0.75, -0.3}) {
    const test::DepthView view(shoulder);
    const auto seen = view.camera(1);
    ASSERT_GT(seen.robot_points, 5000U);
    const CloudStage::Config config = unthinned();
    CloudStage stage(config, view.model()), bare(withoutRobot(), nullptr);
    view.tellJoints(stage);
    ASSERT_EQ(stage.assemble(seen.cloud, view.sensorPath(), view.rootPaths()), "");
    ASSERT_EQ(bare.assemble(seen.cloud, view.sensorPath(), {}), "");
    expectExact(view, seen.cloud, stage, config, bare);
    const BeamCounts& counts = stage.counts();
    EXPECT_GT(counts[static_cast<std::size_t>(BeamKind::kSelf)], seen.robot_points / 2);
    EXPECT_FALSE(stage.selfLink().empty());
    std::size_t own = 0, robot_looks = 0;
    const auto& samples = stage.body()->samples();
    for (const Vector3& p : stage.returns().points) {
      for (std::size_t i = 0; i < samples[0].body.shapes.size(); ++i) {
        const double away =
            distance(samples[0].body.shapes[i], samples[0].body.poses[i].inverse() * p);
        own += away <= 0.02 ? 1 : 0;
      }
    }
    EXPECT_EQ(own, 0U);
    for (const Look& look : stage.returns().looks) robot_looks += look.what == Seen::kRobot ? 1 : 0;
    EXPECT_GT(robot_looks, 50U);
    EXPECT_LT(stage.returns().looks.size(), 4000U);
  }
}

TEST(CloudStageTest, ADenseCloudIsThinnedAndItsLooksTellTheSame) {
  const test::DepthView view;
  const auto seen = view.camera(1);
  CloudStage thinned({}, view.model()), all(unthinned(), view.model());
  for (CloudStage* stage : {&thinned, &all}) {
    view.tellJoints(*stage);
    ASSERT_EQ(stage->assemble(seen.cloud, view.sensorPath(), view.rootPaths()), "");
  }
  std::size_t dense = 0, of_these = 0;
  for (std::size_t i = 0; i < seen.cloud.points.size(); ++i) {
    if (thinned.kinds()[i] != BeamKind::kThinned) {
      EXPECT_EQ(thinned.kinds()[i], all.kinds()[i]) << i;
      continue;
    }
    ++dense;
    of_these += all.kinds()[i] == BeamKind::kReturn ? 1 : 0;
  }
  EXPECT_GT(dense, seen.cloud.points.size() / 3);
  EXPECT_GT(of_these, dense / 2);
  EXPECT_LE(thinned.returns().points.size() + of_these, all.returns().points.size() + 1);
  ASSERT_EQ(thinned.returns().looks.size(), all.returns().looks.size());
  std::size_t others = 0;  // at the robot's outline
  for (std::size_t i = 0; i < all.returns().looks.size(); ++i) {
    const Look &look = thinned.returns().looks[i], &of_all = all.returns().looks[i];
    const double range = (look.end - look.viewpoint).norm();
    EXPECT_NEAR(range, (of_all.end - of_all.viewpoint).norm(), 1e-5);
    EXPECT_TRUE(isNearly(look.end, of_all.end, 0.006 * range));
    others += look.what != of_all.what ? 1 : 0;
  }
  EXPECT_LT(others, all.returns().looks.size() / 40);
}

TEST(CloudStageTest, ACloudThatIsSortedRowByRowGivesTheSameAsOneThatIsSortedBefore) {
  const test::DepthView view;
  Cloud cloud = view.camera(1).cloud, further = cloud;
  Random random(5);
  for (Eigen::Vector3f& point : cloud.points) {
    if (random.chance(0.2)) point *= static_cast<float>(random.uniform(0.9, 1.1));
  }
  for (Eigen::Vector3f& point : further.points) point *= 1.5F;
  CloudStage at_once(unthinned(), view.model()), by_rows(unthinned(), view.model());
  for (CloudStage* stage : {&at_once, &by_rows}) view.tellJoints(*stage);
  // Whoever has seen one of these knows where its looks are, and needs no range but those of a row
  // and its neighbours.
  ASSERT_EQ(by_rows.assemble(further, view.sensorPath(), view.rootPaths()), "");
  for (CloudStage* stage : {&at_once, &by_rows}) {
    ASSERT_EQ(stage->assemble(cloud, view.sensorPath(), view.rootPaths()), "");
  }
  EXPECT_EQ(by_rows.kinds(), at_once.kinds());
  EXPECT_EQ(by_rows.counts(), at_once.counts());
  EXPECT_GT(by_rows.counts()[static_cast<std::size_t>(BeamKind::kMixedPixel)], 1000U);
  EXPECT_EQ(by_rows.returns().points, at_once.returns().points);
  ASSERT_EQ(by_rows.returns().looks.size(), at_once.returns().looks.size());
  for (std::size_t i = 0; i < at_once.returns().looks.size(); ++i) {
    EXPECT_EQ(by_rows.returns().looks[i].end, at_once.returns().looks[i].end);
    EXPECT_EQ(by_rows.returns().looks[i].what, at_once.returns().looks[i].what);
  }
}

TEST(CloudStageTest, LimitsOfRangeThatContradictAreRefused) {
  CloudStage::Config config = withoutRobot();
  config.range_min_m = 6.0;
  EXPECT_THROW(CloudStage(config, nullptr), ConfigError);
}

}  // namespace
}  // namespace tccm
