#include "check/moving_out.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "simulation/robot/dual_arm.h"
#include "support/checked_robot.h"
#include "support/checker_fixture.h"

namespace tccm {
namespace {

using namespace test::urdf_text;
using test::addBlock;
using test::kScanPeriod;
using test::kStart;

const std::vector<Pose> kAtOrigin{Pose::Identity()};

/// The slider robot: the hand's ball of 50 mm, padded by 40 mm, is at (slide, 0, 0.5), the other's
/// at (glide, 0.5, 0.5). A wall begins at x = 0.8 m: the hand touches it from 0.71 m on, and its
/// middle is in it from 0.8 m on.
class MovingOutTest : public ::testing::Test {
 protected:
  MovingOutTest() {
    config_.check_occlusion = false;
    config_.collision_use.expansion.padding_m = 0.04;
    addWall(0.8, 0.0);
  }

  void addWall(double x, double y) {
    addBlock(map_, {Vector3(x, y - 0.2, 0.3), Vector3(x + 0.1, y + 0.2, 0.7)});
  }
  [[nodiscard]] std::vector<double> at(double slide, double glide) const {
    std::vector<double> positions(2);
    positions[simulation::variableIndex(*model_, "slide")] = slide;
    positions[simulation::variableIndex(*model_, "glide")] = glide;
    return positions;
  }
  /// On a way through such places of the hand and the other, evenly over 0.5 s.
  struct Place {
    double slide, glide = 0.0;
  };
  bool opens(const std::vector<Place>& places, bool must_open = true) {
    JointPath way(2);
    for (std::size_t i = 0; i < places.size(); ++i) {
      const double time_s =
          places.size() > 1 ? 0.5 * static_cast<double>(i) / static_cast<double>(places.size() - 1)
                            : 0.0;
      way.add(time_s, at(places[i].slide, places[i].glide));
    }
    const auto robot = test::checked(model_, config_);
    PoseFindings findings;
    PoseCheck pose(robot, 1.5);
    pose.place(at(places.front().slide, places.front().glide), kAtOrigin);
    pose.check(map_, findings);
    contacts_ = findings.contacts.size();
    MovingOut moving_out(robot);
    return moving_out.opens({map_, way, kAtOrigin}, findings.contacts, must_open);
  }

  std::shared_ptr<const RobotModel> model_ = test::sliderModel();
  CheckedRobot::Config config_;
  CuboidMap map_ = test::emptyMap();
  std::size_t contacts_ = 0;  ///< at the begin of the last way
};

TEST_F(MovingOutTest, AwayFromTheWallOpensAndIntoItCloses) {
  EXPECT_TRUE(opens({{0.75}, {0.65}}));
  EXPECT_GT(contacts_, 0U);
  EXPECT_TRUE(opens({{0.75}, {0.65}}, false));
  EXPECT_FALSE(opens({{0.75}, {0.79}}));
  EXPECT_FALSE(opens({{0.75}, {0.79}}, false));
}

TEST_F(MovingOutTest, OutOfTheFarSideOfAWallIsOutAsWell) {
  EXPECT_TRUE(opens({{0.95}, {1.0}}));
  EXPECT_FALSE(opens({{0.95}, {0.91}}));
}

TEST_F(MovingOutTest, ARobotAtRestDoesNotOpenButDoesNotCloseEither) {
  EXPECT_FALSE(opens({{0.75}, {0.75}}));
  EXPECT_TRUE(opens({{0.75}, {0.75}}, false));
  EXPECT_FALSE(opens({{0.75}})) << "a way of one point";
}

TEST_F(MovingOutTest, LessThanAFewMillimetresOutIsNoMotion) {
  EXPECT_FALSE(opens({{0.75}, {0.748}}));
  EXPECT_TRUE(opens({{0.75}, {0.746}}));
}

TEST_F(MovingOutTest, NoiseOfLessThanTwoMillimetresDoesNotClose) {
  EXPECT_TRUE(opens({{0.75}, {0.7515}}, false));
  EXPECT_FALSE(opens({{0.75}, {0.7530}}, false));
  EXPECT_TRUE(opens({{0.75}, {0.7510}, {0.74}})) << "a little in before it goes out";
  EXPECT_FALSE(opens({{0.75}, {0.7560}, {0.74}})) << "too far in before it goes out";
}

TEST_F(MovingOutTest, OutAndInAgainClosesAndDoesNotOpen) {
  EXPECT_FALSE(opens({{0.75}, {0.73}, {0.75}}));
  EXPECT_FALSE(opens({{0.75}, {0.73}, {0.74}}, false)) << "less than it was on the way";
  EXPECT_TRUE(opens({{0.75}, {0.64}, {0.75}})) << "further away than is looked at";
}

TEST_F(MovingOutTest, WithoutContactsThereIsNothingToOpen) {
  EXPECT_TRUE(opens({{0.5}, {0.6}}));
  EXPECT_EQ(contacts_, 0U);
}

/// The hand slides along a wall that lies 60 mm beside its middle: the cuboids ahead come nearer.
TEST_F(MovingOutTest, AlongAWallDoesNotOpen) {
  map_ = test::emptyMap();
  addBlock(map_, {Vector3(0.0, 0.06, 0.3), Vector3(1.4, 0.16, 0.7)});
  EXPECT_FALSE(opens({{0.7}, {0.9}}));
  EXPECT_FALSE(opens({{0.5}, {1.0}})) << "however fast";
  EXPECT_FALSE(opens({{0.7}, {0.9}}, false));
  EXPECT_GT(contacts_, 0U);
}

TEST_F(MovingOutTest, ACoreInsideACuboidKnowsNoWayOut) {
  EXPECT_FALSE(opens({{0.85}, {0.65}}));
  EXPECT_FALSE(opens({{0.801}, {0.65}}));
  EXPECT_FALSE(opens({{0.85}, {0.85}}, false));
  EXPECT_TRUE(opens({{0.79}, {0.65}}));
}

TEST_F(MovingOutTest, OutOfOneObstacleAndFurtherIntoAnotherCloses) {
  addWall(0.58, 0.0);  // up to 0.68 m: the hand touches it up to 0.77 m
  EXPECT_FALSE(opens({{0.75}, {0.72}})) << "it touches both from the begin";
  EXPECT_FALSE(opens({{0.73}, {0.76}}));
}

/// Else a block behind would hide a post ahead.
TEST_F(MovingOutTest, WhatDoesNotTouchYetIsNoConcernOfIt) {
  addWall(0.52, 0.0);  // up to 0.62 m: the hand touches it up to 0.71 m
  EXPECT_TRUE(opens({{0.75}, {0.66}}));
  addWall(0.4, 0.5);
  EXPECT_TRUE(opens({{0.75, 0.0}, {0.66, 0.35}}));
}

/// The hand leaves one wall along another.
TEST_F(MovingOutTest, EachContactHasToOpen) {
  addBlock(map_, {Vector3(0.4, 0.08, 0.3), Vector3(0.78, 0.16, 0.7)});
  EXPECT_FALSE(opens({{0.75}, {0.65}}));
}

TEST_F(MovingOutTest, OfTwoLinksInContactBothHaveToComeOut) {
  addWall(0.8, 0.5);
  EXPECT_TRUE(opens({{0.75, 0.75}, {0.65, 0.65}}));
  EXPECT_FALSE(opens({{0.75, 0.75}, {0.65, 0.75}}));
  EXPECT_TRUE(opens({{0.75, 0.75}, {0.65, 0.75}}, false));
  EXPECT_FALSE(opens({{0.75, 0.75}, {0.65, 0.79}}, false));
}

/// A column of 20 mm, which the hand's middle is 10 mm before.
TEST_F(MovingOutTest, ThroughAnObstacleIsNoWayOutHoweverFast) {
  map_ = test::emptyMap();
  addBlock(map_, {Vector3(0.8, -0.2, 0.3), Vector3(0.82, 0.2, 0.7)});
  for (const double speed : {0.1, 0.3, 1.0, 2.0, 5.0, 50.0}) {
    EXPECT_FALSE(opens({{0.79}, {0.79 + 0.5 * speed}}, false)) << speed << " m/s";
    EXPECT_FALSE(opens({{0.7985}, {0.7985 + 0.5 * speed}})) << speed << " m/s";
    EXPECT_FALSE(opens({{0.75}, {0.75}, {0.75}, {0.75}, {0.75 + 0.1 * speed}}, false))
        << speed << " m/s after a pause";
  }
  EXPECT_TRUE(opens({{0.79}, {0.29}})) << "the other way";
}

TEST_F(MovingOutTest, AJumpIsNoWayOut) {
  JointPath way(2);
  way.add(0.0, at(0.75, 0.0));
  way.add(0.1, at(0.75, 0.0));
  way.add(0.1, at(0.60, 0.0));
  way.add(0.5, at(0.60, 0.0));
  PoseCheck pose(test::checked(model_, config_), 1.5);
  PoseFindings findings;
  pose.place(at(0.75, 0.0), kAtOrigin);
  pose.check(map_, findings);
  EXPECT_FALSE(MovingOut(test::checked(model_, config_))
                   .opens({map_, way, kAtOrigin}, findings.contacts, true));
}

TEST_F(MovingOutTest, WhereNotAllContactsAreKnownNothingIsSaid) {
  ASSERT_TRUE(opens({{0.75}, {0.65}}));
  config_.collision.contacts_max = static_cast<int>(contacts_) + 1;
  EXPECT_TRUE(opens({{0.75}, {0.65}}));
  config_.collision.contacts_max = static_cast<int>(contacts_);
  EXPECT_FALSE(opens({{0.75}, {0.65}}));
}

/// A long capsule whose end touches: turned away from the wall it opens, the other way it closes.
TEST_F(MovingOutTest, ACapsuleIsJudgedByItsAxis) {
  RobotModel::Config robot;
  robot.capsule_links = {"arm"};
  const auto model = test::modelOf(
      test::robotOf(linkOf("base") +
                    linkOf("arm",
                           "<collision><origin xyz=\"0.2 0 0\" rpy=\"0 1.5707963 0\"/><geometry>"
                           "<cylinder radius=\"0.03\" length=\"0.4\"/></geometry></collision>") +
                    jointOf("turn", "revolute", "base", "arm",
                            "<origin xyz=\"0.3 0 0.5\"/>" + axisOf("0 0 1") + limitOf("-3", "3"))),
      robot);
  map_ = test::emptyMap();
  addBlock(map_, {Vector3(0.0, 0.06, 0.3), Vector3(1.4, 0.16, 0.7)});
  const auto turns = [&](double to) {
    JointPath way(1);
    way.add(0.0, {0.0});
    way.add(0.5, {to});
    PoseCheck pose(test::checked(model, config_), 1.5);
    PoseFindings findings;
    pose.place({0.0}, kAtOrigin);
    pose.check(map_, findings);
    EXPECT_TRUE(findings.collision);
    MovingOut moving_out(test::checked(model, config_));
    return moving_out.opens({map_, way, kAtOrigin}, findings.contacts, false);
  };
  EXPECT_TRUE(turns(-0.1));
  EXPECT_FALSE(turns(0.1));
}

/// What the checker makes of it: the hand touches the post from 0.71 m on.
class MovingOutVerdictTest : public test::CheckerFixture {
 protected:
  MovingOutVerdictTest() {
    config_.pose.check_occlusion = false;
    config_.permission.speed_scale_rise_per_s = 100.0;
    config_.permission.hold_until_reset = true;
    remake();
    run(kStart - 1.0, kStart - kScanPeriod, clear_, 0.75);  // the post comes to the hand
  }
  /// The slide is to go from where it is to a place within 0.4 s.
  std::string commandTo(double now, double from, double to) {
    return checker_->command(test::at(now),
                             {{"slide"}, {{0.0, {from}, {}, {}}, {0.4, {to}, {}, {}}}});
  }
  /// Commanded to go there while it touches at rest, then found elsewhere, or in motion.
  const Verdict& afterCommand(double to, double slide = 0.75, double velocity = 0.0) {
    feedAndCheck(kStart, post_, 0.75);
    EXPECT_EQ(commandTo(kStart, 0.75, to), "");
    return feedAndCheck(kStart + 0.01, post_, slide, velocity);
  }
  static void expectStop(const Verdict& verdict) {
    EXPECT_EQ(verdict.level, Level::kStop);
    EXPECT_EQ(verdict.reason, Reason::kCollision);
    EXPECT_TRUE(verdict.stop);
    EXPECT_EQ(verdict.speed_scale, 0.0);
  }
  void expectMovingOut(const Verdict& verdict) const {
    EXPECT_EQ(verdict.level, Level::kSlow);
    EXPECT_EQ(verdict.reason, Reason::kMovingOut);
    EXPECT_FALSE(verdict.stop);
    EXPECT_EQ(verdict.speed_scale, config_.way.moving_out_scale);
    EXPECT_TRUE(verdict.collision) << "what touches is told all the same";
    EXPECT_TRUE(verdict.now.collision);
    EXPECT_EQ(verdict.link, "hand");
  }
};

TEST_F(MovingOutVerdictTest, AtRestInContactOrGoingInIsACollision) {
  expectStop(feedAndCheck(kStart, post_, 0.75, 0.0));
  expectStop(feedAndCheck(kStart + 0.01, post_, 0.75, 0.2));
}

TEST_F(MovingOutVerdictTest, GoingOutIsPermittedSlowly) {
  expectMovingOut(feedAndCheck(kStart, post_, 0.75, -0.2));
}

TEST_F(MovingOutVerdictTest, AfterAStopItMayGoOutAndThenAwaitsAReset) {
  expectStop(feedAndCheck(kStart, post_, 0.75, 0.2));
  EXPECT_NE(checker_->reset(), "") << "it still touches";
  double slide = 0.75, now = kStart + kScanPeriod;
  for (; slide > 0.715; slide -= 0.2 * kScanPeriod, now += kScanPeriod) {
    const Verdict& verdict = feedAndCheck(now, post_, slide, -0.2);
    EXPECT_EQ(verdict.reason, Reason::kMovingOut) << slide;
    EXPECT_FALSE(verdict.stop);
    EXPECT_EQ(verdict.latched, Reason::kCollision);
  }
  EXPECT_NE(checker_->reset(), "") << "it still touches";
  for (double until = now + 3.0; now < until; now += kScanPeriod) {
    const Verdict& verdict = feedAndCheck(now, post_, 0.6);
    EXPECT_EQ(verdict.reason, Reason::kAwaitingReset);
    EXPECT_TRUE(verdict.stop);
  }
  EXPECT_EQ(checker_->reset(), "");
  const Verdict& released = feedAndCheck(now, post_, 0.6);
  EXPECT_EQ(released.reason, Reason::kClear);
  EXPECT_EQ(released.latched, Reason::kClear);
}

TEST_F(MovingOutVerdictTest, WithoutAStopBeforeGoingOutAwaitsAResetAsWell) {
  expectMovingOut(feedAndCheck(kStart, post_, 0.75, -0.2));
  EXPECT_EQ(run(kStart + kScanPeriod, kStart + 2.0, post_, 0.6).reason, Reason::kAwaitingReset);
  EXPECT_EQ(checker_->reset(), "");
  EXPECT_EQ(feedAndCheck(kStart + 2.1, post_, 0.6).reason, Reason::kClear);
}

TEST_F(MovingOutVerdictTest, GoingBackInOnTheWayOutStopsAgain) {
  expectMovingOut(feedAndCheck(kStart, post_, 0.75, -0.2));
  expectStop(feedAndCheck(kStart + 0.01, post_, 0.748, 0.2));
  expectStop(feedAndCheck(kStart + 0.02, post_, 0.750, 0.0));
}

TEST_F(MovingOutVerdictTest, AtRestACommandThatLeadsOutIsPermitted) {
  const Verdict& verdict = afterCommand(0.55);
  expectMovingOut(verdict);
  EXPECT_TRUE(verdict.follows_trajectory);
}

TEST_F(MovingOutVerdictTest, AtRestACommandThatLeadsInIsACollision) {
  const Verdict& verdict = afterCommand(0.79);
  expectStop(verdict);
  EXPECT_TRUE(verdict.follows_trajectory);
}

TEST_F(MovingOutVerdictTest, ACommandThatLeadsOutDoesNotExcuseARobotThatGoesIn) {
  expectStop(afterCommand(0.55, 0.752, 0.2));
}

TEST_F(MovingOutVerdictTest, ARobotThatGoesOutIsStoppedWhereItsCommandLeadsIn) {
  expectStop(afterCommand(0.79, 0.75, -0.2));
}

TEST_F(MovingOutVerdictTest, AWholeCommandLeadsOutUntilTheRobotIsFree) {
  feedAndCheck(kStart, post_, 0.75);
  ASSERT_EQ(commandTo(kStart, 0.75, 0.55), "");
  for (double t = kScanPeriod; t < 0.4; t += kScanPeriod) {
    const double slide = 0.75 - 0.5 * t;
    const Verdict& verdict = feedAndCheck(kStart + t, post_, slide, -0.5);
    EXPECT_EQ(verdict.reason, slide > 0.7101 ? Reason::kMovingOut : Reason::kAwaitingReset)
        << slide;
  }
}

/// What the hand leaves lies behind it, and a post 40 mm before its padding: at 0.4 m/s it halts
/// within 48 mm.
TEST_F(MovingOutVerdictTest, APostAheadStopsWhateverTouchesBehind) {
  config_.braking.reaction_time_s = 0.02;
  config_.way.stop_time_s = 0.0;
  CuboidMap behind = clear_, ahead = clear_, both = clear_;
  for (CuboidMap* map : {&behind, &both}) {
    addBlock(*map, {Vector3(0.3, -0.1, 0.3), Vector3(0.415, 0.1, 0.7)});
  }
  for (CuboidMap* map : {&ahead, &both}) {
    addBlock(*map, {Vector3(0.619, -0.02, 0.3), Vector3(0.641, 0.02, 0.7)});
  }
  const auto verdictAmong = [this](const CuboidMap& map) {
    remake();
    run(kStart - 1.0, kStart - kScanPeriod, clear_, 0.5);
    return feedAndCheck(kStart, map, 0.5, 0.4);
  };
  const Verdict leaving = verdictAmong(behind);
  EXPECT_EQ(leaving.reason, Reason::kMovingOut);
  const Verdict coming = verdictAmong(ahead);
  EXPECT_EQ(coming.reason, Reason::kCollisionAhead);
  EXPECT_EQ(coming.level, Level::kStop);
  const Verdict worst = verdictAmong(both);
  EXPECT_EQ(worst.level, Level::kStop);
  EXPECT_EQ(worst.speed_scale, 0.0);
  EXPECT_NE(std::find(worst.reasons.begin(), worst.reasons.end(), Reason::kCollisionAhead),
            worst.reasons.end());
}

TEST_F(MovingOutVerdictTest, AFaultIsNotMovedOutOf) {
  feedAndCheck(kStart, post_, 0.75, -0.2);
  const Verdict& verdict = check(kStart + 1.0);
  EXPECT_EQ(verdict.level, Level::kFault);
  EXPECT_TRUE(verdict.stop);
}

}  // namespace
}  // namespace tccm
