/// How goals of a trajectory controller end.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "simulation/trajectory_controller.h"
#include "support/driven_controller.h"
#include "support/random.h"
#include "tccm_monitor/config_error.h"

namespace tccm::simulation {
namespace {

using namespace driven;

TEST(TrajectoryControllerGoalsTest, AGoalIsReachedOnceItsTimeIsOver) {
  Driven arm;
  ASSERT_EQ(arm.controller.accept(goalOf({point(1.0, {1.1, 1.2, 1.3}, Values(3, 0.0))})).fault,
            Fault::kNone);
  EXPECT_TRUE(arm.controller.hasGoal());
  EXPECT_TRUE(arm.controller.follows());
  EXPECT_FALSE(arm.run(0.998));
  const auto end = arm.run(0.003);
  ASSERT_TRUE(end);
  EXPECT_EQ(end->kind, Kind::kReached);
  EXPECT_EQ(end->text, "");
  EXPECT_FALSE(arm.controller.hasGoal());
  EXPECT_FALSE(arm.run(1.0)) << "it ends once";
  EXPECT_FALSE(arm.controller.follows());
}

TEST(TrajectoryControllerGoalsTest, BeyondAToleranceOnTheWayAGoalEndsAndItsTrajectoryGoesOn) {
  TrajectoryController::Config config = threeJoints();
  config.rules.tolerances.path.assign(3, {});
  config.rules.tolerances.path[1].position = 0.1;
  Driven arm(config);
  ASSERT_EQ(arm.controller.accept(goalOf({point(1.0, {1.1, 1.2, 1.3})})).fault, Fault::kNone);
  arm.aside = {0.5, 0.09, 0.5};
  EXPECT_FALSE(arm.run(0.5)) << "the others have none";
  arm.aside[1] = -0.11;
  const auto end = arm.run(0.001);
  ASSERT_TRUE(end);
  EXPECT_EQ(end->kind, Kind::kOffPath);
  EXPECT_EQ(end->text.find("b: off its path"), 0U) << end->text;
  EXPECT_TRUE(arm.controller.follows());
  EXPECT_FALSE(arm.run(0.6));
  EXPECT_NEAR(arm.position(1), 1.2, 1e-12);
}

TEST(TrajectoryControllerGoalsTest, AGoalMayAskForOtherTolerancesJointByJoint) {
  TrajectoryController::Config config = threeJoints();
  config.rules.tolerances.path.assign(3, {0.1, 0.0, 0.0});
  auto goal = goalOf({point(1.0, {1.1, 1.2, 1.3}, Values(3, 0.0))});
  goal.path = {{"a", {0.3, 0.0, 0.0}}, {"b", {-1.0, 0.5, 0.0}}};
  const auto kindWith = [&](const Values& aside, double fast_b) {
    Driven arm(config);
    EXPECT_EQ(arm.controller.accept(goal).fault, Fault::kNone);
    arm.run(0.1);
    arm.aside = aside;
    arm.fast[1] = fast_b;
    const auto end = arm.run(0.1);
    return end ? std::optional(end->kind) : std::nullopt;
  };
  EXPECT_EQ(kindWith({0.29, 9.0, 0.09}, 0.49), std::nullopt);
  EXPECT_EQ(kindWith({0.31, 0.0, 0.0}, 0.0), Kind::kOffPath);
  EXPECT_EQ(kindWith({0.0, 0.0, 0.11}, 0.0), Kind::kOffPath);
  EXPECT_EQ(kindWith({0.0, 0.0, 0.0}, 0.51), Kind::kOffPath);
}

TEST(TrajectoryControllerGoalsTest, AtItsEndAGoalWaitsAsLongAsItsToleranceOfTimeSays) {
  TrajectoryController::Config config = threeJoints();
  config.rules.tolerances.end.assign(3, {0.05, 0.01, 0.0});
  config.rules.tolerances.end_time_s = 0.5;
  const auto goal = goalOf({point(1.0, {1.1, 1.2, 1.3}, Values(3, 0.0))});
  Driven late(config);
  ASSERT_EQ(late.controller.accept(goal).fault, Fault::kNone);
  late.aside[2] = 0.06;
  EXPECT_FALSE(late.run(1.4));
  late.aside[2] = 0.04;
  ASSERT_TRUE(late.run(0.001));
  Driven never(config);
  ASSERT_EQ(never.controller.accept(goal).fault, Fault::kNone);
  never.aside[2] = 0.06;
  EXPECT_FALSE(never.run(1.499));
  const auto end = never.run(0.002);
  ASSERT_TRUE(end);
  EXPECT_EQ(end->kind, Kind::kOffGoal);
  EXPECT_EQ(end->text.find("c: off its goal"), 0U) << end->text;
}

TEST(TrajectoryControllerGoalsTest, JointsThatStillMoveAtTheEndAreOffTheGoal) {
  const auto goal = goalOf({point(1.0, {0.1, 0.2, 0.3}, Values(3, 0.0))});
  for (const auto& [fast, kind] :
       std::vector<std::pair<double, Kind>>{{0.009, Kind::kReached}, {0.011, Kind::kOffGoal}}) {
    Driven arm;
    ASSERT_EQ(arm.controller.accept(goal).fault, Fault::kNone);
    arm.fast[0] = fast;
    const auto end = arm.run(1.01);
    ASSERT_TRUE(end);
    EXPECT_EQ(end->kind, kind);
  }
}

TEST(TrajectoryControllerGoalsTest, RandomGoalsEndWhenAndAsTheirTolerancesSay) {
  std::map<Kind, int> ends;
  for (unsigned seed = 0; seed < 300; ++seed) {
    SCOPED_TRACE(seed);
    test::Random random(seed);
    const auto tolerance = [&random](double often) {
      return JointTolerance{random.chance(often) ? random.uniform(0.03, 0.1) : 0.0,
                            random.chance(often) ? random.uniform(0.03, 0.1) : 0.0, 0.0};
    };
    TrajectoryController::Config config = threeJoints();
    GoalTolerances& tolerances = config.rules.tolerances;
    tolerances.path = {tolerance(0.1), tolerance(0.1), tolerance(0.1)};
    tolerances.end = {tolerance(0.5), tolerance(0.5), tolerance(0.5)};
    const double duration_s = 0.3005;
    auto goal = goalOf({point(duration_s, {0.2, 0.3, 0.1}, Values(3, 0.0))});
    goal.end_time_s = random.uniform(0.001, 0.1);
    const double disturbance = random.uniform(0.0, 0.2);
    Driven arm(config);
    ASSERT_EQ(arm.controller.accept(goal).fault, Fault::kNone);
    std::optional<TrajectoryController::GoalEnd> end;
    std::optional<Kind> expected;
    for (int step = 0; !end && !expected; ++step) {
      if (step % 50 == 0) {
        for (std::size_t j = 0; j < 3; ++j) {
          arm.aside[j] = random.uniform(-disturbance, disturbance);
          arm.fast[j] = random.uniform(-disturbance, disturbance);
        }
      }
      end = arm.run(0.001);
      const bool on_the_way = arm.elapsed() < duration_s;
      bool within = true;
      for (std::size_t j = 0; j < 3; ++j) {
        const JointTolerance& allowed = (on_the_way ? tolerances.path : tolerances.end)[j];
        const double off = arm.position(j) - arm.controller.positions()[j];
        const double off_speed = arm.velocity(j) - arm.controller.velocities()[j];
        if (allowed.position > 0.0 && std::abs(off) > allowed.position) within = false;
        if (allowed.velocity > 0.0 && std::abs(off_speed) > allowed.velocity) within = false;
      }
      if (on_the_way && !within) expected = Kind::kOffPath;
      if (!on_the_way && within) expected = Kind::kReached;
      const bool too_late = arm.elapsed() >= duration_s + goal.end_time_s;
      if (!on_the_way && !within && too_late) expected = Kind::kOffGoal;
    }
    ASSERT_TRUE(end && expected);
    EXPECT_EQ(end->kind, *expected);
    ++ends[end->kind];
  }
  for (const Kind kind : {Kind::kReached, Kind::kOffPath, Kind::kOffGoal}) {
    EXPECT_GT(ends[kind], 20);
  }
}

TEST(TrajectoryControllerGoalsTest, ASecondGoalPreemptsTheFirst) {
  TrajectoryController::Config config = threeJoints();
  config.rules.tolerances.path.assign(3, {0.1, 0.0, 0.0});
  Driven arm(config);
  ASSERT_EQ(arm.controller.accept(goalOf({point(1.0, {1.1, 1.2, 1.3})})).fault, Fault::kNone);
  arm.run(0.5);
  auto second = goalOf({point(1.0, {0.1, 0.2, 0.3}, Values(3, 0.0))});
  second.start = arm.now + fromSeconds(0.2);
  ASSERT_EQ(arm.controller.accept(second).fault, Fault::kNone);
  EXPECT_TRUE(arm.controller.hasGoal());
  arm.aside[0] = 0.2;
  EXPECT_FALSE(arm.run(0.19)) << "the way of the first is watched no more";
  EXPECT_NEAR(arm.position(0), 0.79, 1e-12);
  arm.aside[0] = 0.0;
  const auto end = arm.run(1.02);
  ASSERT_TRUE(end);
  EXPECT_EQ(end->kind, Kind::kReached);
  EXPECT_NEAR(arm.position(0), 0.1, 1e-12);
}

TEST(TrajectoryControllerGoalsTest, ATrajectoryFromTheTopicPreemptsAGoal) {
  for (const TrajectoryGoal& command : {goalOf({point(1.0, {0.1, 0.2, 0.3})}), TrajectoryGoal()}) {
    Driven arm;
    ASSERT_EQ(arm.controller.accept(goalOf({point(1.0, {1.1, 1.2, 1.3})})).fault, Fault::kNone);
    arm.run(0.5);
    ASSERT_EQ(arm.controller.command(command), "");
    EXPECT_FALSE(arm.controller.hasGoal());
    EXPECT_FALSE(arm.run(2.0)) << "its end is told by whoever preempted it";
  }
}

TEST(TrajectoryControllerGoalsTest, ACancelledGoalStopsTheJoints) {
  Driven arm;
  ASSERT_EQ(arm.controller.accept(goalOf({point(1.0, {1.1, 1.2, 1.3})})).fault, Fault::kNone);
  arm.run(0.5);
  arm.controller.cancel();
  EXPECT_FALSE(arm.controller.hasGoal());
  EXPECT_FALSE(arm.run(1.0));
  for (std::size_t j = 0; j < 3; ++j) {
    EXPECT_NEAR(arm.position(j), 0.6 + 0.1 * static_cast<double>(j) + 0.625 * 1.0 * 0.4, 1e-9);
  }
  ASSERT_EQ(arm.controller.command(goalOf({point(1.0, {0.1, 0.2, 0.3})})), "");
  arm.run(0.5);
  arm.controller.cancel();
  EXPECT_TRUE(arm.controller.follows()) << "no goal is active";
}

TEST(TrajectoryControllerGoalsTest, AGoalWithoutPointsIsReachedWhenTheJointsHaveStopped) {
  Driven arm;
  ASSERT_EQ(arm.controller.command(goalOf({point(1.0, {1.1, 1.2, 1.3})})), "");
  arm.run(0.5);
  ASSERT_EQ(arm.controller.accept(goalOf({})).fault, Fault::kNone);
  EXPECT_FALSE(arm.run(0.398));
  const auto end = arm.run(0.003);
  ASSERT_TRUE(end);
  EXPECT_EQ(end->kind, Kind::kReached);
}

TEST(TrajectoryControllerGoalsTest, ItsConfigurationIsChecked) {
  TrajectoryController::Config config = threeJoints();
  config.stop_duration_s = -0.1;
  EXPECT_THROW(Driven{config}, ConfigError);
  config = threeJoints();
  config.rules.joints = {"a", "a", "b"};
  EXPECT_THROW(Driven{config}, ConfigError);
}

}  // namespace
}  // namespace tccm::simulation
