#include "check/commanded_trajectories.h"

#include <gtest/gtest.h>

#include "support/tiny_robot.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

Time at(double seconds) { return Time(fromSeconds(seconds)); }

/// The slider robot: `slide` moves the hand, `glide` a second one, both along x within +-1 m.
class CommandedTrajectoriesTest : public ::testing::Test {
 protected:
  CommandedTrajectoriesTest() {
    for (std::size_t v = 0; v < model_->variables().size(); ++v) {
      if (model_->variables()[v].name == "slide") slide_ = v;
      if (model_->variables()[v].name == "glide") glide_ = v;
    }
    joints_.positions.assign(model_->variables().size(), 0.0);
    joints_.velocities.assign(model_->variables().size(), 0.0);
  }

  /// Points at whole seconds.
  static JointTrajectory along(const std::string& joint, const std::vector<double>& positions) {
    JointTrajectory trajectory{{joint}, {}};
    for (std::size_t i = 0; i < positions.size(); ++i) {
      trajectory.points.push_back({static_cast<double>(i + 1), {positions[i]}, {}, {}});
    }
    return trajectory;
  }
  std::string command(const JointTrajectory& trajectory, double now = 100.0) {
    return commanded_.command(at(now), trajectory, joints_.positions);
  }
  void followAt(double now, double slide) {
    joints_.positions[slide_] = slide;
    commanded_.follow(at(now), joints_.positions);
  }
  /// Where the slide will be.
  double slideAfter(double time_s, double horizon_s = 0.5) {
    std::vector<double> positions;
    commanded_.makeWay(joints_, horizon_s, way_);
    way_.positionsAt(time_s, positions);
    return positions[slide_];
  }

  std::shared_ptr<const RobotModel> model_ = test::sliderModel();
  std::size_t slide_ = 0, glide_ = 0;
  JointSnapshot joints_;
  CommandedTrajectories commanded_{model_, {}};
  JointPath way_{model_->variables().size()};
};

TEST_F(CommandedTrajectoriesTest, TheWayGoesAlongTheTrajectoryFromWhereTheRobotIs) {
  EXPECT_EQ(command(along("slide", {0.4, 0.0})), "");
  ASSERT_TRUE(commanded_.active());
  EXPECT_NEAR(slideAfter(0.5), 0.2, 1e-6);
  for (double now = 100.0; now <= 100.901; now += 0.1) followAt(now, 0.4 * (now - 100.0));
  EXPECT_NEAR(slideAfter(0.1), 0.4, 2e-3);
  EXPECT_NEAR(slideAfter(0.5), 0.24, 5e-3) << "round the corner and back";
}

TEST_F(CommandedTrajectoriesTest, WhereTheRobotIsCountsAndNotTheClock) {
  command(along("slide", {0.4, 0.8}));
  for (double now = 100.0; now < 110.0; now += 0.01) followAt(now, 0.1);
  EXPECT_TRUE(commanded_.active()) << "it waits";
  EXPECT_NEAR(slideAfter(0.5), 0.3, 5e-3);
}

TEST_F(CommandedTrajectoriesTest, DuringAPauseTimeGoesOn) {
  command(along("slide", {0.2, 0.2, 0.2, 0.6}));
  double now = 100.0;
  for (; now < 101.0; now += 0.01) followAt(now, 0.2 * (now - 100.0));
  for (; now < 102.9; now += 0.01) followAt(now, 0.2);
  EXPECT_NEAR(slideAfter(0.5), 0.2 + 0.4 * 0.4, 0.01);
}

TEST_F(CommandedTrajectoriesTest, AtItsEndItIsForgotten) {
  command(along("slide", {0.4}));
  for (double now = 100.0; now < 100.9; now += 0.01) followAt(now, 0.4 * (now - 100.0));
  EXPECT_TRUE(commanded_.active());
  for (double now = 100.9; now < 101.2; now += 0.01) {
    followAt(now, std::min(0.4, 0.4 * (now - 100.0)));
  }
  EXPECT_FALSE(commanded_.active());
  EXPECT_EQ(commanded_.defect(), "");
}

TEST_F(CommandedTrajectoriesTest, WhereARobotThatGoesElsewhereGoesIsNotKnownUntilTheNextCommand) {
  command(along("slide", {0.4}));
  for (double now = 100.0; now < 101.0; now += 0.01) followAt(now, -(now - 100.0));
  EXPECT_FALSE(commanded_.active());
  EXPECT_NE(commanded_.defect().find("does not follow"), std::string::npos);
  EXPECT_EQ(command({{"slide"}, {}}), "");
  EXPECT_EQ(commanded_.defect(), "");
}

TEST_F(CommandedTrajectoriesTest, OneThatBeginsElsewhereAtOnceIsNotUnderstood) {
  const JointTrajectory jump{{"slide"}, {{0.0, {0.8}, {}, {}}, {1.0, {0.9}, {}, {}}}};
  EXPECT_NE(command(jump).find("starts elsewhere"), std::string::npos);
  EXPECT_FALSE(commanded_.active());
}

TEST_F(CommandedTrajectoriesTest, ASinglePointAtOnceIsLookedAtUntilTheRobotIsThere) {
  const JointTrajectory step{{"slide"}, {{0.0, {0.25}, {}, {}}}};
  EXPECT_EQ(command(step), "");
  followAt(100.01, 0.0);
  ASSERT_TRUE(commanded_.active());
  EXPECT_NEAR(slideAfter(0.5), 0.25, 1e-9);
  followAt(100.3, 0.24);
  EXPECT_FALSE(commanded_.active());
}

TEST_F(CommandedTrajectoriesTest, WhatOneControllerIsToldSaysNothingOfTheOthersJoints) {
  JointTrajectory bad = along("slide", {0.1, 0.2});
  bad.points[1].time_s = 0.5;
  EXPECT_EQ(command(along("glide", {0.4})), "");
  EXPECT_NE(command(bad), "");
  EXPECT_TRUE(commanded_.active()) << "the other one's is still followed";
  EXPECT_EQ(command({{"glide"}, {}}), "");
  EXPECT_NE(commanded_.defect(), "") << "what the slide does is still not known";
  EXPECT_EQ(command({{"slide"}, {}}), "");
  EXPECT_EQ(commanded_.defect(), "");
}

TEST_F(CommandedTrajectoriesTest, JointsThatAreNotNamedGoOnAtTheirVelocities) {
  joints_.velocities[glide_] = 1.0;
  command(along("slide", {0.4}));
  commanded_.makeWay(joints_, 0.5, way_);
  std::vector<double> positions;
  way_.positionsAt(0.5, positions);
  EXPECT_NEAR(positions[glide_], 0.5, 1e-9);
  EXPECT_NEAR(positions[slide_], 0.2, 1e-6);
}

TEST_F(CommandedTrajectoriesTest,
       TwoControllersAreFollowedAtOnceAndANewTrajectoryReplacesItsJoints) {
  command(along("slide", {0.4}));
  command(along("glide", {-0.4}));
  std::vector<double> positions;
  commanded_.makeWay(joints_, 0.5, way_);
  way_.positionsAt(0.5, positions);
  EXPECT_NEAR(positions[slide_], 0.2, 1e-6);
  EXPECT_NEAR(positions[glide_], -0.2, 1e-6);
  command(along("slide", {-0.4}));
  commanded_.makeWay(joints_, 0.5, way_);
  way_.positionsAt(0.5, positions);
  EXPECT_NEAR(positions[slide_], -0.2, 1e-6);
  EXPECT_NEAR(positions[glide_], -0.2, 1e-6);
}

TEST_F(CommandedTrajectoriesTest, OneWithoutPointsCancelsItsJointsOrAll) {
  command(along("slide", {0.4}));
  command(along("glide", {0.4}));
  EXPECT_EQ(command({{"slide"}, {}}), "");
  EXPECT_TRUE(commanded_.active());
  EXPECT_NEAR(slideAfter(0.5), 0.0, 1e-9);
  EXPECT_EQ(command({}), "");
  EXPECT_FALSE(commanded_.active());
}

TEST_F(CommandedTrajectoriesTest, WhatIsNotUnderstoodIsSaidUntilTheNextOneAndNothingIsFollowed) {
  command(along("slide", {0.4}));
  JointTrajectory slip = along("slide", {0.4});
  slip.names = {"slide", "sldie"};
  slip.points[0].positions = {0.4, 0.4};
  EXPECT_NE(command(slip), "");
  EXPECT_FALSE(commanded_.active());
  EXPECT_NE(commanded_.defect().find("'sldie'"), std::string::npos);
  JointTrajectory unordered = along("slide", {0.1, 0.2});
  unordered.points[1].time_s = 0.5;
  EXPECT_NE(command(unordered), "");
  EXPECT_NE(commanded_.defect(), "");
  EXPECT_EQ(command(along("slide", {0.4})), "");
  EXPECT_EQ(commanded_.defect(), "");
  EXPECT_NE(commanded_.command(at(101.0), along("slide", {0.4}), {}), "")
      << "where the robot is is not known";
  EXPECT_EQ(commanded_.command(at(101.0), {}, {}), "") << "cancelling is always understood";
  EXPECT_EQ(commanded_.defect(), "");
}

TEST_F(CommandedTrajectoriesTest, MeasuredVelocitiesLeadToTheLimitsAndNoFurther) {
  joints_.positions[slide_] = 0.8;
  joints_.velocities[slide_] = 1.0;
  joints_.velocities[glide_] = -0.5;
  commanded_.makeMeasuredWay(joints_, 0.5, way_);
  std::vector<double> positions;
  way_.positionsAt(0.1, positions);
  EXPECT_NEAR(positions[slide_], 0.9, 1e-9);
  way_.positionsAt(0.3, positions);
  EXPECT_NEAR(positions[slide_], 1.0, 1e-9);
  EXPECT_NEAR(positions[glide_], -0.15, 1e-9) << "the other one goes on";
  joints_.positions[slide_] = 1.2;
  commanded_.makeMeasuredWay(joints_, 0.5, way_);
  way_.positionsAt(0.5, positions);
  EXPECT_NEAR(positions[slide_], 1.2, 1e-9) << "beyond its limit it stays";
}

TEST_F(CommandedTrajectoriesTest, ValuesOutOfRangeAreRefused) {
  CommandedTrajectories::Config config;
  config.deviation_max = 0.0;
  EXPECT_THROW(CommandedTrajectories(model_, config), ConfigError);
}

}  // namespace
}  // namespace tccm
