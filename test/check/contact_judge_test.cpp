/// Levels by time to contact, through the Checker that acts on them.

#include "check/contact_judge.h"

#include <cmath>

#include "support/checker_fixture.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

using test::at;
using test::kStart;

/// The hand is a ball; padded it touches the post from a slide of 0.71 m on.
class ContactJudgeTest : public test::CheckerFixture {
 protected:
  ContactJudgeTest() {
    config_.way = {};
    config_.braking = {};
    config_.permission.speed_scale_rise_per_s = 1000.0;
    config_.inputs.joint_timeout_s = 1.0;
    remake();
  }
  static constexpr double kTouches = 0.71;
  double latency_s_ = 0.0;

  /// The verdict on a hand that would touch after that time.
  const Verdict& touchingIn(double time_s, double speed = 0.4) {
    remake();
    checker_->setLatency(latency_s_);
    const double slide = kTouches + 1e-4 - time_s * speed;
    feedAndCheck(kStart - 1.0, clear_, slide);
    return feedAndCheck(kStart, post_, slide, speed);
  }
};

TEST_F(ContactJudgeTest, ANearContactStopsAndAFarOneSlowsDown) {
  // 0.3 s, 0.02 s of reaction, and 0.1 s for braking from 0.4 m/s at 2 m/s^2.
  const Verdict& near = touchingIn(0.40);
  EXPECT_EQ(near.reason, Reason::kCollisionAhead);
  EXPECT_EQ(near.level, Level::kStop);
  EXPECT_TRUE(near.stop && near.collision);
  EXPECT_EQ(near.speed_scale, 0.0);
  const Verdict& far = touchingIn(0.46);
  EXPECT_EQ(far.reason, Reason::kCollisionAhead);
  EXPECT_EQ(far.level, Level::kSlow);
  EXPECT_FALSE(far.stop);
  EXPECT_TRUE(far.collision);
  EXPECT_GT(far.speed_scale, 0.1);
  EXPECT_LT(far.speed_scale, 0.8);
}

TEST_F(ContactJudgeTest, WhereHaltingTakesLongerItStopsAndSlowsDownSooner) {
  // 5/8 of 0.5 s for halting in place of 0.1 s, however slow it is: 0.3125 s.
  config_.braking.stop_duration_s = 0.5;
  for (const double speed : {0.4, 0.05}) {
    EXPECT_EQ(touchingIn(0.56, speed).level, Level::kStop) << speed;
    const Verdict& far = touchingIn(0.70, speed);
    EXPECT_EQ(far.level, Level::kSlow) << speed;
    EXPECT_LT(far.speed_scale, 0.6);
    EXPECT_EQ(touchingIn(0.87, speed).level, Level::kOk) << speed;
  }
}

TEST_F(ContactJudgeTest, TheNearerTheContactTheSlower) {
  double last = 0.0;
  for (const double time_s : {0.44, 0.46, 0.48, 0.495}) {
    const double scale = touchingIn(time_s).speed_scale;
    EXPECT_GT(scale, last) << time_s;
    last = scale;
  }
}

TEST_F(ContactJudgeTest, TheFirstContactIsToldWithTimeDistanceLinkAndCuboid) {
  const Verdict& verdict = touchingIn(0.25);
  ASSERT_TRUE(verdict.first_contact);
  const WayContact& first = *verdict.first_contact;
  EXPECT_NEAR(first.time_s, 0.25, 0.03);
  EXPECT_NEAR(first.distance_m, 0.1, 1e-3);
  EXPECT_NEAR(first.link_speed_mps, 0.4, 1e-6);
  EXPECT_EQ(model_->linkOf(first.contact.shape), "hand");
  const UprightBox box = post_.box(post_.cuboids[first.contact.cuboid]);
  EXPECT_NEAR(box.min().x(), 0.8, 0.021);
  EXPECT_FALSE(verdict.now.collision);
}

TEST_F(ContactJudgeTest, AFasterLinkStopsEarlier) {
  EXPECT_EQ(touchingIn(0.46, 0.4).level, Level::kSlow);
  EXPECT_EQ(touchingIn(0.46, 0.8).level, Level::kStop) << "braking takes 0.2 s";
}

TEST_F(ContactJudgeTest, LatencyStopsEarlier) {
  latency_s_ = 0.1;
  EXPECT_EQ(touchingIn(0.46).level, Level::kStop);
}

/// Beside the post, in passing.
TEST_F(ContactJudgeTest, WhatOnlyTheMarginForItsSpeedTouchesSlowsDown) {
  CuboidMap wall = clear_;
  // The hand moves along x at y = 0; the padded ball's side is at y = 0.09.
  test::addBlock(wall, {Vector3(-0.5, 0.101, 0.3), Vector3(1.2, 0.2, 0.7)});
  const Verdict& slow = feedAndCheck(kStart, wall, 0.0, 0.05);
  EXPECT_EQ(slow.reason, Reason::kClear) << slow.detail;
  checker_->setLatency(0.05);
  const Verdict& fast = feedAndCheck(kStart + 0.01, wall, 0.0, 0.6);
  EXPECT_EQ(fast.reason, Reason::kCollisionAhead);
  EXPECT_EQ(fast.level, Level::kSlow);
  EXPECT_FALSE(fast.collision) << "it does not touch";
  ASSERT_TRUE(fast.first_contact);
  EXPECT_TRUE(fast.first_contact->by_margin);
}

/// At 0.05 m/s after 0.40 s, at 1 m/s after 0.45 s: the slow hand can be waited for.
TEST_F(ContactJudgeTest, OfTwoLinksTheGraverContactCountsNotTheEarlier) {
  CuboidMap other_wall = clear_, both = post_;
  for (CuboidMap* map : {&other_wall, &both}) {
    test::addBlock(*map, {Vector3(0.8, 0.3, 0.0), Vector3(0.9, 0.7, 0.7)});
  }
  const auto judged = [this](const CuboidMap& map) {
    remake();
    setRoot(kStart);
    checker_->addJoints(at(kStart), at(kStart), {"slide", "glide"},
                        {kTouches + 1e-4 - 0.40 * 0.05, kTouches + 1e-4 - 0.45}, {0.05, 1.0});
    setMap(kStart, map);
    return check(kStart);
  };
  EXPECT_EQ(judged(post_).level, Level::kSlow);
  EXPECT_EQ(judged(other_wall).level, Level::kStop);
  const Verdict verdict = judged(both);
  EXPECT_EQ(verdict.level, Level::kStop);
  EXPECT_EQ(verdict.reason, Reason::kCollisionAhead);
  EXPECT_EQ(verdict.link, "other");
}

/// The wall begins 10 mm beside the padded hand, which has a margin of 15 mm.
TEST_F(ContactJudgeTest, APostAheadDoesNotHideAWallWithinTheMargin) {
  CuboidMap wall = clear_, both = post_;
  for (CuboidMap* map : {&wall, &both}) {
    test::addBlock(*map, {Vector3(-0.5, 0.101, 0.3), Vector3(0.79, 0.19, 0.7)});
  }
  const auto judged = [this](const CuboidMap& map) {
    remake();
    checker_->setLatency(0.03);
    feedAndCheck(kStart - 1.0, clear_, 0.56);
    return feedAndCheck(kStart, map, kTouches + 1e-4 - 0.49 * 0.3, 0.3);
  };
  EXPECT_NEAR(judged(wall).speed_scale, 0.1, 1e-9);
  const Verdict post = judged(post_);
  EXPECT_EQ(post.level, Level::kSlow);
  EXPECT_GT(post.speed_scale, 0.7);
  const Verdict verdict = judged(both);
  EXPECT_NEAR(verdict.speed_scale, 0.1, 1e-9);
  EXPECT_TRUE(verdict.collision) << "the post is told all the same";
  ASSERT_TRUE(verdict.first_contact);
  EXPECT_FALSE(verdict.first_contact->by_margin);
}

/// Where steps are longer than the margin both are found at the same place, and of the margin it is
/// said to touch only after the delay.
TEST_F(ContactJudgeTest, WhatComesTooNearDoesNotAskForLessThanTheContact) {
  config_.way.step_m = 0.2;
  config_.way.horizon_s = 1.0;
  latency_s_ = 0.01;
  const Halting halting{config_.way.horizon_s, config_.way.stop_time_s, config_.way.slow_scale_min,
                        latency_s_ + config_.braking.reaction_time_s, config_.braking.way()};
  int contacts = 0;
  for (double time_s = 0.6; time_s < 0.95; time_s += 0.01) {
    const Verdict& verdict = touchingIn(time_s);
    if (verdict.level != Level::kSlow) continue;
    ASSERT_TRUE(verdict.first_contact);
    if (verdict.first_contact->by_margin) continue;
    ++contacts;
    EXPECT_LE(verdict.speed_scale, halting.scale(verdict.first_contact->time_s, 0.4) + 1e-9)
        << time_s;
  }
  EXPECT_GT(contacts, 10);
}

/// Of the other, which may slide far.
TEST_F(ContactJudgeTest, AFastLinkIsLookedAlongAsFarAsHaltingTakes) {
  config_.evidence.unseen_fraction_max = 1.0;
  CuboidMap wall = clear_;
  test::addBlock(wall, {Vector3(0.8, 0.3, 0.0), Vector3(0.9, 0.7, 0.7)});
  const auto comingFrom = [&](double metres, double speed) {
    remake();
    setRoot(kStart);
    checker_->addJoints(at(kStart), at(kStart), {"slide", "glide"}, {0.0, kTouches - metres},
                        {0.0, speed});
    setMap(kStart, wall);
    return check(kStart);
  };
  EXPECT_EQ(comingFrom(1.375, 2.5).level, Level::kStop) << "it halts within 1.61 m";
  EXPECT_EQ(comingFrom(1.60, 2.5).reason, Reason::kCollisionAhead);
  EXPECT_EQ(comingFrom(1.63, 2.5).level, Level::kSlow) << "within the margin of 50 mm";
  EXPECT_EQ(comingFrom(1.67, 2.5).reason, Reason::kClear);
  EXPECT_EQ(comingFrom(0.55, 1.0).reason, Reason::kClear) << "within the horizon that is 0.5 m";
}

TEST_F(ContactJudgeTest, BeyondWhatCanBeLookedAlongTheScaleIsWhatHaltsWithinIt) {
  config_.evidence.unseen_fraction_max = 1.0;
  config_.braking.deceleration_mps2 = 0.5;
  remake();
  feedAndCheck(kStart - 1.0, clear_);
  setRoot(kStart);
  checker_->addJoints(at(kStart), at(kStart), {"slide", "glide"}, {0.0, -4.0}, {0.0, 4.0});
  setMap(kStart, clear_);
  const Verdict& verdict = check(kStart);
  EXPECT_EQ(verdict.reason, Reason::kSpeedGoverned);
  // Within the 8 m of 2 s: v t + v^2 / 2a at 2.82 m/s.
  const double allowed = 4.0 * verdict.speed_scale;
  EXPECT_NEAR(0.02 * allowed + allowed * allowed / (2.0 * 0.5), 8.0, 1e-6);
}

TEST_F(ContactJudgeTest, TheAgeOfTheJointStatesCountsAsLatency) {
  EXPECT_EQ(touchingIn(0.46).level, Level::kSlow);
  setMap(kStart + 0.07, post_);
  EXPECT_EQ(check(kStart + 0.07).level, Level::kStop);
}

TEST_F(ContactJudgeTest, ACommandedTrajectoryCountsAlthoughTheRobotStandsStill) {
  feed(kStart, post_, 0.5);
  EXPECT_EQ(check(kStart).reason, Reason::kClear);
  EXPECT_EQ(checker_->command(at(kStart), {{"slide"}, {{1.0, {1.0}, {}, {}}}}), "");
  const Verdict& verdict = check(kStart);
  EXPECT_EQ(verdict.reason, Reason::kCollisionAhead);
  EXPECT_TRUE(verdict.follows_trajectory);
  EXPECT_NEAR(verdict.first_contact->time_s, 0.42, 0.05);
  EXPECT_EQ(checker_->command(at(kStart), {}), "");
  EXPECT_FALSE(check(kStart).follows_trajectory);
  EXPECT_FALSE(check(kStart).collision);
}

TEST_F(ContactJudgeTest, OfVelocityAndTrajectoryTheWorseCounts) {
  feed(kStart, post_, 0.5, 0.6);
  EXPECT_EQ(checker_->command(at(kStart), {{"slide"}, {{1.0, {0.0}, {}, {}}}}), "");
  const Verdict& verdict = check(kStart);
  EXPECT_EQ(verdict.reason, Reason::kCollisionAhead) << "commanded back, measured to go on";
  EXPECT_NEAR(verdict.first_contact->time_s, 0.35, 0.05);
}

TEST_F(ContactJudgeTest, OfVelocityAndTrajectoryThatBothStopTheEarlierContactIsTold) {
  feed(kStart, post_, 0.55, 0.45);
  EXPECT_NEAR(check(kStart).first_contact->time_s, 0.16 / 0.45, 0.05);
  EXPECT_EQ(checker_->command(at(kStart), {{"slide"}, {{0.4, {1.0}, {}, {}}}}), "");
  const Verdict& verdict = check(kStart);
  EXPECT_EQ(verdict.level, Level::kStop);
  EXPECT_LT(verdict.first_contact->time_s, 0.25);
}

TEST_F(ContactJudgeTest, ATrajectoryThatIsNotUnderstoodStopsTheRobotUntilTheNext) {
  feed(kStart, clear_);
  checker_->command(at(kStart), {{"sldie"}, {{1.0, {1.0}, {}, {}}}});
  const Verdict& verdict = check(kStart);
  EXPECT_EQ(verdict.reason, Reason::kBadTrajectory);
  EXPECT_TRUE(verdict.stop);
  EXPECT_NE(verdict.detail.find("'sldie'"), std::string::npos);
  checker_->command(at(kStart), {});
  EXPECT_EQ(check(kStart + 0.001).reason, Reason::kReleasing);
}

TEST_F(ContactJudgeTest, WhereTheCheckFailedNothingOfTheOneBeforeStandsIn) {
  EXPECT_TRUE(touchingIn(0.25).first_contact);
  const Verdict& failed = checker_->fail(at(kStart + 0.01), {Reason::kInternal, "out of memory"});
  EXPECT_EQ(failed.reason, Reason::kInternal);
  EXPECT_EQ(failed.level, Level::kFault);
  EXPECT_FALSE(failed.known || failed.placed);
  EXPECT_FALSE(failed.first_contact);
  EXPECT_TRUE(failed.now.links.empty() && failed.ahead.contacts.empty());
  EXPECT_TRUE(failed.clearances.empty());
  EXPECT_EQ(failed.speed_scale, 0.0);
  EXPECT_NE(checker_->reset(), "") << "it lasts until a check succeeds";
}

TEST_F(ContactJudgeTest, AHiddenLinkOnlySlowsDownWhereThatIsConfigured) {
  config_.pose.occlusion.stops = false;
  remake();
  feedAndCheck(kStart - 1.0, clear_, 0.6);
  const Verdict& verdict = feedAndCheck(kStart, shelf_, 0.6);
  EXPECT_EQ(verdict.reason, Reason::kOcclusion);
  EXPECT_EQ(verdict.level, Level::kSlow);
  EXPECT_TRUE(verdict.occlusion);
  EXPECT_NEAR(verdict.speed_scale, config_.pose.occlusion.slow_scale, 1e-9);
}

TEST_F(ContactJudgeTest, ValuesOutOfRangeAreRefused) {
  const auto refused = [](auto member, double value) {
    Checker::Config config;
    if constexpr (std::is_same_v<decltype(member), double Braking::*>) {
      config.braking.*member = value;
    } else {
      config.way.*member = value;
    }
    EXPECT_THROW(static_cast<void>(validated(config)), ConfigError) << value;
  };
  refused(&ContactJudge::Config::horizon_s, -0.1);
  refused(&ContactJudge::Config::step_m, 0.0);
  refused(&Braking::reaction_time_s, -0.1);
  refused(&Braking::margin_max_m, -0.1);
  refused(&ContactJudge::Config::stop_time_s, std::nan(""));
  refused(&Braking::deceleration_mps2, 0.0);
  refused(&ContactJudge::Config::slow_scale_min, 1.1);
  refused(&ContactJudge::Config::moving_out_scale, -0.1);
}

}  // namespace
}  // namespace tccm
