#include "simulation/lidar.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "geometry/ray.h"
#include "simulation/world.h"
#include "support/random.h"
#include "support/standing_targets.h"

namespace tccm::simulation {
namespace {

using test::Random;
using test::snapshotOf;
using test::standing;

constexpr double kTurn = 0.1;  // [s]

Lidar::Config noiseless() {
  Lidar::Config config;
  config.noise_m = 0.0;
  return config;
}

Lidar::Config coarse(Lidar::Config config) {
  config.rows = 16;
  config.columns = 128;
  return config;
}

/// Of a point, in the sensor's frame.
Vector3 directionOf(const Lidar::Config& config, std::size_t row, std::size_t column) {
  const double azimuth =
      M_PI - 2.0 * M_PI * static_cast<double>(column) / static_cast<double>(config.columns);
  const double elevation =
      config.elevation_max_deg * M_PI / 180.0 *
      (1.0 - 2.0 * static_cast<double>(row) / static_cast<double>(config.rows - 1));
  return {std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
          std::sin(elevation)};
}

TEST(LidarTest, ATurnHasTheFormAndTheTimesOfItsModel) {
  Lidar lidar(noiseless(), 1);
  const Cloud cloud =
      lidar.measure(Time{}, standing({{Box{Vector3(9.0, 9.0, 0.1)}, at(0.0, 0.0, -1.1)}})).cloud;
  EXPECT_EQ(cloud.width, 1024U);
  EXPECT_EQ(cloud.height, 64U);
  ASSERT_EQ(cloud.offsets_s.size(), 65536U);
  for (std::size_t i = 0; i < cloud.offsets_s.size(); ++i) {
    ASSERT_NEAR(cloud.offsets_s[i], kTurn * static_cast<double>(i % 1024) / 1024.0, 1e-7);
  }
  EXPECT_EQ(cloud.first_offset_s, 0.0);
  EXPECT_NEAR(cloud.last_offset_s, kTurn * 1023.0 / 1024.0, 1e-7);
  // The first column looks behind, that after a quarter of a turn to the left.
  EXPECT_LT(cloud.points[63 * 1024].x(), -3.0F);
  EXPECT_GT(cloud.points[63 * 1024 + 256].y(), 3.0F);
  EXPECT_FALSE(isMeasured(cloud.points[0]));
}

TEST(LidarTest, TimesAreThoseOfTheColumnsThatMeasuredSomething) {
  Lidar lidar(noiseless(), 1);
  const Cloud cloud = lidar.measure(Time{}, standing({{Sphere{0.3}, at(3.0, 0.0, 0.0)}})).cloud;
  EXPECT_NEAR(cloud.first_offset_s, 0.5 * kTurn * (1.0 - std::asin(0.1) / M_PI), 1e-4);
  EXPECT_NEAR(cloud.last_offset_s, 0.5 * kTurn * (1.0 + std::asin(0.1) / M_PI), 1e-4);
  const Cloud nothing = lidar.measure(Time{}, standing({})).cloud;
  EXPECT_EQ(nothing.first_offset_s, 0.0);
  EXPECT_EQ(nothing.last_offset_s, 0.0);
}

TEST(LidarTest, PointsAreWhereRaysMeetTheTargets) {
  for (unsigned seed = 1; seed <= 8; ++seed) {
    Random random(seed);
    std::vector<std::pair<Shape, Pose>> targets;
    for (int i = 0; i < 80; ++i) {
      const Pose pose = random.pose(3.0);
      if (pose.translation().norm() < 1.2) continue;
      targets.emplace_back(expanded(random.shape(targets.size() % test::kShapeKinds), {2.0, 0.0}),
                           pose);
    }
    const Lidar::Config config = coarse(noiseless());
    Lidar lidar(config, 1);
    const auto [cloud, truth] = lidar.measure(Time{}, standing(targets));
    for (std::size_t i = 0; i < cloud.points.size(); ++i) {
      const Vector3 direction = directionOf(config, i / config.columns, i % config.columns);
      double range = std::numeric_limits<double>::infinity();
      std::size_t label = 0;
      for (std::size_t k = 0; k < targets.size(); ++k) {
        const auto span = intersect(targets[k].first, transformed({Vector3::Zero(), direction},
                                                                  targets[k].second.inverse()));
        if (!span || span->enter >= range) continue;
        range = span->enter;
        label = k;
      }
      ASSERT_EQ(isMeasured(cloud.points[i]), range >= 0.8 && std::isfinite(range));
      if (std::isinf(range)) continue;
      ASSERT_EQ(truth[i].label, label);
      if (range < 0.8) continue;
      ASSERT_LT((cloud.points[i].cast<double>() - range * direction).norm(), 1e-5);
    }
  }
}

TEST(LidarTest, EachColumnIsSeenFromWhereTheSensorWasAtItsOwnTime) {
  const Lidar::Config config = coarse(noiseless());
  const std::pair<Shape, Pose> room = {Cylinder{5.0, 0.1}, at(0.0, 0.0, -1.1)};
  std::vector<Snapshot> moving;
  for (int ms = 0; ms <= 100; ms += 2) {
    const double s = 1e-3 * ms;
    Snapshot snapshot = snapshotOf(Time{std::chrono::milliseconds(ms)}, {room});
    snapshot.T_fixed_sensor = at(0.5 * s, -0.3 * s, 2.0 * s);
    snapshot.T_fixed_sensor.rotate(Eigen::AngleAxisd(1.5 * s, Vector3(0.2, 0.1, 1.0).normalized()));
    moving.push_back(snapshot);
  }
  Lidar lidar(config, 1);
  const Cloud cloud = lidar.measure(Time{}, moving).cloud;
  std::size_t measured = 0;
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    if (!isMeasured(cloud.points[i])) continue;
    ++measured;
    const double s = static_cast<double>(cloud.offsets_s[i]);
    Pose T_fixed_sensor = at(0.5 * s, -0.3 * s, 2.0 * s);
    T_fixed_sensor.rotate(Eigen::AngleAxisd(1.5 * s, Vector3(0.2, 0.1, 1.0).normalized()));
    EXPECT_NEAR((T_fixed_sensor * cloud.points[i].cast<double>()).z(), -1.0, 1e-5);
  }
  EXPECT_GT(measured, 300U);
}

TEST(LidarTest, EachColumnMeetsWhatIsThereAtItsOwnTime) {
  const Shape floor = Box{Vector3(9.0, 9.0, 0.1)};
  std::vector<Snapshot> rising;
  for (int ms = 0; ms <= 100; ms += 2) {
    rising.push_back(snapshotOf(Time{std::chrono::milliseconds(ms)},
                                {{floor, at(0.0, 0.0, -1.6 + 0.005 * ms)}}));
  }
  const Lidar::Config config = coarse(noiseless());
  Lidar lidar(config, 1);
  const Cloud cloud = lidar.measure(Time{}, rising).cloud;
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    if (!isMeasured(cloud.points[i])) continue;
    EXPECT_NEAR(cloud.points[i].z(), -1.5 + 5.0 * static_cast<double>(cloud.offsets_s[i]), 0.0051);
  }
}

TEST(LidarTest, NoiseHasTheSameDeviationAtAnyRange) {
  Lidar lidar({}, 3);
  for (const double radius : {2.0, 8.0}) {
    // A ball around the sensor, seen from outside of it: from a shell of balls.
    std::vector<std::pair<Shape, Pose>> targets;
    for (const double sign : {-1.0, 1.0}) {
      targets.emplace_back(Box{Vector3(0.1, 50.0, 50.0)}, at(sign * (radius + 0.1), 0.0, 0.0));
    }
    const Cloud cloud = lidar.measure(Time{}, standing(targets)).cloud;
    double squares = 0.0;
    int count = 0;
    for (std::size_t i = 0; i < cloud.points.size(); ++i) {
      const Vector3 direction = directionOf({}, i / 1024, i % 1024);
      if (std::abs(direction.x()) < 0.5) continue;
      const double error =
          static_cast<double>(cloud.points[i].norm()) - radius / std::abs(direction.x());
      squares += error * error;
      ++count;
    }
    EXPECT_NEAR(std::sqrt(squares / count), 0.03, 0.0005);
  }
}

TEST(LidarTest, TheSameSeedGivesTheSameTurns) {
  const auto scene = standing({{Sphere{0.5}, at(3.0, 0.0, 0.0)}});
  Lidar one(coarse({}), 1), same(coarse({}), 1), other(coarse({}), 2);
  const Cloud a = one.measure(Time{}, scene).cloud, b = same.measure(Time{}, scene).cloud,
              c = other.measure(Time{}, scene).cloud;
  std::size_t differ = 0, measured = 0;
  for (std::size_t i = 0; i < a.points.size(); ++i) {
    if (!isMeasured(a.points[i])) continue;
    ++measured;
    EXPECT_EQ(a.points[i], b.points[i]);
    differ += a.points[i] != c.points[i] ? 1 : 0;
  }
  EXPECT_GT(measured, 20U);
  EXPECT_GT(differ, measured / 2);
}

}  // namespace
}  // namespace tccm::simulation
