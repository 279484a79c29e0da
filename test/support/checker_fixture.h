#pragma once

#include <gtest/gtest.h>

#include <limits>
#include <memory>

#include "check/checker_config.h"
#include "support/cuboid_scene.h"
#include "support/look_around.h"
#include "support/tiny_robot.h"

namespace tccm::test {

inline constexpr double kStart = 100.0;  // [s]
inline constexpr double kScanPeriod = 0.025;

inline Time at(double seconds) { return Time(fromSeconds(seconds)); }

/// A checker of the slider robot, its hand at (slide, 0, 0.5); a map every 25 ms, joints every 10
/// ms.
class CheckerFixture : public ::testing::Test {
 protected:
  /// As in the paper, whatever touches until the horizon stops the robot, and nothing holds until
  /// it is reset. Primitives are padded by 40 mm.
  CheckerFixture() {
    config_.pose.collision_use.expansion.padding_m = 0.04;
    config_.way.stop_time_s = config_.way.horizon_s;
    config_.braking.reaction_time_s = 0.0;
    config_.permission.hold_until_reset = false;
    config_.permission.release_checks = 1;
    clear_.viewpoint = Vector3(0.0, 0.0, 1.5);
    clear_.window = fromSeconds(1.0);
    post_ = shelf_ = clear_;
    addBlock(post_, {Vector3(0.8, -0.2, 0.0), Vector3(0.9, 0.2, 0.7)});
    addBlock(shelf_, {Vector3(0.0, -0.3, 0.78), Vector3(1.2, 0.3, 0.80)});
    for (CuboidMap* map : {&clear_, &post_, &shelf_}) lookAround(*map);
    remake();
  }

  void remake() { checker_ = std::make_unique<Checker>(model_, config_); }
  /// A new one that knows, of map, joints and root, those whose bit is set: 1, 2, 4.
  void remakeWith(int given) {
    remake();
    if (given & 1) setMap(kStart, clear_);
    if (given & 2) addJoints(kStart, 0.0);
    if (given & 4) setRoot(kStart);
  }

  void setMap(double now, const CuboidMap& map, double stamp) {
    auto copy = std::make_shared<CuboidMap>(map);
    copy->stamp = at(stamp);
    copy->serial = ++serial_;
    refreshLooks(*copy);
    checker_->setMap(at(now), copy);
  }
  void setMap(double now, const CuboidMap& map) { setMap(now, map, now); }
  void addJoints(double stamp, double slide, double velocity = 0.0) {
    checker_->addJoints(at(stamp), at(stamp), {"slide", "glide"}, {slide, 0.0}, {velocity, 0.0});
  }
  void setRoot(double stamp, bool is_static = false) {
    checker_->setRootPose(0, at(stamp), Pose::Identity(), is_static);
  }
  /// Everything there is, fresh.
  void feed(double now, const CuboidMap& map, double slide = 0.0, double velocity = 0.0) {
    setRoot(now);
    feedAllButRoot(now, map, slide, velocity);
  }
  void feedAllButRoot(double now, const CuboidMap& map, double slide = 0.0, double velocity = 0.0) {
    addJoints(now, slide, velocity);
    setMap(now, map);
  }
  const Verdict& feedAndCheck(double now, const CuboidMap& map, double slide = 0.0,
                              double velocity = 0.0) {
    feed(now, map, slide, velocity);
    return check(now);
  }
  /// Feeds scans and joints over that time; the last verdict.
  const Verdict& run(double from, double to, const CuboidMap& map, double slide = 0.0) {
    for (double now = from; now < to; now += kScanPeriod) feedAndCheck(now, map, slide);
    return feedAndCheck(to, map, slide);
  }
  /// What holds of every verdict.
  const Verdict& check(double now) {
    const Verdict& verdict = checker_->check(at(now));
    EXPECT_TRUE(verdict.level == levelOf(verdict.reason) || verdict.level == Level::kSlow);
    EXPECT_EQ(verdict.stop, verdict.level >= Level::kStop);
    EXPECT_TRUE(!verdict.stop || verdict.speed_scale == 0.0);
    EXPECT_EQ(verdict.detail.empty(), verdict.reason == Reason::kClear);
    if (verdict.reason == Reason::kInit || verdict.level == Level::kFault) {
      EXPECT_FALSE(verdict.known) << name(verdict.reason);
    }
    if (!verdict.stop) {
      EXPECT_TRUE(verdict.known);
      EXPECT_TRUE(verdict.level == Level::kSlow || !(verdict.collision || verdict.occlusion));
    }
    return verdict;
  }
  Reason reasonAt(double now) { return check(now).reason; }

  std::shared_ptr<const RobotModel> model_ = sliderModel();
  Checker::Config config_;
  std::unique_ptr<Checker> checker_;
  CuboidMap clear_ = emptyMap();
  CuboidMap post_ = emptyMap();   ///< the hand touches it from 0.71 m on
  CuboidMap shelf_ = emptyMap();  ///< hides the hand from the sensor
  std::uint32_t serial_ = 0;
};

}  // namespace tccm::test
