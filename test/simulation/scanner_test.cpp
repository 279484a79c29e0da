#include "simulation/scanner.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/ray.h"
#include "simulation/world.h"
#include "support/random.h"
#include "support/standing_targets.h"

namespace tccm::simulation {
namespace {

using test::Random;
using test::snapshotOf;
using test::standing;

Scanner::Config noiseless() {
  Scanner::Config config;
  config.noise_m = 0.0;
  return config;
}

double azimuthOf(const LaserScan& scan, std::size_t beam) {
  return scan.angle_min + static_cast<double>(beam) * scan.angle_increment;
}

TEST(ScannerTest, HasTheBeamsAnglesAndTimesOfItsModel) {
  Scanner scanner(noiseless(), 1);
  const LaserScan scan = scanner.measure(Time{}, standing({})).scan;
  ASSERT_EQ(scan.ranges.size(), 667U);
  EXPECT_NEAR(azimuthOf(scan, 0), -azimuthOf(scan, 666), 1e-9);
  EXPECT_NEAR(azimuthOf(scan, 666), 120.0 * M_PI / 180.0, 0.0025);
  EXPECT_NEAR(toSeconds(scan.lastBeamTime() - scan.stamp), 0.028 * 240.0 / 360.0, 1e-4);
  for (const float range : scan.ranges) EXPECT_EQ(range, std::numeric_limits<float>::infinity());
}

TEST(ScannerTest, RangesToAWallAreItsDistanceOverTheCosine) {
  Scanner scanner(noiseless(), 1);
  const auto [scan, truth] =
      scanner.measure(Time{}, standing({{Box{Vector3(0.05, 10.0, 1.0)}, at(1.55, 0.0, 0.0)}}));
  for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
    const double expected = 1.5 / std::cos(azimuthOf(scan, i));
    if (expected > 0.0 && expected < 4.0) {
      EXPECT_NEAR(scan.ranges[i], expected, 1e-5);
      EXPECT_EQ(truth[i].label, 0U);
    } else if (expected < 0.0 || expected > 4.1) {
      EXPECT_TRUE(std::isinf(scan.ranges[i]));
      EXPECT_FALSE(truth[i].label);
    }
  }
}

TEST(ScannerTest, TheRangeToAPillarAheadIsItsDistanceLessItsRadius) {
  Scanner scanner(noiseless(), 1);
  const LaserScan scan =
      scanner.measure(Time{}, standing({{Cylinder{0.2, 1.0}, at(2.0, 0.0, 0.0)}})).scan;
  EXPECT_NEAR(scan.ranges[333], 1.8, 1e-6);
}

TEST(ScannerTest, EachBeamMeetsWhatIsThereAtItsOwnTime) {
  const Shape wall = Box{Vector3(0.5, 10.0, 1.0)};
  std::vector<Snapshot> approaching;
  for (int ms = 0; ms <= 20; ++ms) {
    approaching.push_back(
        snapshotOf(Time{std::chrono::milliseconds(ms)}, {{wall, at(2.5 - 0.01 * ms, 0.0, 0.0)}}));
  }
  Scanner scanner(noiseless(), 1);
  const LaserScan scan = scanner.measure(Time{}, approaching).scan;
  for (std::size_t i = 200; i < 467; ++i) {
    const double wall_x = 2.0 - 10.0 * toSeconds(scan.beamTime(i));
    EXPECT_NEAR(scan.ranges[i] * std::cos(azimuthOf(scan, i)), wall_x, 0.0051);
  }
}

/// The nearest surface by rays on every target of the nearest snapshot. @pre two snapshots
double rangeByAll(const std::vector<Snapshot>& snapshots, Time stamp, double azimuth) {
  const double u =
      toSeconds(stamp - snapshots[0].stamp) / toSeconds(snapshots[1].stamp - snapshots[0].stamp);
  const Pose T_fixed_sensor =
      Interpolation(snapshots[0].T_fixed_sensor, snapshots[1].T_fixed_sensor).at(u);
  const Ray ray{T_fixed_sensor.translation(),
                T_fixed_sensor.linear() * Vector3(std::cos(azimuth), std::sin(azimuth), 0.0)};
  const Body& targets = snapshots[u <= 0.5 ? 0 : 1].targets;
  double range = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < targets.shapes.size(); ++i) {
    const auto span = intersect(targets.shapes[i], transformed(ray, targets.poses[i].inverse()));
    if (span) range = std::min(range, span->enter);
  }
  return range;
}

/// @param turn and step of the sensor during the scan
void expectRangesByAll(unsigned seed, const Vector3& turn, const Vector3& step) {
  Random random(seed);
  std::vector<std::pair<Shape, Pose>> targets;
  for (int i = 0; i < 300; ++i) {
    const Pose pose = random.pose(2.0);
    if (pose.translation().norm() < 0.5) continue;  // the sensor is not to be within it
    targets.emplace_back(random.shape(targets.size() % test::kShapeKinds), pose);
  }
  std::vector<Snapshot> snapshots = standing(targets);
  snapshots[0].T_fixed_sensor.linear() = random.rotation();
  snapshots[1].T_fixed_sensor =
      snapshots[0].T_fixed_sensor * Eigen::AngleAxisd(turn.norm(), turn.normalized());
  snapshots[1].T_fixed_sensor.translation() += step;
  Scanner::Config config = noiseless();
  config.mixed_share = 0.0;
  Scanner scanner(config, 1);
  const LaserScan scan = scanner.measure(Time{}, snapshots).scan;
  std::size_t met = 0;
  for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
    const double expected = rangeByAll(snapshots, scan.beamTime(i), azimuthOf(scan, i));
    ASSERT_EQ(std::isfinite(expected) && expected <= config.range_max_m,
              std::isfinite(scan.ranges[i]))
        << i;
    if (!std::isfinite(scan.ranges[i])) continue;
    ASSERT_NEAR(scan.ranges[i], expected, 1e-5) << i;
    ++met;
  }
  EXPECT_GT(met, 20U);
}

TEST(ScannerTest, RangesOfASensorThatTurnsAreThoseOfRaysOnEveryTarget) {
  const Vector3 x = Vector3::UnitX(), y = Vector3::UnitY(), z = Vector3::UnitZ();
  for (unsigned seed = 1; seed <= 20; ++seed) {
    expectRangesByAll(seed, 0.03 * y, 0.002 * x);
    expectRangesByAll(seed, 0.06 * y, 0.008 * z);
    expectRangesByAll(seed, 0.5 * y, 0.1 * z);
    expectRangesByAll(seed, 0.2 * z, 0.005 * z);
  }
}

TEST(ScannerTest, NoiseHasTheDeviationAskedFor) {
  Scanner scanner(Scanner::Config{}, 3);
  const auto scene = standing({{Box{Vector3(0.05, 10.0, 1.0)}, at(1.05, 0.0, 0.0)}});
  double sum = 0.0;
  int count = 0;
  for (int scan = 0; scan < 20; ++scan) {
    const LaserScan measured = scanner.measure(Time{}, scene).scan;
    for (std::size_t i = 200; i < 467; ++i) {
      const double error = measured.ranges[i] - 1.0 / std::cos(azimuthOf(measured, i));
      sum += error * error;
      ++count;
    }
  }
  EXPECT_NEAR(std::sqrt(sum / count), 0.01, 0.0005);
}

TEST(ScannerTest, DoesNotSeeItsOwnHousingAndSaysTooCloseBelowItsLeastRange) {
  Scanner scanner(noiseless(), 1);
  const LaserScan scan =
      scanner
          .measure(Time{}, standing({{Box{Vector3(0.03, 0.03, 0.03)}, at(0.0, 0.0, 0.0)},
                                     {Sphere{0.02}, at(0.06, 0.0, 0.0)}}))
          .scan;
  EXPECT_EQ(scan.ranges[333], -std::numeric_limits<float>::infinity());
  EXPECT_EQ(scan.ranges[600], std::numeric_limits<float>::infinity());
}

TEST(ScannerTest, AboutHalfOfTheBeamsOnAnEdgeMeasureSomethingInBetween) {
  Scanner scanner(noiseless(), 5);
  const auto scene = standing({{Box{Vector3(0.05, 0.3, 1.0)}, at(1.05, 0.0, 0.0)},
                               {Box{Vector3(0.05, 10.0, 1.0)}, at(2.05, 0.0, 0.0)}});
  int edges = 0;
  int mixed = 0;
  for (int scan = 0; scan < 2000; ++scan) {
    const auto measured = scanner.measure(Time{}, scene);
    for (std::size_t i = 0; i < measured.truth.size(); ++i) {
      if (!measured.truth[i].mixed) continue;
      ++mixed;
      EXPECT_GT(measured.scan.ranges[i], 1.0);
      EXPECT_LT(measured.scan.ranges[i], 2.2);
    }
    edges += 2;
  }
  EXPECT_GT(mixed, edges / 3);
  EXPECT_LT(mixed, edges * 4 / 3);
}

}  // namespace
}  // namespace tccm::simulation
