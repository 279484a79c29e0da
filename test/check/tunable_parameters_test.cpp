#include <gtest/gtest.h>

#include <map>
#include <set>
#include <sstream>
#include <string>
#include <variant>

#include "monitor_config.h"
#include "support/checker_fixture.h"

namespace tccm {
namespace {

using test::at;
using test::kStart;

using Parts = std::set<std::string>;

/// A tunable parameter, another value than the test's, and all parts of the checker that take it.
struct Case {
  double value;
  Parts taken_by;
};

const Parts kAllThatTouches{"here", "way", "moving out", "state", "trajectory", "commanded"};

const std::map<std::string, Case> kCases{
    {"primitive_scale", {1.5, kAllThatTouches}},
    {"collision_padding_m", {0.07, kAllThatTouches}},
    {"support_points", {20, kAllThatTouches}},
    {"check_occlusion", {0, {"hidden"}}},
    {"occlusion_hidden_fraction", {0.9, {"hidden"}}},
    {"occlusion_stops", {0, {"hidden"}}},
    {"horizon_s", {0.31, {"way"}}},
    {"stop_time_s", {0.1, {"way"}}},
    {"reaction_time_s", {0.2, {"way", "moving out", "governed"}}},
    {"deceleration_mps2", {0.5, {"way", "moving out", "governed"}}},
    {"approach_distance_m", {0.3, {"approached"}}},
    {"release_s", {2.0, {"release"}}},
    {"release_checks", {60, {"release"}}},
    {"speed_scale_rise_per_s", {0.1, {"release"}}},
};

/// Of the nodelet, not of the checker: test/ros/tuning.test.
const std::set<std::string> kOfTheNodelet{"check_time_max_periods"};

class TunableParametersTest : public test::CheckerFixture {
 protected:
  TunableParametersTest() {
    config_ = Checker::Config();
    config_.pose.collision_use.expansion.padding_m = 0.04;
    config_.permission.hold_until_reset = false;
    config_.governed_speed.appear_distance_m = 0.15;
    // So thin that its few returns matter.
    post_ = clear_;
    test::addBlock(post_, {Vector3(0.8, -0.2, 0.0), Vector3(0.9, 0.2, 0.7)}, 1);
    test::lookAround(post_);
    // Hides half of the hand.
    test::addBlock(blind_, {Vector3(0.0, 0.0, 0.78), Vector3(1.2, 0.3, 0.80)});
    test::lookAround(blind_);
    appeared_ = post_;
    for (Cuboid& cuboid : appeared_.cuboids) cuboid.appeared = true;
    appeared_.appeared = static_cast<std::uint32_t>(appeared_.cuboids.size());
    clear_.look_period = fromSeconds(0.1);
  }

  static void set(Checker::Config& config, const std::string& key, double value) {
    const ParameterTable table = tableOf(config);
    for (const ParameterTable::Row& row : table.rows()) {
      if (row.key != key) continue;
      if (const auto* member = std::get_if<bool*>(&row.member)) **member = value != 0.0;
      if (const auto* member = std::get_if<int*>(&row.member)) **member = static_cast<int>(value);
      if (const auto* member = std::get_if<double*>(&row.member)) **member = value;
    }
  }

  /// Begins anew, and writes what the checker says while the hand moves over the map.
  std::string watch(const CuboidMap& map, double slide, double velocity, int checks = 40) {
    checker_->startAnew();
    std::ostringstream said;
    said.precision(17);
    for (int i = 0; i < checks; ++i, now_ += test::kScanPeriod) {
      const Verdict& verdict = feedAndCheck(now_, map, slide, velocity);
      slide += velocity * test::kScanPeriod;
      said << name(verdict.reason) << ' ' << verdict.speed_scale << ' ' << verdict.governed_scale
           << ' ' << verdict.detail << ' ' << verdict.now.contacts.size() << ' '
           << verdict.ahead.contacts.size() << '\n';
    }
    return said.str();
  }

  /// What each part of the checker says, by part.
  std::map<std::string, std::string> transcript() {
    std::map<std::string, std::string> said;
    now_ = kStart;
    // It touches from 0.71 m on: before that larger primitives tell, behind it fewer contacts.
    said["here"] = watch(post_, 0.69, 0.0, 10) + watch(post_, 0.72, 0.0, 10);
    said["way"] = watch(post_, 0.0, 0.6);
    said["moving out"] = watch(post_, 0.74, -0.2);
    said["governed"] = watch(clear_, 0.0, 0.5);
    said["approached"] = watch(appeared_, 0.55, 0.0, 10);
    said["hidden"] = watch(blind_, 0.4, 0.0);
    said["release"] = watch(post_, 0.75, 0.0, 5) + watchOn(clear_, 0.4, 120);
    watch(post_, 0.0, 0.0);
    JointTrajectory there;
    there.names = {"slide"};
    there.points.resize(2);
    there.points[0].positions = {0.0};
    there.points[1].time_s = 0.35;
    for (const double slide : {0.72, 0.69}) {
      const auto state = checker_->checkState(at(now_), {"slide"}, {slide});
      said["state"] += name(state.cause.reason) + state.cause.detail;
      there.points[1].positions = {slide};
      const auto answer = checker_->checkTrajectory(at(now_), there);
      said["trajectory"] += name(answer.cause.reason) + answer.cause.detail;
    }
    EXPECT_EQ(checker_->command(at(now_), there), "");
    said["commanded"] = watchOn(post_, 0.0, 20);
    return said;
  }

  std::string watchOn(const CuboidMap& map, double slide, int checks) {
    std::ostringstream said;
    said.precision(17);
    for (int i = 0; i < checks; ++i, now_ += test::kScanPeriod) {
      const Verdict& verdict = feedAndCheck(now_, map, slide);
      said << name(verdict.reason) << ' ' << verdict.speed_scale << ' ' << verdict.detail << '\n';
    }
    return said.str();
  }

  CuboidMap blind_ = clear_, appeared_ = clear_;
  double now_ = kStart;
};

TEST_F(TunableParametersTest, WhatIsTunedAtRunTimeReachesEveryPartThatTakesIt) {
  const Checker::Config before = config_;
  remake();
  const auto untuned = transcript();
  for (const auto& [key, change] : kCases) {
    SCOPED_TRACE(key);
    set(config_ = before, key, change.value);
    remake();
    const auto from_the_start = transcript();
    const Checker::Config after = config_;
    config_ = before;
    remake();
    run(kStart - 5.0, kStart - 1.0, post_);
    checker_->reconfigure(after);
    const auto tuned = transcript();
    for (const auto& [part, said] : untuned) {
      EXPECT_EQ(tuned.at(part), from_the_start.at(part)) << part;
      EXPECT_TRUE(tuned.at(part) != said || change.taken_by.count(part) == 0) << part;
    }
  }
}

TEST_F(TunableParametersTest, EveryTunableParameterHasACase) {
  CheckerConfig config;
  std::set<std::string> tunable, cases = kOfTheNodelet;
  const ParameterTable table = tableOf(config);
  for (const ParameterTable::Row& row : table.rows()) {
    if (row.tunable == Tunable::kYes) tunable.insert(row.key);
  }
  for (const auto& entry : kCases) cases.insert(entry.first);
  EXPECT_EQ(tunable, cases);
}

}  // namespace
}  // namespace tccm
