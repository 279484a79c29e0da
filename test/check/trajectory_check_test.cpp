#include "check/trajectory_check.h"

#include <algorithm>
#include <limits>

#include "support/checked_robot.h"
#include "support/checker_fixture.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

using test::at;
using test::kStart;

constexpr double kStep = 0.004;  // [m] by default
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// The slider robot's hand touches the post from 0.71 m on, and no more from 0.99 m on.
class TrajectoryCheckTest : public test::CheckerFixture {
 protected:
  struct Place {
    double time_s, slide;
  };
  static JointTrajectory sliding(const std::vector<Place>& places) {
    JointTrajectory trajectory;
    trajectory.names = {"slide"};
    for (const Place& place : places) {
      trajectory.points.push_back({place.time_s, {place.slide}, {}, {}});
    }
    return trajectory;
  }
  TrajectoryAnswer ask(const JointTrajectory& trajectory, double now = kStart) {
    return checker_->checkTrajectory(at(now), trajectory);
  }
  void expectRefused(const JointTrajectory& trajectory, const std::string& word) {
    const auto answer = ask(trajectory);
    EXPECT_EQ(answer.cause.reason, Reason::kBadQuestion) << word;
    EXPECT_NE(answer.cause.detail.find(word), std::string::npos) << answer.cause.detail;
    EXPECT_TRUE(answer.clearances_m.empty());
  }
};

TEST_F(TrajectoryCheckTest, AFreeWayIsFreeAndTellsHowNearItComes) {
  feed(kStart, post_);
  const auto answer = ask(sliding({{0.0, 0.0}, {1.0, 0.6}, {2.0, 0.3}}));
  EXPECT_EQ(answer.cause.reason, Reason::kClear);
  EXPECT_TRUE(answer.cause.detail.empty());
  EXPECT_FALSE(answer.index || answer.contact);
  ASSERT_EQ(answer.clearances_m.size(), 3U);
  EXPECT_EQ(answer.clearances_m[0], kInfinity) << "0.75 m, and no further than 0.2 m is looked";
  EXPECT_NEAR(answer.clearances_m[1], 0.15, 1e-6) << "of the ball as it is, without padding";
  EXPECT_EQ(answer.clearances_m[2], kInfinity);
}

TEST_F(TrajectoryCheckTest, AContactBetweenTwoFreeWaypointsIsFoundWithItsTimeLinkAndCuboid) {
  feed(kStart, post_);
  const auto answer = ask(sliding({{0.0, 0.0}, {1.0, 0.5}, {2.0, 1.0}, {3.0, 0.0}}));
  EXPECT_EQ(answer.cause.reason, Reason::kCollision);
  EXPECT_EQ(answer.cause.link, "hand");
  EXPECT_NE(answer.cause.detail.find("hand touches the map"), std::string::npos);
  EXPECT_EQ(answer.index, 2U);
  EXPECT_NEAR(answer.time_s, 1.0 + 0.21 / 0.5, kStep / 0.5);
  ASSERT_TRUE(answer.contact);
  EXPECT_EQ(model_->linkOf(answer.contact->shape), "hand");
  const UprightBox box = post_.box(post_.cuboids[answer.contact->cuboid]);
  EXPECT_NEAR(box.min().x(), 0.8, 1e-9);
  ASSERT_EQ(answer.clearances_m.size(), 4U) << "beyond the contact as well";
  EXPECT_NEAR(answer.clearances_m[2], 0.05, 1e-6);
}

TEST_F(TrajectoryCheckTest, TheFirstOfSeveralContactsIsGiven) {
  feed(kStart, post_, 1.0);
  const auto back_and_forth = ask(sliding({{1.0, 1.0}, {2.0, 0.5}, {3.0, 1.0}}));
  EXPECT_EQ(back_and_forth.index, 1U);
  EXPECT_NEAR(back_and_forth.time_s, 1.0 + 0.01 / 0.5, kStep / 0.5);
}

TEST_F(TrajectoryCheckTest, AWayOutOfAContactIsFreeAndSaysThatItMovesOut) {
  feed(kStart, post_, 0.75);
  for (const bool begins_now : {true, false}) {
    auto way = sliding({{0.0, 0.75}, {1.0, 0.6}, {2.0, 0.2}});
    if (begins_now) way.points.erase(way.points.begin());
    const auto answer = ask(way);
    EXPECT_EQ(answer.cause.reason, Reason::kMovingOut);
    EXPECT_EQ(answer.cause.level, Level::kSlow);
    EXPECT_EQ(answer.cause.link, "hand");
    EXPECT_FALSE(answer.index || answer.contact);
  }
}

TEST_F(TrajectoryCheckTest, AWayThatGoesOnIntoAContactIsNot) {
  feed(kStart, post_, 0.75);
  EXPECT_EQ(ask(sliding({{0.0, 0.75}, {1.0, 0.78}})).cause.reason, Reason::kCollision);
  EXPECT_EQ(ask(sliding({{0.0, 0.75}, {1.0, 0.75}})).cause.reason, Reason::kCollision);
  const auto through = ask(sliding({{0.0, 0.75}, {1.0, 1.0}}));
  EXPECT_EQ(through.cause.reason, Reason::kCollision);
  EXPECT_EQ(through.time_s, 0.0);
}

TEST_F(TrajectoryCheckTest, AWayOutThatStaysInContactIsNot) {
  feed(kStart, post_, 0.75);
  EXPECT_EQ(ask(sliding({{0.0, 0.75}, {1.0, 0.72}})).cause.reason, Reason::kCollision);
}

TEST_F(TrajectoryCheckTest, AWayOutThatComesBackTouchesThen) {
  feed(kStart, post_, 0.75);
  const auto answer = ask(sliding({{0.0, 0.75}, {1.0, 0.5}, {2.0, 0.75}}));
  EXPECT_EQ(answer.cause.reason, Reason::kCollision);
  EXPECT_EQ(answer.index, 2U);
  EXPECT_NEAR(answer.time_s, 1.0 + 0.21 / 0.25, kStep / 0.25);
}

TEST_F(TrajectoryCheckTest, AWayOutThatComesToAnotherContactTouchesThat) {
  test::addBlock(post_, {Vector3(0.2, -0.02, 0.4), Vector3(0.25, 0.02, 0.6)});
  feed(kStart, post_, 0.75);
  const auto answer = ask(sliding({{0.0, 0.75}, {1.0, 0.2}}));
  EXPECT_EQ(answer.cause.reason, Reason::kCollision);
  EXPECT_NEAR(answer.time_s, (0.75 - 0.34) / 0.55, 0.02);
}

TEST_F(TrajectoryCheckTest, AContactAtTheVeryStartIsFound) {
  feed(kStart, post_, 0.8);
  const auto answer = ask(sliding({{0.0, 0.8}, {1.0, 0.0}}));
  EXPECT_EQ(answer.cause.reason, Reason::kCollision);
  EXPECT_EQ(answer.index, 0U);
  EXPECT_EQ(answer.time_s, 0.0);
}

TEST_F(TrajectoryCheckTest, TheWayToAFirstPointThatIsLaterThanTheStartCounts) {
  feed(kStart, post_, 1.0);
  EXPECT_EQ(ask(sliding({{0.0, 0.2}, {1.0, 0.0}})).cause.reason, Reason::kClear);
  const auto answer = ask(sliding({{2.0, 0.2}, {3.0, 0.0}}));
  EXPECT_EQ(answer.cause.reason, Reason::kCollision);
  EXPECT_EQ(answer.index, 0U);
  EXPECT_NEAR(answer.time_s, 0.01 / 0.4, kStep / 0.4);
}

TEST_F(TrajectoryCheckTest, ASplineThatSwingsIntoThePostTouchesItThoughItsWaypointsAreFree) {
  feed(kStart, post_);
  JointTrajectory trajectory = sliding({{0.0, 0.0}, {1.0, 0.65}});
  EXPECT_EQ(ask(trajectory).cause.reason, Reason::kClear);
  trajectory.points[0].velocities = {4.0};
  trajectory.points[1].velocities = {0.0};
  const auto answer = ask(trajectory);
  EXPECT_EQ(answer.cause.reason, Reason::kCollision);
  // 4 t - 6.05 t^2 + 2.7 t^3 is 0.71 first.
  EXPECT_NEAR(answer.time_s, 0.284, 0.004);
}

TEST_F(TrajectoryCheckTest, JointsThatAreNotNamedAreTakenWhereTheyAre) {
  feed(kStart, post_, 0.8);
  JointTrajectory glide = sliding({{0.0, 0.0}, {1.0, 0.2}});
  glide.names = {"glide"};
  EXPECT_EQ(ask(glide).cause.reason, Reason::kCollision);
}

TEST_F(TrajectoryCheckTest, ALinkThatIsHiddenAtAWaypointIsNamed) {
  feed(kStart, shelf_, -0.5);
  const auto answer = ask(sliding({{0.0, -0.5}, {1.0, -0.4}, {2.0, 0.6}, {3.0, -0.5}}));
  EXPECT_EQ(answer.cause.reason, Reason::kOcclusion);
  EXPECT_EQ(answer.cause.link, "hand");
  EXPECT_EQ(answer.index, 2U);
  EXPECT_EQ(answer.time_s, 2.0);
  config_.pose.check_occlusion = false;
  remake();
  feed(kStart, shelf_, -0.5);
  EXPECT_EQ(ask(sliding({{0.0, -0.5}, {2.0, 0.6}})).cause.reason, Reason::kClear);
}

TEST_F(TrajectoryCheckTest, OfManyWaypointsSomeAreLookedAtForOcclusionTheLastAmongThem) {
  config_.trajectory.occlusion_poses = 2;
  remake();
  feed(kStart, shelf_, -0.5);
  std::vector<Place> places;
  for (int i = 0; i < 9; ++i) places.push_back({1.0 * i, -0.5});
  places.push_back({9.0, 0.6});
  EXPECT_EQ(ask(sliding(places)).index, 9U);
  std::swap(places[9].slide, places[4].slide);
  EXPECT_EQ(ask(sliding(places)).index, 4U);
}

TEST_F(TrajectoryCheckTest, ACollisionIsGivenBeforeAnOcclusion) {
  CuboidMap both = shelf_;
  test::addBlock(both, {Vector3(0.8, -0.2, 0.0), Vector3(0.9, 0.2, 0.7)});
  feed(kStart, both, -0.5);
  const auto answer = ask(sliding({{0.0, -0.5}, {1.0, 0.6}, {2.0, 0.8}}));
  EXPECT_EQ(answer.cause.reason, Reason::kCollision);
  EXPECT_EQ(answer.index, 2U);
}

TEST_F(TrajectoryCheckTest, WhatCannotBeUnderstoodIsABadQuestionAndNeverFree) {
  using namespace test;
  model_ = modelOf(
      robotOf(linkOf("base") + ballLink("hand") + linkOf("tip") +
              jointOf("slide", "prismatic", "base", "hand", axisOf("1 0 0") + limitOf("-1", "1")) +
              jointOf("wag", "prismatic", "hand", "tip", axisOf("1 0 0") + limitOf("-1", "1"))));
  remake();
  setRoot(kStart);
  setMap(kStart, clear_);
  checker_->addJoints(at(kStart), at(kStart), {"slide"}, {0.0}, {0.0});
  const JointTrajectory good = sliding({{0.0, 0.0}, {1.0, 0.1}});
  EXPECT_EQ(ask(good).cause.reason, Reason::kClear);
  const auto refused = [&](const std::string& word, auto&& spoil) {
    JointTrajectory bad = good;
    spoil(bad);
    expectRefused(bad, word);
  };
  refused("names no joint", [](auto& bad) { bad.names.clear(); });
  refused("no points", [](auto& bad) { bad.points.clear(); });
  refused("'sldie'", [](auto& bad) { bad.names = {"sldie"}; });
  refused("'wag' moves no monitored link", [](auto& bad) { bad.names = {"wag"}; });
  refused("named twice", [](auto& bad) { bad.names = {"slide", "slide"}; });
  refused("point 1 has not one position", [](auto& bad) { bad.points[1].positions = {}; });
  refused("position", [](auto& bad) { bad.points[0].positions = {0.0, 0.0}; });
  refused("velocity", [](auto& bad) { bad.points[0].velocities = {0.0, 0.0}; });
  refused("acceleration", [](auto& bad) { bad.points[0].accelerations = {0.0, 0.0}; });
  refused("not after", [](auto& bad) { bad.points[1].time_s = 0.0; });
  refused("not after", [](auto& bad) { std::swap(bad.points[0], bad.points[1]); });
  refused("before the start", [](auto& bad) { bad.points[0].time_s = -0.1; });
  for (const double none : {kNaN, kInfinity, -kInfinity}) {
    refused("finite", [&](auto& bad) { bad.points[1].positions = {none}; });
    refused("finite", [&](auto& bad) { bad.points[1].velocities = {none}; });
    refused("finite", [&](auto& bad) { bad.points[1].time_s = none; });
  }
}

TEST_F(TrajectoryCheckTest, NothingIsFreeWhileAnythingIsMissing) {
  const JointTrajectory trajectory = sliding({{0.0, 0.0}, {1.0, 0.1}});
  for (int given = 0; given < 7; ++given) {
    remake();
    if (given & 1) setMap(kStart, clear_);
    if (given & 2) addJoints(kStart, 0.0);
    if (given & 4) setRoot(kStart);
    EXPECT_EQ(ask(trajectory).cause.reason, Reason::kInit) << given;
    EXPECT_EQ(ask(trajectory, kStart + 2.0).cause.level, Level::kFault) << given;
    EXPECT_TRUE(ask(trajectory).clearances_m.empty());
  }
}

TEST_F(TrajectoryCheckTest, FaultsAreNamed) {
  const JointTrajectory trajectory = sliding({{0.0, 0.0}, {1.0, 0.1}});
  feed(kStart, clear_);
  EXPECT_EQ(ask(trajectory).cause.reason, Reason::kClear);
  EXPECT_EQ(ask(trajectory, kStart + 0.1001).cause.reason, Reason::kNoJoints);
  setMap(kStart, clear_, kStart - 0.6);
  EXPECT_EQ(ask(trajectory).cause.reason, Reason::kMapLate);
  clear_.overflowed = true;
  setMap(kStart, clear_);
  EXPECT_EQ(ask(trajectory).cause.reason, Reason::kMapOverflow);
  clear_.overflowed = clear_.complete = false;
  setMap(kStart, clear_);
  EXPECT_EQ(ask(trajectory).cause.reason, Reason::kInit) << "the map holds no whole sweep";
}

TEST_F(TrajectoryCheckTest, AskingChangesNoVerdict) {
  feedAndCheck(kStart, post_);
  ask(sliding({{0.0, 0.0}, {1.0, 1.0}}));
  EXPECT_EQ(reasonAt(kStart + 0.01), Reason::kClear);
  EXPECT_FALSE(checker_->check(at(kStart + 0.02)).follows_trajectory);
}

TEST(TrajectoryCheckConfigTest, ValuesOutOfRangeAreRefused) {
  const auto refused = [](const TrajectoryCheck::Config& config) {
    EXPECT_THROW(TrajectoryCheck(test::checked(test::sliderModel()), config, 0.2, 1.5),
                 ConfigError);
  };
  TrajectoryCheck::Config config;
  EXPECT_NO_THROW(TrajectoryCheck(test::checked(test::sliderModel()), config, 0.2, 1.5));
  config.step_m = 0.0;
  refused(config);
  Checker::Config checker;
  checker.clearance_radius_m = -0.1;
  EXPECT_THROW(Checker(test::sliderModel(), checker), ConfigError);
  config = {};
  config.occlusion_poses = 0;
  refused(config);
}

}  // namespace
}  // namespace tccm
