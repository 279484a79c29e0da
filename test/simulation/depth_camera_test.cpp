#include "simulation/depth_camera.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "geometry/ray.h"
#include "simulation/simulator.h"
#include "simulation/world.h"
#include "support/error_of.h"
#include "support/random.h"

namespace tccm::simulation {
namespace {

using test::Random;

/// In the camera's frame: z ahead.
Snapshot before(const std::vector<std::pair<Shape, Pose>>& targets) {
  Snapshot snapshot{Time{std::chrono::seconds(3)}, Pose::Identity(), {}, {}};
  for (const auto& [shape, pose] : targets) {
    snapshot.labels.push_back(100 + snapshot.labels.size());
    snapshot.targets.shapes.push_back(shape);
    snapshot.targets.poses.push_back(pose);
  }
  return snapshot;
}

std::pair<Shape, Pose> wallAt(double depth, double slant_rad = 0.0) {
  Pose pose = at(0.0, 0.0, depth);
  pose.rotate(Eigen::AngleAxisd(slant_rad, Vector3::UnitY()));
  pose.translate(Vector3(0.0, 0.0, 0.05));
  return {Box{Vector3(20.0, 20.0, 0.05)}, pose};
}

DepthCamera::Config noiseless() {
  DepthCamera::Config config;
  config.noise_m = config.noise_per_m2 = config.noise_slant = 0.0;
  config.mixed_share = config.hole_share = config.outline_share = 0.0;
  return config;
}

DepthCamera::Config small(DepthCamera::Config config) {
  config.pinhole = {64, 48, 40.0};
  return config;
}

TEST(DepthCameraTest, AFrameHasTheFormAndTheStampOfItsModel) {
  DepthCamera camera({}, 1);
  const auto [cloud, truth] = camera.measure(before({wallAt(1.0)}));
  EXPECT_EQ(cloud.stamp, Time{std::chrono::seconds(3)});
  EXPECT_EQ(cloud.width, 640U);
  EXPECT_EQ(cloud.height, 480U);
  EXPECT_EQ(cloud.points.size(), 640U * 480U);
  EXPECT_EQ(truth.size(), cloud.points.size());
  EXPECT_TRUE(cloud.offsets_s.empty());
  // 75 +- 3 by 62 +- 1 degrees
  const Eigen::Vector3f& corner = cloud.points.front();
  EXPECT_NEAR(2.0 * std::atan2(-corner.x(), corner.z()) * 180.0 / M_PI, 75.0, 3.0);
  EXPECT_NEAR(2.0 * std::atan2(-corner.y(), corner.z()) * 180.0 / M_PI, 62.0, 1.0);
}

TEST(DepthCameraTest, AWallIsWhereItIs) {
  DepthCamera camera(noiseless(), 1);
  const auto [cloud, truth] = camera.measure(before({wallAt(1.25)}));
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    const double column = static_cast<double>(i % 640), row = static_cast<double>(i / 640);
    ASSERT_NEAR(cloud.points[i].x(), 1.25 * (column - 319.5) / 400.0, 1e-5);
    ASSERT_NEAR(cloud.points[i].y(), 1.25 * (row - 239.5) / 400.0, 1e-5);
    ASSERT_NEAR(cloud.points[i].z(), 1.25, 1e-5);
    ASSERT_EQ(truth[i].label, 100U);
    ASSERT_FALSE(truth[i].mixed());
  }
}

/// One standard deviation over a frame's middle.
double deviationOf(double depth, double slant_rad) {
  DepthCamera camera({}, 5);
  const SimulatedCloud frame = camera.measure(before({wallAt(depth, slant_rad)}));
  DepthCamera exact(noiseless(), 5);
  const SimulatedCloud still = exact.measure(before({wallAt(depth, slant_rad)}));
  double squares = 0.0, sum = 0.0;
  int count = 0;
  for (std::size_t row = 200; row < 280; ++row) {
    for (std::size_t column = 310; column < 330; ++column) {
      const std::size_t i = row * 640 + column;
      const double error =
          static_cast<double>(frame.cloud.points[i].z()) - still.cloud.points[i].z();
      sum += error;
      squares += error * error;
      ++count;
    }
  }
  EXPECT_NEAR(sum / count, 0.0, 4.0 * std::sqrt(squares) / count);
  return std::sqrt(squares / count);
}

TEST(DepthCameraTest, ThePlanesNoiseGrowsAsItIsPublished) {
  for (const double depth : {0.5, 0.8, 1.0, 1.5, 2.0, 3.0, 3.8}) {
    const double published = 0.0012 + 0.0019 * (depth - 0.4) * (depth - 0.4);
    EXPECT_NEAR(deviationOf(depth, 0.0), published, 0.07 * published) << depth;
  }
}

TEST(DepthCameraTest, ASlantAddsToTheNoiseAsItIsPublished) {
  for (const double slant_deg : {65.0, 70.0, 75.0}) {
    const double slant = slant_deg * M_PI / 180.0;
    const double share = slant / (M_PI_2 - slant);
    const double published = 0.0012 + 0.0019 * 0.6 * 0.6 + 0.0001 * share * share;
    // Over the pixels taken slant and depth differ a little.
    EXPECT_NEAR(deviationOf(1.0, slant), published, 0.15 * published) << slant_deg;
  }
}

TEST(DepthCameraTest, NothingIsMeasuredOutsideItsRange) {
  DepthCamera camera(noiseless(), 1);
  for (const double depth : {0.29, 4.01}) {
    const auto [cloud, truth] = camera.measure(before({wallAt(depth)}));
    for (const Eigen::Vector3f& point : cloud.points) ASSERT_FALSE(isMeasured(point));
    EXPECT_EQ(truth.front().label, 100U);
  }
  for (const double depth : {0.31, 3.99}) {
    const auto [cloud, truth] = camera.measure(before({wallAt(depth)}));
    for (const Eigen::Vector3f& point : cloud.points) ASSERT_TRUE(isMeasured(point));
  }
  const auto [cloud, truth] = camera.measure(before({}));
  for (const Eigen::Vector3f& point : cloud.points) ASSERT_FALSE(isMeasured(point));
  EXPECT_FALSE(truth.front().found());
}

TEST(DepthCameraTest, ASurfaceAtAGrazingAngleGivesNoDepth) {
  DepthCamera camera(noiseless(), 1);
  // A floor 0.3 m below: at a depth z its slant is that of a ray of slope 0.3 / z.
  Pose floor = at(0.0, 0.35, 0.0);
  const auto [cloud, truth] = camera.measure(before({{Box{Vector3(20.0, 0.05, 20.0)}, floor}}));
  std::size_t measured = 0, grazing = 0;
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    if (!truth[i].found()) continue;
    const double x = (static_cast<double>(i % 640) - 319.5) / 400.0;
    const double y = (static_cast<double>(i / 640) - 239.5) / 400.0;
    const double depth = 0.3 / y;
    const double slant_deg = std::acos(y / std::sqrt(1.0 + x * x + y * y)) * 180.0 / M_PI;
    if (depth > 3.99 || std::abs(slant_deg - 80.0) < 0.01) continue;
    ASSERT_EQ(isMeasured(cloud.points[i]), slant_deg < 80.0 && depth > 0.3) << depth;
    ++(slant_deg < 80.0 ? measured : grazing);
  }
  EXPECT_GT(measured, 30000U);
  EXPECT_GT(grazing, 10000U);
}

TEST(DepthCameraTest, FlyingPixelsAreAtEdgesAloneAndBetweenTheirSurfaces) {
  DepthCamera::Config config = noiseless();
  config.mixed_share = 0.5;
  DepthCamera camera(config, 3);
  const auto frame =
      camera.measure(before({{Box{Vector3(0.2, 0.2, 0.05)}, at(0.0, 0.0, 1.05)}, wallAt(2.0)}));
  std::size_t flying = 0, edges = 0;
  const auto labelAt = [&](std::size_t row, std::size_t column) {
    return frame.truth[row * 640 + column].label;
  };
  for (std::size_t row = 0; row + 1 < 480; ++row) {
    for (std::size_t column = 0; column + 1 < 640; ++column) {
      const std::size_t i = row * 640 + column;
      const bool at_edge = labelAt(row, column) != labelAt(row, column + 1) ||
                           labelAt(row, column) != labelAt(row + 1, column);
      const float depth = frame.cloud.points[i].z();
      edges += at_edge ? 1 : 0;
      flying += frame.truth[i].mixed() ? 1 : 0;
      if (frame.truth[i].mixed()) {
        ASSERT_TRUE(at_edge);
        EXPECT_NE(frame.truth[i].mixed_with, frame.truth[i].label);
        EXPECT_GT(depth, 1.04);
        EXPECT_LT(depth, 1.96);
      } else {
        EXPECT_TRUE(std::abs(depth - 1.0F) < 1e-4F || std::abs(depth - 2.0F) < 1e-4F);
      }
    }
  }
  EXPECT_GT(edges, 600U);
  EXPECT_NEAR(static_cast<double>(flying), 0.5 * static_cast<double>(edges),
              0.15 * static_cast<double>(edges));
}

TEST(DepthCameraTest, AShareOfThePixelsAtAnEdgeIsNotMeasured) {
  DepthCamera::Config config = noiseless();
  config.hole_share = 0.3;
  const Snapshot snapshot =
      before({{Box{Vector3(0.2, 0.2, 0.05)}, at(0.0, 0.0, 1.05)}, wallAt(2.0)});
  const auto frame = DepthCamera(config, 3).measure(snapshot);
  const auto whole = DepthCamera(noiseless(), 3).measure(snapshot);
  std::size_t edges = 0, holes = 0;
  for (std::size_t row = 0; row + 1 < 480; ++row) {
    for (std::size_t column = 0; column + 1 < 640; ++column) {
      const std::size_t i = row * 640 + column;
      const bool at_edge = whole.truth[i].label != whole.truth[i + 1].label ||
                           whole.truth[i].label != whole.truth[i + 640].label;
      const bool is_hole = !isMeasured(frame.cloud.points[i]);
      EXPECT_TRUE(at_edge || !is_hole);
      edges += at_edge ? 1 : 0;
      holes += is_hole ? 1 : 0;
    }
  }
  EXPECT_NEAR(static_cast<double>(holes), 0.3 * static_cast<double>(edges),
              0.07 * static_cast<double>(edges));
}

TEST(DepthCameraTest, OutlinesWaverByAPixelToEitherSide) {
  DepthCamera::Config config = noiseless();
  config.outline_share = 0.27;
  // 160 pixels wide and high; nothing is behind its right half.
  const Snapshot snapshot = before({{Box{Vector3(0.2, 0.2, 0.05)}, at(0.0, 0.0, 1.05)},
                                    {Box{Vector3(10.0, 10.0, 0.05)}, at(-10.0, 0.0, 2.05)}});
  const auto frame = DepthCamera(config, 3).measure(snapshot);
  const auto still = DepthCamera(noiseless(), 3).measure(snapshot);
  std::array<std::size_t, 4> beside{}, other{};  // of pixels with an outline at one side alone
  for (std::size_t row = 1; row + 1 < 480; ++row) {
    for (std::size_t column = 1; column + 1 < 640; ++column) {
      const std::size_t i = row * 640 + column;
      const std::array<std::size_t, 4> around = {i - 1, i + 1, i - 640, i + 640};
      const auto differs = [&](std::size_t k) {
        return still.truth[i].label != still.truth[k].label;
      };
      const bool is_changed = frame.truth[i].label != still.truth[i].label;
      const auto sides = std::count_if(around.begin(), around.end(), differs);
      for (std::size_t k = 0; k < 4; ++k) {
        if (sides != 1 || !differs(around[k])) continue;
        ++beside[k];
        other[k] += is_changed ? 1 : 0;
      }
      EXPECT_TRUE(sides > 0 || !is_changed);
      EXPECT_EQ(frame.truth[i].found(), isMeasured(frame.cloud.points[i]));
      if (!frame.truth[i].found()) continue;
      EXPECT_NEAR(frame.cloud.points[i].z(), frame.truth[i].label == 100 ? 1.0 : 2.0, 1e-4);
    }
  }
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_GT(beside[k], 300U);
    EXPECT_NEAR(static_cast<double>(other[k]) / static_cast<double>(beside[k]), 0.27, 0.09) << k;
  }
}

TEST(DepthCameraTest, SurfacesNearEachOtherAndTheFacesOfOneTargetDoNotMix) {
  DepthCamera::Config config = noiseless();
  config.mixed_share = 1.0;
  config.mixed_persistence = 0.0;
  DepthCamera camera(config, 3);
  Pose tilted = at(0.3, 0.2, 1.5);
  tilted.rotate(Eigen::AngleAxisd(0.6, Vector3(1.0, 2.0, 0.5).normalized()));
  const auto frame =
      camera.measure(before({{Box{Vector3(0.2, 0.2, 0.01)}, at(0.0, 0.0, 1.99)}, wallAt(2.0)}));
  const auto alone = camera.measure(before({{Box{Vector3(0.2, 0.2, 0.2)}, tilted}}));
  for (const PointTruth& truth : frame.truth) EXPECT_FALSE(truth.mixed());
  for (const PointTruth& truth : alone.truth) EXPECT_FALSE(truth.mixed());
}

TEST(DepthCameraTest, TheSimulatedSceneIsWhereRaysMeetIt) {
  Simulator simulator(Simulator::Config{});
  Snapshot snapshot{Time{}, Pose::Identity(), bodyOf(simulator.world()), {}};
  for (std::size_t i = 0; i < snapshot.targets.shapes.size(); ++i) snapshot.labels.push_back(i);
  Random random(11);
  DepthCamera::Config config = small(noiseless());
  config.grazing_deg = 90.0;
  DepthCamera camera(config, 1);
  for (int view = 0; view < 30; ++view) {
    snapshot.T_fixed_sensor.linear() = random.rotation();
    snapshot.T_fixed_sensor.translation() =
        Vector3(random.uniform(-0.5, 1.5), random.uniform(-1.0, 1.0), random.uniform(0.8, 1.8));
    const auto [cloud, truth] = camera.measure(snapshot);
    std::size_t differ = 0;
    for (std::size_t i = 0; i < cloud.points.size(); ++i) {
      const Vector3 ray((static_cast<double>(i % 64) - 31.5) / 40.0,
                        (static_cast<double>(i / 64) - 23.5) / 40.0, 1.0);
      const Ray in_fixed{snapshot.T_fixed_sensor.translation(),
                         snapshot.T_fixed_sensor.linear() * ray.normalized()};
      double depth = std::numeric_limits<double>::infinity();
      for (std::size_t k = 0; k < snapshot.targets.shapes.size(); ++k) {
        const auto span = intersect(snapshot.targets.shapes[k],
                                    transformed(in_fixed, snapshot.targets.poses[k].inverse()));
        if (span) depth = std::min(depth, span->enter / ray.norm());
      }
      const bool within = depth >= 0.3 && depth <= 4.0;
      const bool same = isMeasured(cloud.points[i])
                            ? std::abs(static_cast<double>(cloud.points[i].z()) - depth) < 1e-4
                            : !within;
      differ += same ? 0 : 1;
    }
    EXPECT_LE(differ, 3U);  // rays along an outline
  }
}

TEST(DepthCameraTest, TheSameSeedGivesTheSameFramesAndAnotherOthers) {
  const Snapshot snapshot = before({{Sphere{0.2}, at(0.1, 0.0, 1.0)}, wallAt(2.0)});
  DepthCamera one(small({}), 1), same(small({}), 1), other(small({}), 2);
  std::size_t differ = 0;
  for (int frame = 0; frame < 3; ++frame) {
    const SimulatedCloud a = one.measure(snapshot), b = same.measure(snapshot),
                         c = other.measure(snapshot);
    for (std::size_t i = 0; i < a.cloud.points.size(); ++i) {
      if (!isMeasured(a.cloud.points[i])) continue;
      EXPECT_EQ(a.cloud.points[i], b.cloud.points[i]);
      EXPECT_EQ(a.truth[i].mixed_with, b.truth[i].mixed_with);
      differ += a.cloud.points[i] != c.cloud.points[i] ? 1 : 0;
    }
  }
  EXPECT_GT(differ, 3U * 64U * 24U);
}

TEST(DepthCameraTest, RefusesWhatIsNoCamera) {
  DepthCamera::Config config;
  config.depth_min_m = 5.0;
  EXPECT_EQ(test::errorOf([&] { DepthCamera(config, 1); }).find("depth_min_m"), 0U);
  config = {};
  config.mixed_share = 1.5;
  EXPECT_EQ(test::errorOf([&] { DepthCamera(config, 1); }).find("mixed_share"), 0U);
}

}  // namespace
}  // namespace tccm::simulation
