#include "simulation/trajectory_controller.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>

#include "support/driven_controller.h"
#include "support/random.h"
#include "tccm_monitor/config_error.h"

namespace tccm::simulation {
namespace {

using namespace driven;

/// The polynomial of degree 5 through position, velocity and acceleration at 0 and T.
Eigen::Matrix<double, 6, 1> quintic(const JointSpline::State& a, const JointSpline::State& b,
                                    double T) {
  Eigen::Matrix<double, 6, 6> m = Eigen::Matrix<double, 6, 6>::Zero();
  for (int i = 0; i < 6; ++i) {  // in shares of T, at 0 and 1
    m(0, i) = i == 0 ? 1.0 : 0.0;
    m(1, i) = i == 1 ? 1.0 : 0.0;
    m(2, i) = i == 2 ? 2.0 : 0.0;
    m(3, i) = 1.0;
    m(4, i) = i;
    m(5, i) = i * (i - 1);
  }
  Eigen::Matrix<double, 6, 1> bounds;
  bounds << a.position, T * a.velocity, T * T * a.acceleration, b.position, T * b.velocity,
      T * T * b.acceleration;
  Eigen::Matrix<double, 6, 1> c = m.fullPivLu().solve(bounds);
  for (int i = 0; i < 6; ++i) c[i] /= std::pow(T, i);
  return c;
}

JointSpline::State valueOf(const Eigen::Matrix<double, 6, 1>& c, double t) {
  JointSpline::State state{0.0, 0.0, 0.0};
  for (int i = 0; i < 6; ++i) {
    state.position += c[i] * std::pow(t, i);
    if (i > 0) state.velocity += i * c[i] * std::pow(t, i - 1);
    if (i > 1) state.acceleration += i * (i - 1) * c[i] * std::pow(t, i - 2);
  }
  return state;
}

TEST(TrajectoryControllerTest, JointsRestWhereTheyBegin) {
  Driven arm;
  EXPECT_FALSE(arm.run(1.0));
  EXPECT_EQ(arm.position(1), 0.2);
  EXPECT_EQ(arm.velocity(1), 0.0);
  EXPECT_FALSE(arm.controller.follows());
  EXPECT_FALSE(arm.controller.stoppingSince());
}

TEST(TrajectoryControllerTest, AWayIsStraightCubicOrQuinticAfterItsPoints) {
  const Values to = {1.0, 2.0, -3.0};
  Driven straight;
  EXPECT_EQ(straight.controller.command(goalOf({point(2.0, to)})), "");
  straight.run(0.5);
  EXPECT_NEAR(straight.position(0), 0.1 + 0.25 * 0.9, 1e-12);
  EXPECT_NEAR(straight.velocity(0), 0.45, 1e-12);
  Driven cubic;
  EXPECT_EQ(cubic.controller.command(goalOf({point(2.0, to, {0.0, 0.0, 0.0})})), "");
  cubic.run(0.5);
  EXPECT_NEAR(cubic.position(0), 0.1 + (3.0 / 16.0 - 2.0 / 64.0) * 0.9, 1e-12);
  Driven quintic;
  const Values zero(3, 0.0);
  EXPECT_EQ(quintic.controller.command(goalOf({point(2.0, to, zero, zero)})), "");
  quintic.run(0.5);
  EXPECT_NEAR(quintic.position(0), 0.1 + (10.0 / 64.0 - 15.0 / 256.0 + 6.0 / 1024.0) * 0.9, 1e-12);
  quintic.run(1.6);
  EXPECT_NEAR(quintic.position(2), -3.0, 1e-12);
  EXPECT_EQ(quintic.velocity(2), 0.0);
}

TEST(TrajectoryControllerTest, AnEmptyCommandTakesFiveEighthsOfSpeedTimesStopDuration) {
  for (const double duration : {0.1, 0.4, 1.0}) {
    for (unsigned seed = 0; seed < 20; ++seed) {
      test::Random random(seed);
      TrajectoryController::Config config = threeJoints();
      config.stop_duration_s = duration;
      Driven arm(config);
      const Values to = {random.uniform(-3.0, 3.0), random.uniform(-3.0, 3.0), 0.3};
      ASSERT_EQ(arm.controller.command(goalOf({point(2.0, to, Values(3, 0.2))})), "");
      arm.run(random.uniform(0.2, 1.8));
      const Values from = {arm.position(0), arm.position(1), arm.position(2)};
      const Values speed = {arm.velocity(0), arm.velocity(1), arm.velocity(2)};
      const Time told = arm.now;
      ASSERT_EQ(arm.controller.command({}), "");
      EXPECT_EQ(arm.controller.stoppingSince(), told);
      EXPECT_FALSE(arm.controller.follows());
      double way = 0.0;  // of the first, integrated
      for (double last = speed[0]; arm.now - told < fromSeconds(duration);) {
        arm.run(0.001);
        EXPECT_LE(std::abs(arm.velocity(0)), std::abs(last) + 1e-12) << "it gets only slower";
        EXPECT_GE(arm.velocity(0) * speed[0], -1e-12) << "and never goes back";
        way += 0.0005 * (last + arm.velocity(0));
        last = arm.velocity(0);
      }
      EXPECT_NEAR(way, 0.625 * speed[0] * duration, 2e-5);
      arm.run(1.0);
      for (std::size_t j = 0; j < 3; ++j) {
        EXPECT_NEAR(arm.position(j), from[j] + 0.625 * speed[j] * duration, 1e-9);
        EXPECT_EQ(arm.velocity(j), 0.0);
      }
    }
  }
}

TEST(TrajectoryControllerTest, WithoutAStopDurationTheJointsAreHeldAtOnceWhereTheyAre) {
  TrajectoryController::Config config = threeJoints();
  config.stop_duration_s = 0.0;
  Driven arm(config);
  ASSERT_EQ(arm.controller.command(goalOf({point(1.0, {1.1, 1.2, 1.3})})), "");
  arm.run(0.5);
  arm.aside[1] = -0.05;
  arm.run(0.001);
  const double measured = arm.controller.positions()[1];
  EXPECT_NEAR(measured, 0.65, 1e-3);
  ASSERT_EQ(arm.controller.command({}), "");
  arm.run(0.001);
  EXPECT_EQ(arm.position(1), measured);
  EXPECT_EQ(arm.velocity(1), 0.0);
  arm.run(1.0);
  EXPECT_EQ(arm.position(1), measured);
}

TEST(TrajectoryControllerTest, ANewTrajectoryBeginsFromWhereTheJointsAreToBe) {
  Driven arm;
  ASSERT_EQ(arm.controller.command(goalOf({point(1.0, {1.1, 1.2, 1.3})})), "");
  arm.run(0.5);
  arm.aside[0] = 0.2;
  arm.run(0.001);
  const double before = arm.position(0);
  ASSERT_EQ(arm.controller.command(goalOf({point(1.0, {0.1, 0.2, 0.3})})), "");
  arm.run(0.001);
  EXPECT_NEAR(arm.position(0), before - 0.001 * (before - 0.1), 1e-12);
}

TEST(TrajectoryControllerTest, WhatCannotBeFollowedIsNotTakenAndWhatWasBeforeGoesOn) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Driven arm;
  ASSERT_EQ(arm.controller.accept(goalOf({point(1.0, {1.1, 1.2, 1.3})})).fault, Fault::kNone);
  arm.run(0.5);
  const Values to = {0.0, 0.0, 0.0};
  auto stale = goalOf({point(1.0, to), point(2.0, to)});
  stale.start = arm.now - fromSeconds(2.0);
  const std::vector<std::pair<TrajectoryGoal, Fault>> bad = {
      {goalOf({point(1.0, {0.0, 0.0})}, {"a", "b"}), Fault::kInvalidJoints},
      {goalOf({point(1.0, to)}, {"a", "b", "d"}), Fault::kInvalidJoints},
      {goalOf({}, {}), Fault::kInvalidJoints},
      {goalOf({point(1.0, {0.0, 0.0, nan})}), Fault::kInvalidGoal},
      {goalOf({point(1.0, to), point(1.0, to)}), Fault::kInvalidGoal},
      {goalOf({point(0.0, to)}), Fault::kInvalidGoal},
      {stale, Fault::kInvalidGoal}};
  for (const auto& [goal, fault] : bad) {
    EXPECT_EQ(arm.controller.accept(goal).fault, fault);
    EXPECT_EQ(arm.controller.command(goal).empty(), goal.trajectory.points.empty());
    if (goal.trajectory.points.empty()) {  // from the topic that is a stop, whatever it names
      arm = Driven();
      ASSERT_EQ(arm.controller.accept(goalOf({point(1.0, {1.1, 1.2, 1.3})})).fault, Fault::kNone);
      arm.run(0.5);
    }
    EXPECT_TRUE(arm.controller.hasGoal());
  }
  const auto end = arm.run(0.6);
  EXPECT_NEAR(arm.position(0), 1.1, 1e-12);
  ASSERT_TRUE(end);
}

TEST(TrajectoryControllerTest, AStampInThePastLeavesOutWhatIsOver) {
  Driven arm;
  auto late = goalOf({point(0.5, {9.0, 9.0, 9.0}), point(2.0, {1.1, 1.2, 1.3})});
  late.start = kStart - fromSeconds(1.0);
  ASSERT_EQ(arm.controller.command(late), "");
  arm.run(0.5);
  EXPECT_NEAR(arm.position(0), 0.6, 1e-12);
  arm.run(0.6);
  EXPECT_NEAR(arm.position(0), 1.1, 1e-12);
}

TEST(TrajectoryControllerTest, AStampInTheFutureLeavesWhatWasBeforeUnderWayUntilThen) {
  Driven arm;
  ASSERT_EQ(arm.controller.command(goalOf({point(1.0, {1.1, 1.2, 1.3})})), "");
  arm.run(0.25);
  auto later = goalOf({point(1.0, {0.1, 0.2, 0.3})});
  later.start = kStart + fromSeconds(0.75);
  ASSERT_EQ(arm.controller.command(later), "");
  arm.run(0.25);
  EXPECT_NEAR(arm.position(0), 0.6, 1e-12);
  arm.run(0.25);
  EXPECT_NEAR(arm.position(0), 0.85, 1e-12);
  arm.run(0.5);
  EXPECT_NEAR(arm.position(0), 0.475, 1e-12);
  arm.run(0.6);
  EXPECT_NEAR(arm.position(0), 0.1, 1e-12);
}

TEST(TrajectoryControllerTest, JointsThatAGoalLeavesOutGoOn) {
  TrajectoryController::Config config = threeJoints();
  config.rules.allow_partial_joints_goal = true;
  config.rules.tolerances.end_time_s = 0.1;
  Driven arm(config);
  ASSERT_EQ(arm.controller.command(goalOf({point(2.0, {2.1, 2.2, 2.3})})), "");
  arm.run(0.5);
  ASSERT_EQ(arm.controller.accept(goalOf({point(0.5, {0.0})}, {"b"})).fault, Fault::kNone);
  EXPECT_FALSE(arm.run(0.75));
  EXPECT_NEAR(arm.position(0), 1.35, 1e-12);
  EXPECT_NEAR(arm.position(1), 0.0, 1e-12);
  EXPECT_NEAR(arm.position(2), 1.55, 1e-12);
  const auto end = arm.run(0.76);
  EXPECT_NEAR(arm.position(0), 2.1, 1e-12);
  ASSERT_TRUE(end) << "it is over when they have come to their end too";
  EXPECT_EQ(end->kind, Kind::kReached);
}

TEST(TrajectoryControllerTest, ContinuousJointsTakeTheShortWay) {
  TrajectoryController::Config config = threeJoints();
  config.rules.turn_freely = {true, false, true};
  for (unsigned seed = 0; seed < 50; ++seed) {
    test::Random random(seed);
    const Values from = {random.uniform(-20.0, 20.0), 0.2, random.uniform(-20.0, 20.0)};
    const Values to = {random.uniform(-20.0, 20.0), 9.0, random.uniform(-20.0, 20.0)};
    Driven arm(config, from);
    ASSERT_EQ(arm.controller.command(goalOf({point(1.0, to)})), "");
    arm.run(1.1);
    for (const std::size_t j : {std::size_t{0}, std::size_t{2}}) {
      EXPECT_LE(std::abs(arm.position(j) - from[j]), M_PI + 1e-9);
      EXPECT_NEAR(std::remainder(arm.position(j) - to[j], 2.0 * M_PI), 0.0, 1e-9);
    }
    EXPECT_NEAR(arm.position(1), 9.0, 1e-9);
    arm.aside[0] = 2.0 * M_PI;
    arm.run(0.001);
    EXPECT_NEAR(arm.controller.positionError(0), 0.0, 1e-9);
  }
}

/// What a joint does, as a function of the seconds since kStart, built up command by command.
using Motion = std::function<JointSpline::State(double)>;

Motion rest(double position) {
  return [position](double) { return JointSpline::State{position, 0.0, 0.0}; };
}

/// Until t0 as before, from then through the points; the latter in seconds since kStart.
Motion through(const Motion& before, double t0, const std::vector<Point>& points, std::size_t j) {
  struct Leg {
    double from, to;
    Eigen::Matrix<double, 6, 1> c;
  };
  std::vector<Leg> legs;
  JointSpline::State a = before(t0);
  bool a_moves = true, a_bends = true;
  double from = t0;
  for (const Point& point : points) {
    const bool b_moves = !point.velocities.empty(), b_bends = !point.accelerations.empty();
    const JointSpline::State b{point.positions[j], b_moves ? point.velocities[j] : 0.0,
                               b_bends ? point.accelerations[j] : 0.0};
    const double T = point.time_s - from, d = b.position - a.position;
    Eigen::Matrix<double, 6, 1> c = Eigen::Matrix<double, 6, 1>::Zero();
    if (!a_moves || !b_moves) {
      c << a.position, d / T, 0.0, 0.0, 0.0, 0.0;
    } else if (!a_bends || !b_bends) {
      Eigen::Matrix2d m;
      m << T * T, T * T * T, 2.0 * T, 3.0 * T * T;
      const Eigen::Vector2d x =
          m.fullPivLu().solve(Eigen::Vector2d(d - a.velocity * T, b.velocity - a.velocity));
      c << a.position, a.velocity, x[0], x[1], 0.0, 0.0;
    } else {
      c = quintic(a, b, T);
    }
    legs.push_back({from, point.time_s, c});
    a = b;
    a_moves = b_moves;
    a_bends = b_bends;
    from = point.time_s;
  }
  return [before, t0, legs](double t) {
    if (t < t0) return before(t);
    for (const Leg& leg : legs) {
      if (t < leg.to - 1e-9) return valueOf(leg.c, t - leg.from);
    }
    JointSpline::State end = valueOf(legs.back().c, legs.back().to - legs.back().from);
    if (t > legs.back().to + 1e-9) end.velocity = end.acceleration = 0.0;
    return end;
  };
}

Motion stopped(const Motion& before, double t0, double T) {
  const JointSpline::State from = before(t0);
  const auto c =
      quintic({from.position, from.velocity, 0.0}, {from.position, -from.velocity, 0.0}, 2.0 * T);
  return [before, t0, T, c](double t) {
    if (t < t0) return before(t);
    JointSpline::State state = valueOf(c, std::min(t - t0, T));
    if (t - t0 > T + 1e-9) state.velocity = state.acceleration = 0.0;
    return state;
  };
}

/// Random trajectories of random joints in random order, with and without velocities and
/// accelerations, from now, the past and the future, from topic and action, and stops.
class RandomCommands {
 public:
  explicit RandomCommands(unsigned seed) : random_(seed), arm_(config()) {
    for (std::size_t j = 0; j < 3; ++j) expected_.push_back(rest(arm_.position(j)));
  }

  void run() {
    for (int i = 0; i < 8; ++i) {
      random_.chance(0.2) ? stop() : send();
      follow(random_.integer(1, 900));
    }
  }

 private:
  static TrajectoryController::Config config() {
    TrajectoryController::Config config = threeJoints();
    config.rules.allow_partial_joints_goal = true;
    return config;
  }

  void stop() {
    if (random_.chance(0.5)) {
      ASSERT_EQ(arm_.controller.command({}), "");
    } else {
      ASSERT_EQ(arm_.controller.accept(goalOf({})).fault, Fault::kNone);
    }
    for (Motion& motion : expected_) motion = stopped(motion, arm_.elapsed(), 0.4);
  }

  void send() {
    std::vector<std::size_t> order = {0, 1, 2};
    for (std::size_t i = 2; i > 0; --i) {
      std::swap(order[i], order[static_cast<std::size_t>(random_.integer(0, static_cast<int>(i)))]);
    }
    order.resize(static_cast<std::size_t>(random_.integer(1, 3)));
    TrajectoryGoal goal;
    for (const std::size_t j : order) goal.trajectory.names.push_back(kJoints[j]);
    const double start_s = start(goal);
    const int content = random_.integer(0, 3);  // the last: each point another
    double time_s = 0.0005;  // no corner in a cycle's instant: which side counts is anyone's guess
    for (int i = random_.integer(1, 4); i > 0; --i) {
      time_s += 1e-3 * random_.integer(20, 700);
      const int has = content < 3 ? content : random_.integer(0, 2);
      goal.trajectory.points.push_back(point(time_s, values(order.size()),
                                             has > 0 ? values(order.size()) : Values{},
                                             has > 1 ? values(order.size()) : Values{}));
    }
    const bool is_over = start_s + time_s <= arm_.elapsed() + 1e-9;
    const bool taken = random_.chance(0.5) ? arm_.controller.command(goal).empty()
                                           : arm_.controller.accept(goal).fault == Fault::kNone;
    ASSERT_EQ(taken, !is_over);
    if (!taken) return;
    std::vector<Point> points;
    for (Point point : goal.trajectory.points) {
      point.time_s += start_s;
      if (point.time_s > arm_.elapsed() + 1e-9) points.push_back(point);
    }
    for (std::size_t i = 0; i < order.size(); ++i) {
      Motion& motion = expected_[order[i]];
      motion = through(motion, std::max(start_s, arm_.elapsed()), points, i);
    }
  }

  double start(TrajectoryGoal& goal) {
    const int when = random_.integer(0, 2);
    if (when == 0) return arm_.elapsed();
    goal.start = arm_.now + (when == 1 ? -1 : 1) * random_.integer(0, 700) * kStep;
    return toSeconds(*goal.start - kStart);
  }

  Values values(std::size_t size) {
    Values values;
    while (values.size() < size) values.push_back(random_.uniform(-1.0, 1.0));
    return values;
  }

  void follow(int steps) {
    for (int i = 0; i < steps; ++i) {
      arm_.run(0.001);
      for (std::size_t j = 0; j < 3; ++j) {
        const JointSpline::State expected = expected_[j](arm_.elapsed());
        ASSERT_NEAR(arm_.position(j), expected.position, 1e-6) << arm_.elapsed() << " s";
        ASSERT_NEAR(arm_.velocity(j), expected.velocity, 1e-4 + 1e-5 * std::abs(expected.velocity))
            << arm_.elapsed() << " s";
      }
    }
  }

  test::Random random_;
  Driven arm_;
  std::vector<Motion> expected_;
};

TEST(TrajectoryControllerTest, RandomCommandsAreFollowedAsThePolynomialsThroughTheirPointsGo) {
  for (unsigned seed = 0; seed < 100; ++seed) {
    SCOPED_TRACE(seed);
    RandomCommands(seed).run();
    if (HasFatalFailure()) return;
  }
}

}  // namespace
}  // namespace tccm::simulation
