#include "check/governed_speed.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "support/cuboid_scene.h"
#include "support/made_situation.h"
#include "support/tiny_robot.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

constexpr double kDistance = 0.15;     // [m]
constexpr double kDeceleration = 2.0;  // [m/s^2]
constexpr double kStep = 0.01;         // [s]
constexpr double kRise = 0.5;          // [1/s] of the scale, as a permission's
constexpr double kPeriod = 1.0;        // [s]

Time at(double seconds) { return Time(fromSeconds(seconds)); }

/// The slider robot's hand goes along x, as fast as it is commanded times the scale, under a sensor
/// that looks everywhere at once, and so often.
class GovernedHand : public ::testing::Test {
 protected:
  GovernedHand() { config_.appear_distance_m = kDistance; }

  void SetUp() override {
    governor_ = std::make_unique<GovernedSpeed>(model_, config_, std::vector<std::size_t>{0});
    map_.viewpoint = Vector3(0.0, 0.0, 1.5);
    map_.look_period = fromSeconds(kPeriod);
    map_.looks.begin(at(0.0), map_.viewpoint);
  }
  /// Every direction, at once.
  void look(double range = 9.0, Seen end = Seen::kNothing) {
    const auto ticks = static_cast<LookImage::Ticks>(std::lround(1e3 * now_));
    for (int row = 0; row < map_.looks.grid().rows(); ++row) {
      for (int column = 0; column < map_.looks.grid().columns(); ++column) {
        LookImage::Passes& passes = map_.looks.edit(row, column);
        passes[1] = passes[0];
        passes[0] = {ticks, ticks, static_cast<std::uint16_t>(1e3 * range), end};
      }
    }
    looks_.push_back(now_);
    map_.stamp = at(now_);
    ++map_.serial;
  }
  const GovernedSpeed::Limit& limitOf(GovernedSpeed& governor, const JointSnapshot& joints) {
    Causes causes;
    governor.judge(situation_.at(at(now_), map_, joints, scale_), causes);
    EXPECT_EQ(causes.empty(), governor.limit().scale >= 1.0);
    return governor.limit();
  }
  /// One step; the hand does at once what it is told.
  const GovernedSpeed::Limit& step(double commanded_mps) {
    const double speed = scale_ * commanded_mps;
    JointSnapshot joints{at(now_), at(now_), {x_, 0.0}, {speed, 0.0}};
    const auto& limit = limitOf(*governor_, joints);
    scale_ = limit.scale < scale_ ? limit.scale : std::min(limit.scale, scale_ + kRise * kStep);
    x_ += scale_ * commanded_mps * kStep;
    now_ += kStep;
    way_.push_back({now_, x_, scale_ * commanded_mps});
    return limit;
  }
  /// Looks at these times after each whole period.
  void run(double until, double commanded_mps, const std::vector<double>& phases) {
    while (now_ < until - 1e-9) {
      const double phase = now_ - kPeriod * std::floor(now_ / kPeriod + 1e-9);
      for (const double p : phases) {
        if (std::abs(phase - p) < 0.5 * kStep) look();
      }
      step(commanded_mps);
    }
  }
  /// The longest way from any instant to the first look after it and the reaction, with the braking
  /// way from there.
  [[nodiscard]] double longestWay(double from) const {
    double longest = 0.0;
    for (const Step& begin : way_) {
      const auto look = std::find_if(looks_.begin(), looks_.end(),
                                     [&](double stamp) { return stamp > begin.stamp; });
      if (begin.stamp < from || look == looks_.end()) continue;
      const double verdict = *look + situation_.braking.reaction_time_s;
      const auto end = std::find_if(way_.begin(), way_.end(),
                                    [verdict](const Step& s) { return s.stamp >= verdict - 1e-9; });
      if (end == way_.end()) continue;
      const double x = end->x - end->speed * (end->stamp - verdict);
      longest = std::max(longest, x - begin.x + end->speed * end->speed / (2.0 * kDeceleration));
    }
    return longest;
  }
  [[nodiscard]] double meanSpeed(double from) const {
    const auto begin =
        std::find_if(way_.begin(), way_.end(), [from](const Step& s) { return s.stamp >= from; });
    return (way_.back().x - begin->x) / (way_.back().stamp - begin->stamp);
  }

  /// How far it goes on from rest, commanded fast, while every direction is looked at twice a
  /// second and the looks end so.
  double wayWhileLooking(int steps, double range, Seen end) {
    run(2.0, 0.0, {0.0, 0.5});
    const double from = x_;
    for (int i = 0; i < steps; ++i) {
      if (i % 50 == 0) look(range, end);
      step(0.4);
    }
    return x_ - from;
  }

  struct Step {
    double stamp, x, speed;
  };
  const std::shared_ptr<const RobotModel> model_ = test::sliderModel();
  GovernedSpeed::Config config_;
  test::MadeSituation situation_{model_};
  std::unique_ptr<GovernedSpeed> governor_;
  CuboidMap map_ = test::emptyMap();
  double now_ = 0.0, x_ = -0.5, scale_ = 1.0;
  std::vector<double> looks_;
  std::vector<Step> way_;
};

TEST_F(GovernedHand, TheWayBetweenLooksStaysUnderTheDistanceHoweverTheLooksAreSpaced) {
  for (const auto& phases : {std::vector<double>{0.0, 0.5}, {0.0, 0.3}, {0.0, 0.1}}) {
    now_ = 0.0, x_ = -0.5, scale_ = 1.0;
    looks_.clear();
    way_.clear();
    SetUp();
    run(2.0, 0.0, phases);  // at rest, until the looks are known
    run(9.0, 0.4, phases);
    EXPECT_LT(longestWay(2.0), kDistance);
    EXPECT_GT(longestWay(2.0), 0.8 * kDistance);
    // Twice the distance in a period is the bound.
    EXPECT_GT(meanSpeed(4.0), 0.7 * kDistance / kPeriod);
    EXPECT_LT(meanSpeed(4.0), 2.0 * kDistance / kPeriod);
  }
}

TEST_F(GovernedHand, ASlowHandIsNotSlowedDown) {
  run(2.0, 0.0, {0.0, 0.5});
  run(4.0, 0.15, {0.0, 0.5});  // it is taken for a fast one at first
  for (int i = 0; i < 200; ++i) {
    const double phase = now_ - std::floor(now_ + 1e-9);
    if (std::abs(phase) < 0.5 * kStep || std::abs(phase - 0.5) < 0.5 * kStep) look();
    step(0.15);
  }
  EXPECT_NEAR(meanSpeed(4.5), 0.15, 0.01);
}

TEST_F(GovernedHand, WhereNoLookIsDueTheScaleGoesToNothing) {
  run(2.0, 0.0, {0.0, 0.5});
  const double from = x_;
  for (int i = 0; i < 3000; ++i) step(0.4);
  EXPECT_LT(scale_, 0.01);
  EXPECT_LT(x_ - from, kDistance);
  EXPECT_FALSE(step(0.4).next_look_s);
}

TEST_F(GovernedHand, LooksThatEndOnTheRobotAreNone) {
  EXPECT_LT(wayWhileLooking(3000, 0.3, Seen::kRobot), kDistance);
  EXPECT_LT(scale_, 0.01);
}

TEST_F(GovernedHand, OfASurfaceThatIsMetBeforeThePlaceTheLooksCount) {
  EXPECT_GT(wayWhileLooking(300, 0.92, Seen::kSurface), 2.0 * kDistance);
}

TEST_F(GovernedHand, WhatItMovesAwayFromDoesNotLimitIt) {
  run(2.0, 0.0, {0.0, 0.5});
  for (int i = 0; i < 1000; ++i) step(0.4);
  ASSERT_LT(scale_, 0.02);
  JointSnapshot back{at(now_), at(now_), {x_, 0.0}, {-0.05, 0.0}};
  look();  // places behind are seen; that ahead of the way out too
  const auto& limit = limitOf(*governor_, back);
  EXPECT_GT(limit.allowed_mps == 0.0 ? 1.0 : limit.allowed_mps, 0.05);
}

TEST_F(GovernedHand, AnotherThatTakesOverLimitsAsMuch) {
  run(2.0, 0.0, {0.0, 0.5});
  for (int i = 0; i < 40; ++i) step(0.4);
  const auto allowed = [this](GovernedSpeed& governor) {
    return limitOf(governor, {at(now_), at(now_), {x_, 0.0}, {scale_ * 0.4, 0.0}}).allowed_mps;
  };
  GovernedSpeed fresh(model_, config_, {0}), tuned(model_, config_, {0, 1});
  tuned.takeOver(*governor_);
  const double allowed_mps = allowed(*governor_);
  EXPECT_NE(allowed_mps, allowed(fresh));
  EXPECT_EQ(allowed(tuned), allowed_mps);
}

TEST_F(GovernedHand, AfterTimeJumpedBackItIsAsAtTheStart) {
  config_.speed_max_mps = 0.05;  // what is commanded is told by speed and scale from then on
  SetUp();
  run(2.0, 0.4, {0.0, 0.5});
  governor_->startAnew();
  GovernedSpeed fresh(model_, config_, {0});
  now_ = 0.2;
  x_ = 0.0;
  scale_ = 0.5;
  map_.serial = 0;
  map_.looks.begin(at(0.0), map_.viewpoint);
  look();
  bool limited = false;
  for (; now_ < 0.8; now_ += kStep, x_ += 0.2 * kStep) {
    const JointSnapshot joints{at(now_), at(now_), {x_, 0.0}, {0.2, 0.0}};
    const GovernedSpeed::Limit expected = limitOf(fresh, joints);
    const GovernedSpeed::Limit& limit = limitOf(*governor_, joints);
    EXPECT_EQ(limit.allowed_mps, expected.allowed_mps) << now_;
    EXPECT_EQ(limit.scale, expected.scale) << now_;
    limited = limited || fresh.limit().scale < 1.0;
  }
  EXPECT_TRUE(limited);
}

TEST_F(GovernedHand, AtRestNothingIsLimited) { EXPECT_EQ(step(0.0).scale, 1.0); }

TEST_F(GovernedHand, WithoutADistanceItIsNotActive) {
  GovernedSpeed::Config off;
  GovernedSpeed governor(model_, off, {0});
  EXPECT_FALSE(governor.active());
  EXPECT_TRUE(governor_->active());
}

TEST_F(GovernedHand, WhatIsOutOfRangeIsRefusedByItsName) {
  const auto refused = [this](auto member, double value, const std::string& name) {
    GovernedSpeed::Config config;
    config.*member = value;
    try {
      GovernedSpeed governor(model_, config, {0});
      ADD_FAILURE() << name;
    } catch (const ConfigError& error) {
      EXPECT_NE(std::string(error.what()).find(name), std::string::npos) << error.what();
    }
  };
  refused(&GovernedSpeed::Config::appear_distance_m, -0.1, "appear_distance_m");
  refused(&GovernedSpeed::Config::look_margin_m, -0.1, "appear_look_margin_m");
  refused(&GovernedSpeed::Config::speed_max_mps, 0.0, "commanded_speed_max_mps");
  refused(&GovernedSpeed::Config::place_step_m, 0.0, "appear_place_step_m");
}

}  // namespace
}  // namespace tccm
