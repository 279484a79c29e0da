#include <gtest/gtest.h>

#include <limits>

#include "monitor_config.h"
#include "support/nodding_sensor.h"
#include "support/tiny_robot.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

using test::kSensor;
using test::kTableHeight;
using test::kTiltPeriod;

constexpr double kScanPeriod = 0.02;

Time at(double seconds) { return Time(fromSeconds(seconds)); }

/// Looks down by 0.4 to 0.9 rad.
Pose sensorAt(double seconds) { return test::noddingSensor(seconds, 0.25); }

/// Of an endless table.
LaserScan scanOfTable(double seconds) {
  return test::scanBy(sensorAt(seconds), at(seconds), [](const Vector3& direction) {
    return (kTableHeight - kSensor.z()) / direction.z();
  });
}

Monitor::Config configuration() {
  Monitor::Config config;
  config.sensors.front().mapper.map.scans_max = 256;
  config.checker.pose.check_occlusion = false;
  return config;
}

/// A ball of 50 mm on a vertical slide, 0.8 m ahead, at "height" above the floor.
std::string ballOnSlide() {
  return test::robotOf(
      test::linkOf("base") + test::ballLink("ball") +
      test::jointOf("height", "prismatic", "base", "ball",
                    "<origin xyz=\"0.8 0 0\"/>" + test::axisOf("0 0 1") + test::limitOf("0", "2")));
}

class MonitorTest : public ::testing::Test {
 protected:
  /// Scans and joint states up to a time, the ball at one height. @return the last outcome.
  Monitor::ScanOutcome runUntil(Monitor& monitor, double end, double height) {
    Monitor::ScanOutcome outcome;
    PosePath root;
    root.add(at(0.0), Pose::Identity());
    root.add(at(1000.0), Pose::Identity());
    for (; now_ < end; now_ += kScanPeriod) {
      monitor.addJoints(at(now_), at(now_ - 0.005), {"height"}, {height}, {0.0});
      monitor.addJoints(at(now_ + 0.005), at(now_ + 0.005), {"height"}, {height}, {0.0});
      PosePath sensor;
      sensor.add(at(now_ - 0.001), sensorAt(now_ - 0.001));
      sensor.add(at(now_), sensorAt(now_));
      sensor.add(at(now_ + 0.001), sensorAt(now_ + 0.001));
      outcome = monitor.addScan(at(now_ + 0.01), scanOfTable(now_), sensor, {root});
      EXPECT_EQ(outcome.dropped, "");
      if (!monitor.hasRobot()) continue;
      monitor.checker().setRootPose(0, Time(), Pose::Identity(), true);
      verdict_ = &monitor.checker().check(at(now_ + 0.01));
      if (verdict_->level == Level::kOk && !first_ok_) first_ok_ = now_;
    }
    return outcome;
  }

  double now_ = 100.0;
  std::optional<double> first_ok_;
  const Verdict* verdict_ = nullptr;
};

TEST_F(MonitorTest, ARobotOverATableIsUnknownThenFreeThenInCollision) {
  Monitor monitor(configuration(), test::modelOf(ballOnSlide()));
  ASSERT_TRUE(monitor.hasRobot());
  runUntil(monitor, 101.0, 0.8);
  EXPECT_EQ(verdict_->reason, Reason::kInit);
  EXPECT_TRUE(verdict_->stop);
  EXPECT_FALSE(verdict_->known);
  runUntil(monitor, 103.0, 0.8);
  EXPECT_EQ(verdict_->reason, Reason::kClear) << verdict_->detail;
  ASSERT_TRUE(first_ok_);
  EXPECT_GT(*first_ok_, 100.0 + kTiltPeriod);
  runUntil(monitor, 103.1, kTableHeight + 0.05);
  EXPECT_EQ(verdict_->reason, Reason::kCollision);
  EXPECT_EQ(verdict_->link, "ball");
  EXPECT_TRUE(verdict_->known);
}

TEST_F(MonitorTest, TheTableIsInTheMapAtItsHeight) {
  Monitor monitor(configuration(), nullptr);
  EXPECT_EQ(monitor.map(), nullptr);
  const auto outcome = runUntil(monitor, 103.0, 0.8);
  EXPECT_GT(outcome.added.mapped, 0U);
  const CuboidMap& map = *monitor.map();
  EXPECT_TRUE(map.complete);
  ASSERT_GT(map.cuboids.size(), 500U);
  for (const Cuboid& cuboid : map.cuboids) {
    EXPECT_NEAR(map.grid.metres(cuboid.top), kTableHeight, 0.0011);
    EXPECT_NEAR(map.grid.metres(cuboid.bottom), kTableHeight - 0.02, 0.0011);
  }
  EXPECT_NEAR(toSeconds(map.window), 1.1 * kTiltPeriod, 2.0 * kScanPeriod);
}

TEST_F(MonitorTest, WithoutARobotThereIsAMapAndNothingIsChecked) {
  Monitor monitor(configuration(), nullptr);
  EXPECT_FALSE(monitor.hasRobot());
  EXPECT_EQ(monitor.body(), nullptr);
  runUntil(monitor, 100.1, 0.8);
  ASSERT_NE(monitor.map(), nullptr);
  EXPECT_EQ(monitor.map()->serial, monitor.mapper().map().serial());
}

TEST_F(MonitorTest, TheRobotItselfDoesNotReachTheMap) {
  Monitor filtering(configuration(), test::modelOf(ballOnSlide()));
  const auto outcome = runUntil(filtering, 100.5, kTableHeight);
  Monitor::Config config = configuration();
  config.sensors.front().scan.self_filter = false;
  Monitor open(config, test::modelOf(ballOnSlide()));
  EXPECT_EQ(open.body(), nullptr);
  now_ = 100.0;
  const auto unfiltered = runUntil(open, 100.5, kTableHeight);
  const auto of = [](const Monitor::ScanOutcome& o, BeamKind kind) {
    return o.beams[static_cast<std::size_t>(kind)];
  };
  EXPECT_GT(filtering.map()->cuboids.size(), 0U);
  EXPECT_LT(filtering.map()->cuboids.size(), open.map()->cuboids.size());
  EXPECT_EQ(of(unfiltered, BeamKind::kSelf), 0U);
  EXPECT_LE(of(outcome, BeamKind::kReturn), of(unfiltered, BeamKind::kReturn));
}

TEST_F(MonitorTest, AScanThatCannotBePlacedIsDroppedWithItsReason) {
  Monitor monitor(configuration(), test::modelOf(ballOnSlide()));
  PosePath sensor, root;
  sensor.add(at(99.9), sensorAt(99.9));
  sensor.add(at(100.1), sensorAt(100.1));
  root.add(at(0.0), Pose::Identity());
  root.add(at(1000.0), Pose::Identity());
  const LaserScan scan = scanOfTable(100.0);
  EXPECT_EQ(monitor.addScan(at(100.1), scan, sensor, {root}).dropped, "no_joint_states");
  monitor.addJoints(at(99.99), at(99.99), {"height"}, {0.8}, {});
  monitor.addJoints(at(100.05), at(100.05), {"height"}, {0.8}, {});
  EXPECT_EQ(monitor.addScan(at(100.1), scan, sensor, {PosePath()}).dropped, "no_transform");
  LaserScan broken = scan;
  broken.range_max = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(monitor.addScan(at(100.1), broken, sensor, {root}).dropped, "malformed");
  EXPECT_EQ(monitor.map(), nullptr);
  EXPECT_EQ(monitor.addScan(at(100.1), scan, sensor, {root}).dropped, "");
  EXPECT_EQ(monitor.addScan(at(100.1), scan, sensor, {root}).dropped, "out_of_order");
  EXPECT_EQ(monitor.map()->serial, 1U);
}

TEST_F(MonitorTest, AfterAResetItIsAsAtTheStartButSerialsGoOn) {
  Monitor monitor(configuration(), test::modelOf(ballOnSlide()));
  runUntil(monitor, 103.0, 0.8);
  ASSERT_EQ(verdict_->reason, Reason::kClear);
  const std::uint32_t serial = monitor.map()->serial;
  monitor.reset();
  EXPECT_EQ(monitor.map(), nullptr);
  now_ = 50.0;
  runUntil(monitor, 51.0, 0.8);
  EXPECT_EQ(verdict_->reason, Reason::kInit);
  EXPECT_GT(monitor.map()->serial, serial);
}

TEST_F(MonitorTest, TwoMonitorsGiveTheSameVerdictsForTheSameInput) {
  Monitor one(configuration(), test::modelOf(ballOnSlide())),
      other(configuration(), test::modelOf(ballOnSlide()));
  runUntil(one, 102.5, 0.6);
  now_ = 100.0;
  runUntil(other, 102.5, 0.6);
  ASSERT_EQ(one.map()->cuboids.size(), other.map()->cuboids.size());
  for (std::size_t i = 0; i < one.map()->cuboids.size(); ++i) {
    const Cuboid &a = one.map()->cuboids[i], &b = other.map()->cuboids[i];
    EXPECT_EQ(std::tie(a.cell, a.bottom, a.top, a.points, a.age_scans),
              std::tie(b.cell, b.bottom, b.top, b.points, b.age_scans));
  }
}

TEST(TakeReturnsTest, OnlyWhatIsForTheMapIsTaken) {
  AssembledScan scan;
  scan.stamp = at(5.0);
  for (std::size_t kind = 0; kind < kBeamKinds; ++kind) {
    scan.beams.push_back({at(5.0), Vector3(1.0, 0.0, 0.0), Vector3(0.0, 0.0, 1.0), 0.1,
                          static_cast<BeamKind>(kind)});
  }
  scan.beams.back().viewpoint = Vector3(0.0, 0.0, 2.0);
  scan.beams.back().tilt = 0.2;
  ScanReturns returns;
  takeReturns(scan, returns);
  EXPECT_EQ(returns.points.size(), 1U);
  EXPECT_EQ(returns.stamp, at(5.0));
  EXPECT_EQ(returns.tilt, 0.1);
  EXPECT_EQ(returns.viewpoint, Vector3(0.0, 0.0, 2.0));
}

TEST(MonitorsConfigTest, AConfigurationThatMustNotBeRunWithIsRefused) {
  Monitor::Config config = configuration();
  config.sensors.front().mapper.map.thickness_m = 0.0;
  EXPECT_THROW(Monitor(config, nullptr), ConfigError);
}

}  // namespace
}  // namespace tccm
