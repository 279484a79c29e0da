#include "goal_path.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>

namespace tccm::example {
namespace {

using trajectory_msgs::JointTrajectory;
using Point = trajectory_msgs::JointTrajectoryPoint;

const std::map<std::string, double> kHere = {{"a", 0.0}, {"b", 1.0}, {"other", 9.0}};
constexpr double kTolerance = 0.01;

Point point(double seconds, const std::vector<double>& positions,
            const std::vector<double>& velocities = {}) {
  Point result;
  result.time_from_start = ros::Duration(seconds);
  result.positions = positions;
  result.velocities = velocities;
  return result;
}

JointTrajectory trajectory(const std::vector<Point>& points) {
  JointTrajectory result;
  result.joint_names = {"a", "b"};
  result.points = points;
  return result;
}

GoalPath path(const std::vector<Point>& points) {
  return GoalPath(trajectory(points), kHere, kTolerance);
}

/// A point a second.
GoalPath randomPath(std::mt19937& random, int points, bool cubic) {
  std::uniform_real_distribution<double> value(-1.0, 1.0);
  std::vector<Point> way;
  for (int i = 1; i <= points; ++i) {
    const std::vector<double> positions{value(random), value(random)};
    const std::vector<double> velocities{value(random), value(random)};
    way.push_back(point(i, positions, cubic ? velocities : std::vector<double>{}));
  }
  return path(way);
}

TEST(GoalPathTest, GoesStraightFromWhereTheJointsAre) {
  const GoalPath way = path({point(2.0, {1.0, 1.0}), point(4.0, {1.0, 3.0})});
  EXPECT_EQ(way.duration(), 4.0);
  EXPECT_EQ(way.at(0.0).positions, (std::vector<double>{0.0, 1.0}));
  EXPECT_EQ(way.at(1.0).positions, (std::vector<double>{0.5, 1.0}));
  EXPECT_EQ(way.at(1.0).velocities, (std::vector<double>{0.5, 0.0}));
  EXPECT_EQ(way.at(3.0).positions, (std::vector<double>{1.0, 2.0}));
}

TEST(GoalPathTest, BeyondItsEndItRests) {
  const GoalPath way = path({point(2.0, {1.0, 1.0})});
  for (const double time : {2.0, 100.0}) {
    EXPECT_EQ(way.at(time).positions, (std::vector<double>{1.0, 1.0}));
    EXPECT_EQ(way.at(time).velocities, (std::vector<double>{0.0, 0.0}));
  }
}

TEST(GoalPathTest, IsTheCubicThatItsPointsLieOn) {
  const auto cubic = [](double t) { return 0.1 * t * t * t - 0.3 * t * t; };
  const auto slope = [](double t) { return 0.3 * t * t - 0.6 * t; };
  const GoalPath way = path({point(1.5, {cubic(1.5), 1.0}, {slope(1.5), 0.0}),
                             point(3.0, {cubic(3.0), 1.0}, {slope(3.0), 0.0})});
  for (double t = 0.0; t < 3.0; t += 0.1) {
    EXPECT_NEAR(way.at(t).positions[0], cubic(t), 1e-12);
    EXPECT_NEAR(way.at(t).velocities[0], slope(t), 1e-12);
    EXPECT_NEAR(way.at(t).positions[1], 1.0, 1e-12);
  }
}

TEST(GoalPathTest, VelocitiesAreTheDerivativesOfPositions) {
  std::mt19937 random(1);
  for (const bool cubic : {false, true}) {
    const GoalPath way = randomPath(random, 5, cubic);
    for (double t = 0.05; t < 5.0; t += 0.1) {
      constexpr double kStep = 1e-6;
      for (const std::size_t j : {0, 1}) {
        const double rise = way.at(t + kStep).positions[j] - way.at(t - kStep).positions[j];
        EXPECT_NEAR(way.at(t).velocities[j], rise / (2.0 * kStep), 1e-6);
      }
    }
  }
}

TEST(GoalPathTest, APointWithoutVelocitiesMakesTheWholeWayStraight) {
  const GoalPath way = path({point(1.0, {1.0, 1.0}, {5.0, 5.0}), point(2.0, {2.0, 1.0})});
  EXPECT_EQ(way.at(0.5).positions, (std::vector<double>{0.5, 1.0}));
  for (const Point& part : way.whole().points) EXPECT_TRUE(part.velocities.empty());
}

TEST(GoalPathTest, WhatIsLeftIsTheSameWayAtItsScale) {
  std::mt19937 random(2);
  for (const bool cubic : {false, true}) {
    const GoalPath way = randomPath(random, 4, cubic);
    for (const double begin : {0.0, 0.7, 2.0, 3.9}) {
      for (const double scale : {1.0, 0.25}) {
        const JointTrajectory rest = way.rest(begin, scale);
        EXPECT_TRUE(rest.points.front().time_from_start.isZero());
        const auto& start = rest.points.front().positions;
        const GoalPath again(rest, {{"a", start[0]}, {"b", start[1]}}, 1e-9);
        EXPECT_NEAR(again.duration(), (way.duration() - begin) / scale, 1e-6);
        for (double t = begin; t < 4.0; t += 0.05) {
          const Point expected = way.at(t);
          const Point actual = again.at((t - begin) / scale);
          EXPECT_NEAR(actual.positions[0], expected.positions[0], 1e-6);
          EXPECT_NEAR(actual.velocities[1], scale * expected.velocities[1], 1e-6);
        }
      }
    }
  }
}

TEST(GoalPathTest, AFirstPointAtTime0HasToBeWhereTheJointsAre) {
  EXPECT_NO_THROW(path({point(0.0, {0.009, 0.995}), point(1.0, {1.0, 1.0})}));
  EXPECT_THROW(path({point(0.0, {0.02, 1.0}), point(1.0, {1.0, 1.0})}), std::invalid_argument);
}

TEST(GoalPathTest, WhatCannotBeFollowedIsRefused) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(path({}), std::invalid_argument);
  EXPECT_THROW(path({point(1.0, {1.0})}), std::invalid_argument);
  EXPECT_THROW(path({point(1.0, {1.0, 1.0}, {1.0})}), std::invalid_argument);
  EXPECT_THROW(path({point(1.0, {1.0, nan})}), std::invalid_argument);
  EXPECT_THROW(path({point(1.0, {1.0, 1.0}, {0.0, nan})}), std::invalid_argument);
  EXPECT_THROW(path({point(-1.0, {1.0, 1.0})}), std::invalid_argument);
  EXPECT_THROW(path({point(1.0, {1.0, 1.0}), point(1.0, {2.0, 1.0})}), std::invalid_argument);
  JointTrajectory twice = trajectory({point(1.0, {1.0, 1.0})});
  twice.joint_names = {"a", "a"};
  EXPECT_THROW(GoalPath(twice, kHere, kTolerance), std::invalid_argument);
  twice.joint_names = {"a", "unheard"};
  EXPECT_THROW(GoalPath(twice, kHere, kTolerance), std::invalid_argument);
  EXPECT_THROW(GoalPath(trajectory({point(1.0, {1.0, 1.0})}), {{"a", 0.0}, {"b", nan}}, kTolerance),
               std::invalid_argument);
}

}  // namespace
}  // namespace tccm::example
