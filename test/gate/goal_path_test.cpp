#include "gate/goal_path.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "support/random.h"

namespace tccm {
namespace {

using test::Random;

constexpr std::size_t kJoints = 2;

/// Points with velocities, accelerations or neither, as it comes.
JointTrajectory randomWay(Random& random) {
  JointTrajectory way;
  way.names = {"a", "b"};
  const auto values = [&] {
    return std::vector<double>{random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0)};
  };
  double time_s = 0.0;
  const int points = random.integer(2, 6);
  for (int i = 0; i < points; ++i) {
    JointTrajectory::Point point;
    point.time_s = time_s;
    point.positions = values();
    if (random.chance(0.7)) point.velocities = values();
    if (!point.velocities.empty() && random.chance(0.5)) point.accelerations = values();
    way.points.push_back(point);
    time_s += random.uniform(0.2, 2.0);
  }
  return way;
}

GoalPath::Sample sampleAt(const GoalPath& path, double time_s) {
  GoalPath::Sample sample;
  path.at(time_s, sample);
  return sample;
}

TEST(GoalPathTest, MeetsItsPointsAndTheirVelocities) {
  for (unsigned seed = 0; seed < 100; ++seed) {
    Random random(seed);
    const GoalPath path(randomWay(random));
    const auto& points = path.way().points;
    for (std::size_t i = 0; i + 1 < points.size(); ++i) {
      const GoalPath::Sample sample = sampleAt(path, points[i].time_s);
      const bool is_curved = !points[i].velocities.empty() && !points[i + 1].velocities.empty();
      for (std::size_t j = 0; j < kJoints; ++j) {
        EXPECT_NEAR(sample.positions[j], points[i].positions[j], 1e-9);
        if (is_curved) {
          EXPECT_NEAR(sample.velocities[j], points[i].velocities[j], 1e-9);
        }
      }
    }
  }
}

TEST(GoalPathTest, ItsVelocitiesAreHowItsPositionsChange) {
  for (unsigned seed = 0; seed < 100; ++seed) {
    Random random(seed);
    const GoalPath path(randomWay(random));
    for (int i = 0; i < 20; ++i) {
      const double time_s = random.uniform(0.0, path.duration()), dt = 1e-6;
      const auto before = sampleAt(path, time_s - dt), after = sampleAt(path, time_s + dt);
      const auto here = sampleAt(path, time_s);
      bool is_within_a_stretch = time_s > dt && time_s < path.duration() - dt;
      for (const auto& point : path.way().points) {
        is_within_a_stretch = is_within_a_stretch && std::abs(point.time_s - time_s) > dt;
      }
      if (!is_within_a_stretch) continue;
      for (std::size_t j = 0; j < kJoints; ++j) {
        EXPECT_NEAR((after.positions[j] - before.positions[j]) / (2.0 * dt), here.velocities[j],
                    1e-4);
      }
    }
  }
}

TEST(GoalPathTest, BeyondItsEndItRests) {
  Random random(1);
  const GoalPath path(randomWay(random));
  for (const double beyond_s : {0.0, 0.1, 100.0}) {
    const auto sample = sampleAt(path, path.duration() + beyond_s);
    EXPECT_EQ(sample.positions, path.way().points.back().positions);
    EXPECT_EQ(sample.velocities, (std::vector<double>{0.0, 0.0}));
  }
}

TEST(GoalPathTest, WhatIsLeftIsTheSameWayAtItsScaleOfTheSpeed) {
  for (unsigned seed = 0; seed < 200; ++seed) {
    Random random(seed);
    const GoalPath path(randomWay(random));
    const double from_s = random.uniform(0.0, 0.98 * path.duration());
    const double scale = random.uniform(0.05, 1.0);
    const GoalPath rest(path.rest(from_s, scale));
    EXPECT_NEAR(rest.duration(), (path.duration() - from_s) / scale, 1e-9);
    for (int i = 0; i < 20; ++i) {
      const double since_s = random.uniform(0.0, rest.duration());
      const auto expected = sampleAt(path, from_s + scale * since_s);
      const auto found = sampleAt(rest, since_s);
      for (std::size_t j = 0; j < kJoints; ++j) {
        EXPECT_NEAR(found.positions[j], expected.positions[j], 1e-7) << seed;
        EXPECT_NEAR(found.velocities[j], scale * expected.velocities[j], 1e-6) << seed;
      }
    }
  }
}

TEST(GoalPathTest, OfAWayThatIsOverItsEndIsLeft) {
  Random random(2);
  const GoalPath path(randomWay(random));
  const JointTrajectory rest = path.rest(path.duration() + 1.0, 0.5);
  ASSERT_EQ(rest.points.size(), 1U);
  EXPECT_EQ(rest.points[0].time_s, 0.0);
  EXPECT_EQ(rest.points[0].positions, path.way().points.back().positions);
}

}  // namespace
}  // namespace tccm
