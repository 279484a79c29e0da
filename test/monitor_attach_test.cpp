/// Monitor::attach and detach: a mug in front of a hand, over a table, seen by a tilting scanner.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <tuple>

#include "geometry/ray.h"
#include "monitor_config.h"
#include "support/nodding_sensor.h"
#include "support/tiny_robot.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

using test::kSensor;
using test::kTableHeight;
using test::kTiltPeriod;

constexpr double kHandHeight = 0.60;
constexpr double kScanPeriod = 0.01;
constexpr double kForgetPadding = 0.05;
/// How far a return may have been from the middle of its cell at its height.
constexpr double kPlaceDoubt = 0.015;

Time at(double seconds) { return Time(fromSeconds(seconds)); }

/// Looks down by 0.35 to 0.95 rad.
Pose sensorAt(double seconds) { return test::noddingSensor(seconds, 0.30); }

Pose placedAt(const Vector3& p) {
  Pose pose = Pose::Identity();
  pose.translation() = p;
  return pose;
}

/// A mug of 70 mm by 120 mm, 75 mm in front of the hand.
AttachedObject mug() {
  return {"mug", "hand", {Cylinder{0.035, 0.06}, placedAt(Vector3(-0.16, 0.0, 0.0))}};
}

/// A ball of 50 mm that slides along x.
std::shared_ptr<const RobotModel> robot() {
  return test::modelOf(
      test::robotOf(test::linkOf("base") + test::ballLink("hand") +
                    test::jointOf("reach", "prismatic", "base", "hand",
                                  "<origin xyz=\"0 0 0.6\"/>" + test::axisOf("1 0 0") +
                                      test::limitOf("0", "2"))));
}

Monitor::Config configuration() {
  Monitor::Config config;
  config.checker.evidence.unseen_fraction_max = 1.0;  // the sensor of this test looks at little
  config.sensors.front().mapper.map.scans_max = 512;
  config.checker.pose.check_occlusion = false;
  // The post stands 40 mm beside the hand's way.
  config.checker.pose.collision_use.expansion.padding_m = 0.03;
  config.checker.braking.margin_max_m =
      0.0;  // what touches is asked here, not how near it may come
  return config;
}

class MonitorAttachTest : public ::testing::Test {
 protected:
  MonitorAttachTest() {
    root_.add(at(0.0), Pose::Identity());
    root_.add(at(1000.0), Pose::Identity());
  }

  [[nodiscard]] double reachAt(double seconds) const {
    return reach_ + speed_ * (seconds - moved_at_);
  }
  /// Where the mug is, held by the hand or not: it moves with the hand.
  [[nodiscard]] Pose mugAt(double seconds) const {
    return placedAt(Vector3(reachAt(seconds), 0.0, kHandHeight)) * mug().primitive.pose;
  }

  /// Of table, post, hand and mug.
  [[nodiscard]] LaserScan scanAt(double seconds) const {
    std::vector<PlacedShape> seen{
        {Box{Vector3(0.03, 0.03, 0.15)}, placedAt(Vector3(0.65, 0.12, 0.55))},
        {Sphere{0.05}, placedAt(Vector3(reachAt(seconds), 0.0, kHandHeight))}};
    if (mug_is_there_) seen.push_back({mug().primitive.shape, mugAt(seconds)});
    return test::scanBy(sensorAt(seconds), at(seconds), [&seen](const Vector3& direction) {
      double range = (kTableHeight - kSensor.z()) / direction.z();
      for (const PlacedShape& placed : seen) {
        const auto span =
            intersect(placed.shape, transformed({kSensor, direction}, placed.pose.inverse()));
        if (span) range = std::min(range, span->enter);
      }
      return range;
    });
  }

  Monitor::ScanOutcome step(Monitor& monitor) {
    for (const double stamp : {now_ - 0.5 * kScanPeriod, now_ + 0.5 * kScanPeriod}) {
      monitor.addJoints(at(stamp), at(stamp), {"reach"}, {reachAt(stamp)}, {speed_});
    }
    PosePath sensor;
    for (const double offset : {-0.001, 0.0, 0.001}) {
      sensor.add(at(now_ + offset), sensorAt(now_ + offset));
    }
    auto outcome = monitor.addScan(at(now_ + 0.005), scanAt(now_), sensor, {root_});
    EXPECT_EQ(outcome.dropped, "");
    monitor.checker().setRootPose(0, Time(), Pose::Identity(), true);
    const Verdict& verdict = monitor.checker().check(at(now_ + 0.005));
    reason_ = verdict.reason;
    detail_ = verdict.detail;
    worst_ = std::max(worst_, reason_);
    self_ += outcome.beams[static_cast<std::size_t>(BeamKind::kSelf)];
    now_ += kScanPeriod;
    return outcome;
  }
  /// With the hand standing, or moving on from where it is. @return the worst reason meanwhile.
  Reason runFor(Monitor& monitor, double seconds, double speed = 0.0) {
    reach_ = reachAt(now_);
    moved_at_ = now_;
    speed_ = speed;
    worst_ = Reason::kClear;
    self_ = 0;
    for (const double end = now_ + seconds; now_ < end;) step(monitor);
    return worst_;
  }

  struct Seen {
    Vector3 middle;
    std::uint32_t points;
    bool operator==(const Seen& other) const {
      return middle == other.middle && points == other.points;
    }
  };
  /// Every cuboid of the map.
  static std::vector<Seen> seenBy(const Monitor& monitor) {
    const CuboidMap& map = *monitor.map();
    std::vector<Seen> seen;
    for (const Cuboid& cuboid : map.cuboids) {
      Vector3 middle;
      middle.head<2>() = map.grid.centre(cuboid.cell);
      middle.z() = 0.5 * (map.grid.metres(cuboid.bottom) + map.grid.metres(cuboid.top));
      seen.push_back({middle, cuboid.points});
    }
    return seen;
  }
  /// Cuboids above the table in front of the hand, where nothing but the mug is.
  static std::size_t mugCuboids(const Monitor& monitor, double from, double to) {
    const auto seen = seenBy(monitor);
    return static_cast<std::size_t>(std::count_if(seen.begin(), seen.end(), [&](const Seen& s) {
      return s.middle.z() > kTableHeight + 0.05 && std::abs(s.middle.y()) < 0.06 &&
             s.middle.x() > from && s.middle.x() < to;
    }));
  }

  double now_ = 100.0;
  double reach_ = 0.8;  ///< at moved_at_
  double speed_ = 0.0;  ///< since then
  double moved_at_ = 100.0;
  bool mug_is_there_ = true;
  PosePath root_;
  Reason reason_ = Reason::kInit, worst_ = Reason::kClear;
  std::string detail_;
  std::size_t self_ = 0;  ///< beams on the robot itself
};

TEST_F(MonitorAttachTest, AMugThatIsNotAttachedIsAnObstacleThatTheHandRunsInto) {
  Monitor monitor(configuration(), robot());
  runFor(monitor, 3.0);
  EXPECT_EQ(reason_, Reason::kClear) << detail_;
  EXPECT_GT(mugCuboids(monitor, 0.59, 0.70), 10U);
  const Reason worst = runFor(monitor, 0.5, -0.4);
  EXPECT_EQ(worst, Reason::kCollision);
  EXPECT_GT(mugCuboids(monitor, 0.59, 0.70), 0U) << "where it was before";
}

TEST_F(MonitorAttachTest, AnAttachedMugMovesWithTheHandAndLeavesNothingBehind) {
  Monitor monitor(configuration(), robot());
  runFor(monitor, 3.0);
  monitor.attach(at(now_), mug(), kForgetPadding);
  EXPECT_EQ(mugCuboids(monitor, 0.0, 1.5), 0U) << "at once, before the next scan";
  EXPECT_EQ(runFor(monitor, 0.5, -0.4), Reason::kClear) << detail_;
  EXPECT_EQ(mugCuboids(monitor, 0.0, 1.5), 0U);
  EXPECT_EQ(runFor(monitor, 1.5), Reason::kClear) << detail_;
  EXPECT_EQ(mugCuboids(monitor, 0.0, 1.5), 0U);
}

TEST_F(MonitorAttachTest, OnlyWhatWasSeenOfTheMugLeavesTheMap) {
  Monitor monitor(configuration(), robot());
  runFor(monitor, 3.0);
  const auto before = seenBy(monitor);
  const std::uint32_t serial = monitor.map()->serial;
  monitor.attach(at(now_), mug(), kForgetPadding);
  const auto after = seenBy(monitor);
  EXPECT_EQ(monitor.map()->serial, serial);
  EXPECT_TRUE(monitor.map()->complete) << "forgetting breaks no window";
  std::size_t gone = 0;
  for (const Seen& seen : before) {
    const double apart = distance(mug().primitive.shape, mugAt(now_).inverse() * seen.middle);
    const bool stays = std::find(after.begin(), after.end(), seen) != after.end();
    // A cuboid's middle is up to half its height from its returns.
    if (apart > kForgetPadding + kPlaceDoubt + 0.03) {
      EXPECT_TRUE(stays) << seen.middle.transpose() << " is " << apart << " away";
    }
    if (!stays) ++gone;
  }
  EXPECT_GT(gone, 10U);
  EXPECT_GT(after.size(), 500U) << "table and post";
  EXPECT_TRUE(std::any_of(after.begin(), after.end(), [](const Seen& seen) {
    return seen.middle.z() > kTableHeight + 0.1 && seen.middle.y() > 0.08;
  })) << "the post";
}

TEST_F(MonitorAttachTest, LaterScansOfItAreFilteredOutAsTheRobot) {
  Monitor monitor(configuration(), robot());
  runFor(monitor, 3.0);
  runFor(monitor, 1.0);
  const std::size_t hand_alone = self_;
  monitor.attach(at(now_), mug(), kForgetPadding);
  runFor(monitor, 1.0);
  EXPECT_GT(self_, hand_alone + 50U);
  EXPECT_EQ(mugCuboids(monitor, 0.0, 1.5), 0U);
}

TEST_F(MonitorAttachTest, ScansThatWereUnderWayDoNotBringItBack) {
  Monitor monitor(configuration(), robot());
  runFor(monitor, 3.5);  // the next scans pass over the mug
  monitor.attach(at(now_ + 0.055), mug(), kForgetPadding);
  EXPECT_TRUE(monitor.detach("mug")) << "so that no self filter takes it out";
  runFor(monitor, 0.055);
  EXPECT_EQ(mugCuboids(monitor, 0.0, 1.5), 0U);
  runFor(monitor, 0.03);
  EXPECT_GT(mugCuboids(monitor, 0.0, 1.5), 0U) << "those after it show what is there";
}

TEST_F(MonitorAttachTest, TheMugIsCheckedAgainstWhatStandsAround) {
  Monitor monitor(configuration(), robot());
  runFor(monitor, 3.0);
  AttachedObject wide = mug();
  wide.primitive.shape = Box{Vector3(0.035, 0.06, 0.06)};
  monitor.attach(at(now_), wide, 0.01);
  runFor(monitor, 0.05);
  EXPECT_EQ(reason_, Reason::kCollision);
  EXPECT_EQ(detail_, "'mug' on hand touches the map");
}

TEST_F(MonitorAttachTest, AMugThatWasLetGoOfIsMappedAgainWithinASweep) {
  Monitor monitor(configuration(), robot());
  runFor(monitor, 3.0);
  monitor.attach(at(now_), mug(), kForgetPadding);
  runFor(monitor, 0.5);
  EXPECT_TRUE(monitor.detach("mug"));
  EXPECT_FALSE(monitor.detach("mug"));
  runFor(monitor, 1.1 * kTiltPeriod);
  EXPECT_GT(mugCuboids(monitor, 0.59, 0.70), 10U);
}

TEST_F(MonitorAttachTest, WithoutASelfFilterTheMugIsForgottenAndSeenAgain) {
  Monitor::Config config = configuration();
  config.sensors.front().scan.self_filter = false;
  Monitor monitor(config, robot());
  runFor(monitor, 3.0);
  monitor.attach(at(now_), mug(), kForgetPadding);
  EXPECT_EQ(mugCuboids(monitor, 0.0, 0.72), 0U);
  runFor(monitor, 1.1 * kTiltPeriod);
  EXPECT_GT(mugCuboids(monitor, 0.59, 0.70), 10U);
}

TEST_F(MonitorAttachTest, WhatIsRefusedChangesNothing) {
  Monitor monitor(configuration(), robot());
  EXPECT_THROW(monitor.attach(at(now_), mug(), kForgetPadding), ConfigError) << "no joints yet";
  EXPECT_TRUE(monitor.checker().attached().empty());
  runFor(monitor, 3.0);
  const auto before = seenBy(monitor);
  AttachedObject elsewhere = mug();
  elsewhere.link = "foot";
  AttachedObject flat = mug();
  flat.primitive.shape = Cylinder{0.0, 0.06};
  EXPECT_THROW(monitor.attach(at(now_), elsewhere, kForgetPadding), ConfigError);
  EXPECT_THROW(monitor.attach(at(now_), flat, kForgetPadding), ConfigError);
  EXPECT_THROW(monitor.attach(at(now_), mug(), -0.01), ConfigError);
  EXPECT_THROW(monitor.attach(at(now_ + 0.5), mug(), kForgetPadding), ConfigError) << "too old";
  EXPECT_TRUE(monitor.checker().attached().empty());
  EXPECT_EQ(monitor.body()->model().shapes().size(), 1U);
  EXPECT_EQ(seenBy(monitor), before);
  EXPECT_EQ(runFor(monitor, 0.2), Reason::kClear) << detail_;
}

}  // namespace
}  // namespace tccm
