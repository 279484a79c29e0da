#include "gate/goal_rules.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "support/random.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

using Fault = JudgedGoal::Fault;
using Values = std::vector<double>;

const Time kNow{fromSeconds(100.0)};
const Values kHere = {0.1, 0.2, 0.3};

GoalRules::Config threeJoints() {
  GoalRules::Config config;
  config.joints = {"a", "b", "c"};
  return config;
}

JointTrajectory::Point point(double time_s, const Values& positions,
                             const Values& velocities = {}) {
  JointTrajectory::Point point;
  point.time_s = time_s;
  point.positions = positions;
  point.velocities = velocities;
  return point;
}

TrajectoryGoal goalOf(const std::vector<std::string>& names,
                      const std::vector<JointTrajectory::Point>& points) {
  TrajectoryGoal goal;
  goal.trajectory.names = names;
  goal.trajectory.points = points;
  return goal;
}

JudgedGoal judge(const TrajectoryGoal& goal, const GoalRules::Config& config = threeJoints()) {
  return GoalRules(config).judge(goal, kNow, kHere, {});
}

TEST(GoalRulesTest, AWayBeginsWhereTheJointsAre) {
  const JudgedGoal judged = judge(goalOf({"a", "b", "c"}, {point(2.0, {1.0, 2.0, 3.0})}));
  ASSERT_EQ(judged.fault, Fault::kNone) << judged.text;
  EXPECT_EQ(judged.way.names, threeJoints().joints);
  ASSERT_EQ(judged.way.points.size(), 2U);
  EXPECT_EQ(judged.way.points[0].time_s, 0.0);
  EXPECT_EQ(judged.way.points[0].positions, kHere);
  EXPECT_TRUE(judged.way.points[0].velocities.empty());
  EXPECT_EQ(judged.way.points[1].time_s, 2.0);
  EXPECT_EQ(judged.way.points[1].positions, (Values{1.0, 2.0, 3.0}));
  EXPECT_EQ(judged.start, kNow);
}

TEST(GoalRulesTest, NamesMayComeInAnyOrder) {
  const auto goal = goalOf({"c", "a", "b"}, {point(2.0, {3.0, 1.0, 2.0}, {30.0, 10.0, 20.0})});
  const JudgedGoal judged = judge(goal);
  ASSERT_EQ(judged.fault, Fault::kNone) << judged.text;
  EXPECT_EQ(judged.way.points[1].positions, (Values{1.0, 2.0, 3.0}));
  EXPECT_EQ(judged.way.points[1].velocities, (Values{10.0, 20.0, 30.0}));
  EXPECT_EQ(judged.way.points[0].velocities, (Values{0.0, 0.0, 0.0}));
}

TEST(GoalRulesTest, JointsThatAreNotTheControllersAreRefused) {
  for (const auto& names : std::vector<std::vector<std::string>>{
           {"a", "b", "x"}, {"a", "b", "b"}, {"a", "b"}, {"a", "b", "c", "d"}, {}}) {
    const JudgedGoal judged = judge(goalOf(names, {point(1.0, Values(names.size(), 1.0))}));
    EXPECT_EQ(judged.fault, Fault::kInvalidJoints);
    EXPECT_FALSE(judged.text.empty());
    EXPECT_TRUE(judged.way.points.empty());
  }
}

TEST(GoalRulesTest, WherePartsAreAllowedTheOtherJointsStay) {
  GoalRules::Config config = threeJoints();
  config.allow_partial_joints_goal = true;
  const JudgedGoal judged = judge(goalOf({"b"}, {point(1.0, {2.0}, {0.5})}), config);
  ASSERT_EQ(judged.fault, Fault::kNone) << judged.text;
  EXPECT_EQ(judged.way.points[1].positions, (Values{0.1, 2.0, 0.3}));
  EXPECT_EQ(judged.way.points[1].velocities, (Values{0.0, 0.5, 0.0}));
}

TEST(GoalRulesTest, WhatCannotBeFollowedIsRefused) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Values to = {1.0, 2.0, 3.0};
  auto unlike = point(1.0, to), jerky = point(1.0, to, to);
  unlike.accelerations = {1.0};
  jerky.accelerations = {1.0, nan, 3.0};
  for (const auto& points : std::vector<std::vector<JointTrajectory::Point>>{
           {point(1.0, {1.0, 2.0})},
           {point(1.0, {})},
           {point(1.0, to, {1.0})},
           {unlike},
           {point(1.0, {1.0, nan, 3.0})},
           {point(1.0, to, {1.0, nan, 3.0})},
           {jerky},
           {point(nan, to)},
           {point(std::numeric_limits<double>::infinity(), to)},
           {point(-1.0, to), point(1.0, to)},
           {point(1.0, to), point(2e9, to)},  // more than messages hold at a lower speed
           {point(1.0, to), point(1.0, to)},
           {point(2.0, to), point(1.0, to)},
           {point(0.0, to)}}) {
    const JudgedGoal judged = judge(goalOf({"a", "b", "c"}, points));
    EXPECT_EQ(judged.fault, Fault::kInvalidGoal);
    EXPECT_FALSE(judged.text.empty());
  }
}

TEST(GoalRulesTest, WithoutPointsTheArmIsToBeHeld) {
  const JudgedGoal judged = judge(goalOf({"a", "b", "c"}, {}));
  EXPECT_EQ(judged.fault, Fault::kNone);
  EXPECT_TRUE(judged.way.points.empty());
}

TEST(GoalRulesTest, APointAtItsStartIsLeftOut) {
  const auto goal =
      goalOf({"a", "b", "c"}, {point(0.0, {0.11, 0.2, 0.3}), point(2.0, {1.0, 2.0, 3.0})});
  const JudgedGoal judged = judge(goal);
  ASSERT_EQ(judged.way.points.size(), 2U);
  EXPECT_EQ(judged.way.points[0].positions, kHere);
  EXPECT_EQ(judged.way.points[1].time_s, 2.0);
}

TEST(GoalRulesTest, AStampInThePastLeavesOutWhatIsOver) {
  auto goal = goalOf({"a", "b", "c"}, {point(1.0, {1.0, 1.0, 1.0}), point(2.0, {2.0, 2.0, 2.0}),
                                       point(3.0, {3.0, 3.0, 3.0})});
  goal.start = kNow - fromSeconds(1.5);
  const JudgedGoal judged = judge(goal);
  ASSERT_EQ(judged.fault, Fault::kNone) << judged.text;
  ASSERT_EQ(judged.way.points.size(), 3U);
  EXPECT_DOUBLE_EQ(judged.way.points[1].time_s, 0.5);
  EXPECT_EQ(judged.way.points[1].positions, (Values{2.0, 2.0, 2.0}));
  EXPECT_EQ(judged.start, kNow);
  goal.start = kNow - fromSeconds(3.0);
  EXPECT_EQ(judge(goal).fault, Fault::kInvalidGoal);
}

TEST(GoalRulesTest, AStampInTheFutureIsWaitedFor) {
  auto goal = goalOf({"a", "b", "c"}, {point(1.0, {1.0, 1.0, 1.0})});
  goal.start = kNow + fromSeconds(0.7);
  const JudgedGoal judged = judge(goal);
  EXPECT_EQ(judged.start, *goal.start);
  EXPECT_EQ(judged.way.points[1].time_s, 1.0);
}

TEST(GoalRulesTest, JointsThatTurnFreelyTakeTheShortWayByWholeTurns) {
  GoalRules::Config config = threeJoints();
  config.turn_freely = {true, false, true};
  for (unsigned seed = 0; seed < 100; ++seed) {
    test::Random random(seed);
    const auto anywhere = [&] {
      return Values{random.uniform(-20.0, 20.0), 1.0, random.uniform(-20.0, 20.0)};
    };
    const Values here = anywhere();
    const auto goal = goalOf({"a", "b", "c"}, {point(1.0, anywhere()), point(2.0, anywhere())});
    const JudgedGoal judged = GoalRules(config).judge(goal, kNow, here, {});
    ASSERT_EQ(judged.fault, Fault::kNone);
    for (const std::size_t j : {std::size_t{0}, std::size_t{2}}) {
      EXPECT_LE(std::abs(judged.way.points[1].positions[j] - here[j]), M_PI + 1e-9);
      const double turn =
          (judged.way.points[1].positions[j] - goal.trajectory.points[0].positions[j]) /
          (2.0 * M_PI);
      EXPECT_NEAR(turn, std::round(turn), 1e-9);
      EXPECT_NEAR(judged.way.points[2].positions[j] - judged.way.points[1].positions[j],
                  goal.trajectory.points[1].positions[j] - goal.trajectory.points[0].positions[j],
                  1e-9)
          << "on the way it turns as it is told";
    }
    EXPECT_EQ(judged.way.points[1].positions[1], 1.0);
  }
}

TEST(GoalRulesTest, ATolerancesNumberIsAskedForTheControllersOwnOrNone) {
  GoalRules::Config config = threeJoints();
  config.tolerances.path = {{0.1, 0.2, 0.3}, {0.1, 0.2, 0.3}, {0.1, 0.2, 0.3}};
  config.tolerances.end_time_s = 0.5;
  auto goal = goalOf({"a", "b", "c"}, {point(1.0, {1.0, 1.0, 1.0})});
  goal.path = {{"b", {0.7, -1.0, 0.0}}, {"nobody", {9.0, 9.0, 9.0}}};
  goal.end = {{"c", {0.01, 0.0, 0.0}}};
  const GoalTolerances own = judge(goal, config).tolerances;
  EXPECT_EQ(own.path[0].position, 0.1);
  EXPECT_EQ(own.path[1].position, 0.7);
  EXPECT_EQ(own.path[1].velocity, 0.0);
  EXPECT_EQ(own.path[1].acceleration, 0.3);
  EXPECT_EQ(own.end[2].position, 0.01);
  EXPECT_EQ(own.end[0].position, 0.0);
  EXPECT_EQ(own.end_time_s, 0.5);
  goal.end_time_s = -1.0;
  EXPECT_EQ(judge(goal, config).tolerances.end_time_s, 0.0);
  goal.end_time_s = 2.0;
  EXPECT_EQ(judge(goal, config).tolerances.end_time_s, 2.0);
}

TEST(GoalRulesTest, AControllerHasJointsEachOnce) {
  for (const auto& joints : std::vector<std::vector<std::string>>{{}, {"a", "a"}, {"a", ""}}) {
    GoalRules::Config config;
    config.joints = joints;
    EXPECT_THROW(GoalRules{config}, ConfigError);
  }
}

}  // namespace
}  // namespace tccm
