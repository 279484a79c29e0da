#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "robot/joint_path.h"
#include "support/random.h"
#include "support/refusal.h"
#include "support/tiny_robot.h"

namespace tccm {
namespace {

using namespace test::urdf_text;
using test::Random;

using Positions = std::vector<double>;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kPi = 3.14159265358979323846;
constexpr double kTolerance = 1e-3;

/// Its variables are turn, lift, spin and rail, in whichever order.
std::string urdf() {
  return test::robotOf(
      linkOf("base") + ballLink("a") + ballLink("b") + ballLink("c") + ballLink("d") +
      ballLink("e") + linkOf("f") + ballLink("g") + ballLink("h") +
      jointOf("turn", "revolute", "base", "a", axisOf("0 0 1") + limitOf("-3", "3")) +
      jointOf("lift", "prismatic", "base", "b", axisOf("0 0 1") + limitOf("-1", "1")) +
      jointOf("spin", "continuous", "base", "c", axisOf("0 0 1")) +
      jointOf("follow", "revolute", "base", "d",
              axisOf("0 0 1") + limitOf("-9", "9") + "<mimic joint=\"turn\"/>") +
      jointOf("weld", "fixed", "base", "e") +
      jointOf("idle", "revolute", "base", "f", axisOf("0 0 1") + limitOf("-3", "3")) +
      jointOf("held", "revolute", "base", "g", axisOf("0 0 1") + limitOf("-3", "3")) +
      jointOf("rail", "prismatic", "base", "h",
              axisOf("1 0 0") + "<limit effort=\"1\" velocity=\"1\"/>"));
}

class JointTrajectoryTest : public ::testing::Test {
 protected:
  JointTrajectoryTest() {
    RobotModel::Config config;
    config.fixed_joints["held"] = 0.2;
    model_ = test::modelOf(urdf(), config);
    from_.resize(model_->variables().size(), 0.0);
  }

  [[nodiscard]] std::string defect(const JointTrajectory& trajectory) const {
    return defectOf(trajectory, *model_);
  }
  [[nodiscard]] std::size_t variable(const std::string& joint) const {
    return variablesOf({{joint}, {}}, *model_).front();
  }
  [[nodiscard]] JointPath pathOf(const JointTrajectory& trajectory,
                                 double tolerance = kTolerance) const {
    EXPECT_EQ(defect(trajectory), "");
    JointPath path(model_->variables().size());
    makePath(trajectory, *model_, from_, tolerance, path);
    return path;
  }
  [[nodiscard]] double at(const JointPath& path, const std::string& joint, double time_s) const {
    Positions positions;
    path.positionsAt(time_s, positions);
    return positions[variable(joint)];
  }

  std::shared_ptr<const RobotModel> model_;
  Positions from_;
};

/// A good one, to be spoilt.
JointTrajectory good() {
  return {{"lift", "turn"},
          {{0.0, {0.1, 0.2}, {0.0, 0.0}, {0.0, 0.0}}, {1.0, {0.3, 0.4}, {0.0, 0.0}, {0.0, 0.0}}}};
}

TEST_F(JointTrajectoryTest, OneThatIsWholeHasNoDefect) {
  EXPECT_EQ(defect(good()), "");
  EXPECT_EQ(defect({{"turn"}, {{0.0, {0.5}, {}, {}}}}), "") << "one point";
  EXPECT_EQ(defect({{"turn"}, {{1.0, {0.5}, {}, {}}, {2.0, {0.7}, {0.1}, {}}}}), "")
      << "velocities at one point alone";
}

TEST_F(JointTrajectoryTest, NoJointsOrNoPointsAreADefect) {
  EXPECT_TRUE(test::names(defect({{}, good().points}), "no joint"));
  EXPECT_TRUE(test::names(defect({good().names, {}}), "no points"));
}

TEST_F(JointTrajectoryTest, AJointThatCannotBeCommandedIsNamed) {
  const auto with = [this](const std::string& joint) {
    JointTrajectory trajectory = good();
    trajectory.names[1] = joint;
    return defect(trajectory);
  };
  EXPECT_EQ(with("spin"), "");
  EXPECT_TRUE(test::names(with("lift"), "'lift'") && test::names(with("lift"), "twice"));
  EXPECT_TRUE(test::names(with("elbow"), "'elbow'")) << "the robot has no such joint";
  EXPECT_TRUE(test::names(with(""), "''"));
  EXPECT_TRUE(test::names(with("idle"), "'idle'")) << "it moves no monitored link";
  EXPECT_TRUE(test::names(with("follow"), "'follow'")) << "it follows another";
  EXPECT_TRUE(test::names(with("weld"), "'weld'")) << "it is fixed";
  EXPECT_TRUE(test::names(with("held"), "'held'") && test::names(with("held"), "fixed_joints"));
}

TEST_F(JointTrajectoryTest, APointWhoseNumbersAreTooFewOrNoneIsNamed) {
  const auto spoilt = [this](const std::function<void(JointTrajectory::Point&)>& spoil) {
    JointTrajectory trajectory = good();
    spoil(trajectory.points[1]);
    return defect(trajectory);
  };
  using Point = JointTrajectory::Point;
  EXPECT_TRUE(test::names(spoilt([](Point& point) { point.positions.clear(); }), "point 1"));
  EXPECT_TRUE(test::names(spoilt([](Point& point) { point.positions.pop_back(); }), "point 1"));
  EXPECT_TRUE(test::names(spoilt([](Point& point) { point.positions.push_back(0.0); }), "point 1"));
  EXPECT_TRUE(test::names(spoilt([](Point& point) { point.velocities.pop_back(); }), "point 1"));
  EXPECT_TRUE(test::names(spoilt([](Point& point) { point.accelerations = {0.0}; }), "point 1"));
  EXPECT_EQ(spoilt([](Point& point) { point.velocities.clear(); }), "");
  for (const double bad : {kNaN, HUGE_VAL, -HUGE_VAL, 1e7}) {
    EXPECT_TRUE(test::names(spoilt([bad](Point& point) { point.positions[1] = bad; }), "point 1"));
    EXPECT_TRUE(test::names(spoilt([bad](Point& point) { point.velocities[0] = bad; }), "point 1"));
    EXPECT_TRUE(
        test::names(spoilt([bad](Point& point) { point.accelerations[1] = bad; }), "point 1"));
    EXPECT_TRUE(test::names(spoilt([bad](Point& point) { point.time_s = bad; }), "point 1"));
  }
}

TEST_F(JointTrajectoryTest, TimesThatDoNotRiseOrLieBeforeTheStartAreNamed) {
  const auto timed = [this](double first, double second) {
    JointTrajectory trajectory = good();
    trajectory.points[0].time_s = first;
    trajectory.points[1].time_s = second;
    return defect(trajectory);
  };
  EXPECT_EQ(timed(0.0, 1e-3), "");
  EXPECT_TRUE(test::names(timed(0.5, 0.5), "point 1"));
  EXPECT_TRUE(test::names(timed(0.5, 0.4), "point 1"));
  EXPECT_TRUE(test::names(timed(-0.1, 0.4), "point 0"));
}

TEST_F(JointTrajectoryTest, TimesTooNearToEachOtherForASplineAreNamed) {
  for (const double tiny : {5e-324, 1e-200, 1e-100, 1e-13}) {
    JointTrajectory trajectory = good();
    trajectory.points[1].time_s = tiny;
    EXPECT_TRUE(test::names(defect(trajectory), "point 1")) << tiny;
    trajectory.points[0].time_s = tiny;
    trajectory.points[1].time_s = 1.0;
    EXPECT_TRUE(test::names(defect(trajectory), "point 0")) << tiny;
  }
  for (const double tiny : {1e-12, 1e-9}) {
    JointTrajectory trajectory = good();
    trajectory.points[1].time_s = tiny;
    ASSERT_EQ(defect(trajectory), "");
    JointPath path(model_->variables().size());
    ASSERT_TRUE(makePath(trajectory, *model_, from_, 1e-3, path));
    EXPECT_EQ(path.end(), tiny);
    EXPECT_EQ(at(path, "lift", tiny), 0.3) << "the last point is not left out";
  }
}

TEST_F(JointTrajectoryTest, ADefectIsToldInOneLineWhateverAJointIsCalled) {
  JointTrajectory trajectory = good();
  trajectory.names[1] = "a\nb";
  EXPECT_EQ(defect(trajectory), "joint 'a b' is not one of the robot's");
  trajectory.names = {"a\nb", "a\nb"};
  EXPECT_EQ(defect(trajectory).find('\n'), std::string::npos);
}

TEST_F(JointTrajectoryTest, VariablesComeInTheOrderOfItsNames) {
  for (const JointTrajectory& trajectory :
       {JointTrajectory{{"spin", "turn", "lift"}, {}}, JointTrajectory{{"lift", "spin"}, {}}}) {
    const std::vector<std::size_t> variables = variablesOf(trajectory, *model_);
    ASSERT_EQ(variables.size(), trajectory.names.size());
    for (std::size_t j = 0; j < variables.size(); ++j) {
      EXPECT_EQ(model_->variables()[variables[j]].name, trajectory.names[j]);
    }
  }
}

TEST_F(JointTrajectoryTest, PointsWithoutVelocitiesAreJoinedByStraightLines) {
  const JointPath path =
      pathOf({{"lift", "turn"},
              {{0.0, {0.0, 1.0}, {}, {}}, {1.0, {0.5, 0.0}, {}, {}}, {3.0, {-0.5, 1.0}, {}, {}}}});
  EXPECT_EQ(path.size(), 3U);
  EXPECT_EQ(path.begin(), 0.0);
  EXPECT_EQ(path.end(), 3.0);
  EXPECT_DOUBLE_EQ(at(path, "lift", 0.5), 0.25);
  EXPECT_DOUBLE_EQ(at(path, "turn", 0.5), 0.5);
  EXPECT_DOUBLE_EQ(at(path, "lift", 2.0), 0.0);
  EXPECT_DOUBLE_EQ(at(path, "turn", 3.0), 1.0);
}

TEST_F(JointTrajectoryTest, VelocitiesAtOneEndAloneLeaveTheLineStraight) {
  const JointPath path = pathOf({{"turn"}, {{0.0, {0.0}, {2.0}, {1.0}}, {1.0, {1.0}, {}, {3.0}}}});
  for (double t = 0.0; t <= 1.0; t += 0.1) EXPECT_NEAR(at(path, "turn", t), t, 1e-12);
}

TEST_F(JointTrajectoryTest, AFirstPointLaterThanTheStartIsReachedFromWhereTheRobotIs) {
  from_[variable("turn")] = -1.0;
  const JointPath path = pathOf({{"turn"}, {{2.0, {1.0}, {}, {}}, {3.0, {2.0}, {}, {}}}});
  EXPECT_EQ(path.begin(), 0.0);
  EXPECT_DOUBLE_EQ(at(path, "turn", 0.0), -1.0);
  EXPECT_DOUBLE_EQ(at(path, "turn", 1.0), 0.0);
  EXPECT_DOUBLE_EQ(at(path, "turn", 2.0), 1.0);
  EXPECT_DOUBLE_EQ(at(path, "turn", 2.5), 1.5);
}

TEST_F(JointTrajectoryTest, AFirstPointAtTheStartIsWhereItBegins) {
  from_[variable("turn")] = -1.0;
  const JointPath path = pathOf({{"turn"}, {{0.0, {1.0}, {}, {}}, {1.0, {2.0}, {}, {}}}});
  EXPECT_EQ(path.size(), 2U);
  EXPECT_DOUBLE_EQ(at(path, "turn", 0.0), 1.0);
}

TEST_F(JointTrajectoryTest, WhatIsNotNamedStaysWhereItIs) {
  for (std::size_t v = 0; v < from_.size(); ++v) from_[v] = 0.1 * static_cast<double>(v + 1);
  const JointPath path = pathOf(
      {{"turn"}, {{0.5, {1.0}, {0.0}, {}}, {1.0, {2.0}, {0.3}, {}}, {1.5, {0.0}, {0.0}, {}}}});
  for (double t = 0.0; t <= 1.5; t += 0.05) {
    for (const std::string joint : {"lift", "spin", "rail"}) {
      EXPECT_EQ(at(path, joint, t), from_[variable(joint)]) << joint;
    }
  }
}

TEST_F(JointTrajectoryTest, ARotationWithoutLimitsTakesTheShortWayToTheFirstPoint) {
  const auto spunTo = [this](double from, double first, double second) {
    from_[variable("spin")] = from;
    const JointPath path = pathOf({{"spin"}, {{1.0, {first}, {}, {}}, {2.0, {second}, {}, {}}}});
    return std::make_pair(at(path, "spin", 1.0), at(path, "spin", 2.0));
  };
  EXPECT_EQ(spunTo(0.1, 0.2, 3.0), std::make_pair(0.2, 3.0));
  EXPECT_NEAR(spunTo(3.0, -3.0, -2.0).first, 2.0 * kPi - 3.0, 1e-12);
  EXPECT_NEAR(spunTo(3.0, -3.0, -2.0).second, 2.0 * kPi - 2.0, 1e-12) << "from there on as told";
  EXPECT_NEAR(spunTo(-3.0, 3.0, 9.0).first, 3.0 - 2.0 * kPi, 1e-12);
  EXPECT_NEAR(spunTo(-3.0, 3.0, 9.0).second, 9.0 - 2.0 * kPi, 1e-12) << "more than a turn";
  EXPECT_NEAR(spunTo(100.0, 0.0, 1.0).first, 32.0 * kPi, 1e-9);
}

TEST_F(JointTrajectoryTest, AJointWithLimitsTurnsTheWayItIsTold) {
  from_[variable("turn")] = 2.9;
  EXPECT_EQ(at(pathOf({{"turn"}, {{1.0, {-2.9}, {}, {}}}}), "turn", 1.0), -2.9);
}

TEST_F(JointTrajectoryTest, ASlideWithoutLimitsKnowsNoWholeTurns) {
  EXPECT_EQ(at(pathOf({{"rail"}, {{1.0, {5.0}, {}, {}}}}), "rail", 1.0), 5.0);
}

TEST_F(JointTrajectoryTest, WhatThePathHeldBeforeIsForgotten) {
  JointPath path(model_->variables().size());
  path.add(7.0, from_);
  makePath({{"turn"}, {{0.0, {1.0}, {}, {}}}}, *model_, from_, kTolerance, path);
  EXPECT_EQ(path.size(), 1U);
  EXPECT_EQ(path.end(), 0.0);
}

/// The polynomial that has the given values and derivatives at both ends, by solving for its
/// coefficients. @param ends of the begin, then of the end: value, first derivative ...
double polynomialAt(const std::vector<double>& ends, double T, double t) {
  const auto n = static_cast<Eigen::Index>(ends.size());
  Eigen::MatrixXd equations = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index row = 0; row < n; ++row) {
    const Eigen::Index order = row % (n / 2);
    const double where = row < n / 2 ? 0.0 : T;
    for (Eigen::Index power = order; power < n; ++power) {
      double factor = 1.0;
      for (Eigen::Index k = 0; k < order; ++k) factor *= static_cast<double>(power - k);
      equations(row, power) = factor * std::pow(where, static_cast<double>(power - order));
    }
  }
  const Eigen::VectorXd c =
      equations.fullPivLu().solve(Eigen::Map<const Eigen::VectorXd>(ends.data(), n));
  double value = 0.0;
  for (Eigen::Index power = 0; power < n; ++power) {
    value += c[power] * std::pow(t, static_cast<double>(power));
  }
  return value;
}

/// The largest distance of the path's joint from what the points say, sampled densely.
double largestError(const JointTrajectory& trajectory, std::size_t joint,
                    const std::function<double(double)>& joint_at, bool with_accelerations) {
  double largest = 0.0;
  for (std::size_t i = 0; i + 1 < trajectory.points.size(); ++i) {
    const JointTrajectory::Point &a = trajectory.points[i], &b = trajectory.points[i + 1];
    std::vector<double> ends{a.positions[joint], a.velocities[joint]};
    if (with_accelerations) ends.push_back(a.accelerations[joint]);
    ends.insert(ends.end(), {b.positions[joint], b.velocities[joint]});
    if (with_accelerations) ends.push_back(b.accelerations[joint]);
    const double T = b.time_s - a.time_s;
    for (int k = 0; k <= 100; ++k) {
      const double t = T * k / 100;
      const double error = std::abs(joint_at(a.time_s + t) - polynomialAt(ends, T, t));
      largest = std::max(largest, error);
    }
  }
  return largest;
}

JointTrajectory randomTrajectory(Random& random, bool with_accelerations) {
  JointTrajectory trajectory{{"turn", "lift"}, {}};
  double time_s = random.chance(0.5) ? 0.0 : random.uniform(0.0, 1.0);
  for (int i = 0; i < 4; ++i, time_s += random.uniform(0.1, 2.0)) {
    JointTrajectory::Point point;
    point.time_s = time_s;
    for (std::size_t j = 0; j < trajectory.names.size(); ++j) {
      point.positions.push_back(random.uniform(-1.0, 1.0));
      point.velocities.push_back(random.uniform(-1.0, 1.0));
      if (with_accelerations) point.accelerations.push_back(random.uniform(-2.0, 2.0));
    }
    trajectory.points.push_back(point);
  }
  return trajectory;
}

TEST_F(JointTrajectoryTest, SplinesAreFollowedWithinTolerance) {
  Random random(1);
  for (const bool with_accelerations : {false, true}) {
    for (const double tolerance : {1e-2, 1e-3}) {
      double most = 0.0;
      for (int i = 0; i < 40; ++i) {
        const JointTrajectory trajectory = randomTrajectory(random, with_accelerations);
        const JointPath path = pathOf(trajectory, tolerance);
        for (std::size_t j = 0; j < trajectory.names.size(); ++j) {
          const auto joint_at = [&](double t) { return at(path, trajectory.names[j], t); };
          const double error = largestError(trajectory, j, joint_at, with_accelerations);
          EXPECT_LE(error, tolerance) << i << ", with accelerations: " << with_accelerations;
          most = std::max(most, error);
        }
        for (const JointTrajectory::Point& point : trajectory.points) {
          EXPECT_NEAR(at(path, "lift", point.time_s), point.positions[1], 1e-9);
        }
      }
      EXPECT_GT(most, 0.05 * tolerance) << "no more pieces than need be";
    }
  }
}

/// 0 to 1 in 1 s, at rest at both ends: 3 t^2 - 2 t^3, and 10 t^3 - 15 t^4 + 6 t^5.
TEST_F(JointTrajectoryTest, RestToRestIsTheCubicOrQuinticOnPaper) {
  JointTrajectory trajectory{{"turn"}, {{0.0, {0.0}, {0.0}, {}}, {1.0, {1.0}, {0.0}, {}}}};
  const JointPath cubic = pathOf(trajectory);
  EXPECT_NEAR(at(cubic, "turn", 0.25), 0.15625, kTolerance);
  EXPECT_NEAR(at(cubic, "turn", 0.5), 0.5, kTolerance);
  trajectory.points[0].accelerations = {0.0};
  EXPECT_NEAR(at(pathOf(trajectory), "turn", 0.25), 0.15625, kTolerance)
      << "accelerations at one end alone count for nothing";
  trajectory.points[1].accelerations = {0.0};
  EXPECT_NEAR(at(pathOf(trajectory), "turn", 0.25), 0.103515625, kTolerance);
}

/// It swings out to 0.25 and back: 4 t (1 - t)^2 has its peak of 0.59 at a third of the way.
TEST_F(JointTrajectoryTest, ASplineThatSwingsOutBetweenEqualPointsIsSeenToDoSo) {
  const JointPath path = pathOf({{"turn"}, {{0.0, {0.0}, {4.0}, {}}, {1.0, {0.0}, {0.0}, {}}}});
  EXPECT_NEAR(at(path, "turn", 1.0 / 3.0), 16.0 / 27.0, kTolerance);
  Positions travel;
  path.travelUntil(1.0, travel);
  EXPECT_NEAR(travel[variable("turn")], 32.0 / 27.0, 5.0 * kTolerance);
}

/// A wide and slow swing, as of a whole arm.
TEST_F(JointTrajectoryTest, WideSplinesAreFollowedWithinTolerance) {
  for (const double tolerance : {1e-3, 5e-4}) {
    for (const bool with_accelerations : {false, true}) {
      JointTrajectory trajectory{{"spin"},
                                 {{0.0, {0.0}, {0.0}, {0.0}}, {8.0, {6.2}, {0.0}, {0.0}}}};
      from_[variable("spin")] = 0.0;
      if (!with_accelerations) trajectory.points[0].accelerations.clear();
      const JointPath path = pathOf(trajectory, tolerance);
      const auto joint_at = [&](double t) { return at(path, "spin", t); };
      EXPECT_LE(largestError(trajectory, 0, joint_at, with_accelerations), tolerance)
          << tolerance << ", with accelerations: " << with_accelerations;
    }
  }
}

}  // namespace
}  // namespace tccm
