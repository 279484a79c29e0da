#include "map/appearances.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "map/mapper.h"
#include "support/random.h"
#include "support/small_map.h"

namespace tccm {
namespace {

using test::Random;

constexpr double kFrame = 1.0 / 30.0;  // [s]

struct Ball {
  Vector3 centre;
  double radius = 0.08;
  bool is_robot = false;
};

/// A camera that looks along y, and slantwise down, at a wall and a table.
class AppearancesTest : public ::testing::Test {
 protected:
  AppearancesTest() {
    config_.window_s = 0.3;
    config_.map.returns_max = 1000000;
    remake();
  }
  void remake() { mapper_ = std::make_unique<Mapper>(config_); }

  /// One frame of what stands there. @return the snapshot after it.
  const CuboidMap& see(const std::vector<Ball>& balls) {
    ScanReturns frame;
    frame.stamp = Time(fromSeconds(now_ += frame_s_));
    frame.viewpoint = kEye;
    frame.is_whole = is_whole_;
    for (double up = -0.75; up < 0.15; up += 0.01) {
      for (double aside = -0.5; aside < 0.5; aside += 0.01) {
        const Vector3 direction = Vector3(std::tan(aside), 1.0, std::tan(up)).normalized();
        double range = 1.9 / direction.y();  // the wall
        if (direction.z() < 0.0) range = std::min(range, (kTable - kEye.z()) / direction.z());
        bool is_robot = false;
        for (const Ball& ball : balls) {
          const double along = (ball.centre - kEye).dot(direction);
          const double aside_squared = (ball.centre - kEye).squaredNorm() - along * along;
          const double within = ball.radius * ball.radius - aside_squared;
          if (within < 0.0 || along - std::sqrt(within) >= range) continue;
          range = along - std::sqrt(within);
          is_robot = ball.is_robot;
        }
        range += noise_(engine_);
        const Vector3 end = kEye + range * direction;
        frame.looks.push_back({kEye, end, is_robot ? Seen::kRobot : Seen::kSurface});
        if (!is_robot) frame.points.push_back(end);
      }
    }
    EXPECT_EQ(mapper_->add(frame).dropped, "");
    mapper_->snapshot(map_);
    std::size_t appeared = 0;
    for (const Cuboid& cuboid : map_.cuboids) appeared += cuboid.appeared ? 1 : 0;
    EXPECT_EQ(map_.appeared, appeared);
    return map_;
  }
  void see(const std::vector<Ball>& balls, int frames) {
    for (int i = 0; i < frames; ++i) see(balls);
  }
  /// Of the cuboids near a ball, and of all that its way does not come near to, how many have
  /// appeared.
  struct Shares {
    std::size_t of_ball = 0, on_ball = 0, of_others = 0;
  };
  [[nodiscard]] Shares sharesOf(const Ball& ball, const Vector3& from) const {
    Shares shares;
    for (const Cuboid& cuboid : map_.cuboids) {
      const auto isNear = [&](const Vector3& centre) {
        return map_.box(cuboid).exteriorDistance(centre) < ball.radius + 0.04;
      };
      const bool is_near = isNear(ball.centre);
      bool is_near_way = is_near;
      for (double share = 0.0; share < 1.0; share += 0.02) {
        is_near_way = is_near_way || isNear(from + share * (ball.centre - from));
      }
      shares.on_ball += is_near ? 1 : 0;
      shares.of_ball += is_near && cuboid.appeared ? 1 : 0;
      shares.of_others += !is_near_way && cuboid.appeared ? 1 : 0;
    }
    return shares;
  }
  [[nodiscard]] Shares sharesOf(const Ball& ball) const { return sharesOf(ball, ball.centre); }
  /// The same of a ball that goes along a line, at its end.
  Shares moved(const Vector3& from, const Vector3& velocity, int frames) {
    Ball ball{from};
    for (int i = 0; i < frames; ++i, ball.centre += kFrame * velocity) see({ball});
    ball.centre -= kFrame * velocity;
    return sharesOf(ball, from);
  }

  const Vector3 kEye{0.75, -0.95, 1.0};
  static constexpr double kTable = 0.5;
  Mapper::Config config_;
  std::unique_ptr<Mapper> mapper_;
  CuboidMap map_;
  bool is_whole_ = true;
  double now_ = 10.0, frame_s_ = kFrame;  // [s]
  std::mt19937 engine_{1};
  std::normal_distribution<double> noise_{0.0, 0.004};
};

TEST_F(AppearancesTest, WhatComesIntoSightHasAppearedAndNothingElseHas) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    Random random(seed);
    remake();
    see({}, 20);
    EXPECT_EQ(map_.appeared, 0U) << seed;
    const double speed = random.uniform(0.5, 1.6);
    const int frames = static_cast<int>(0.4 / (speed * kFrame));
    const double side = random.chance(0.5) ? 1.0 : -1.0;
    const Vector3 from(0.75 + 0.4 * side, random.uniform(-0.1, 0.4), random.uniform(0.7, 0.9));
    const Vector3 towards = Vector3(-side, random.uniform(-0.3, 0.3), random.uniform(-0.2, 0.2));
    const Shares shares = moved(from, speed * towards.normalized(), frames);
    ASSERT_GT(shares.on_ball, 10U) << seed;
    EXPECT_GT(shares.of_ball, shares.on_ball / 3) << seed << ", " << speed << " m/s";
    EXPECT_EQ(shares.of_others, 0U) << seed;
    see({}, 12);
    EXPECT_EQ(map_.appeared, 0U) << seed << ": what it had hidden was there before";
  }
}

TEST_F(AppearancesTest, AThingThatComesInFromOutsideTheAreaHasAppeared) {
  see({}, 20);
  // The area ends at x = 1.5.
  const Shares shares = moved({1.75, 0.4, 0.8}, {-1.0, 0.0, 0.0}, 16);
  ASSERT_GT(shares.on_ball, 10U);
  EXPECT_GT(shares.of_ball, shares.on_ball / 4);
}

TEST_F(AppearancesTest, WhatStaysIsNoNewsAfterAWhile) {
  config_.appearances.lasts_s = 0.5;
  remake();
  see({}, 20);
  const Ball ball{{0.75, 0.2, 0.8}};
  see({ball}, 3);
  EXPECT_GT(sharesOf(ball).of_ball, 10U);
  see({ball}, 10);
  EXPECT_GT(sharesOf(ball).of_ball, 10U);
  see({ball}, 5);
  EXPECT_EQ(map_.appeared, 0U);
  see({}, 40);
  see({ball});
  EXPECT_GT(sharesOf(ball).of_ball, 0U) << "it comes again";
}

TEST_F(AppearancesTest, WhatWasThereFromTheFirstLookOnHasNot) {
  const Ball ball{{0.75, 0.2, 0.8}};
  for (int i = 0; i < 40; ++i) EXPECT_EQ(see({ball}).appeared, 0U) << i;
}

TEST_F(AppearancesTest, WhatTheRobotHidHasNot) {
  for (unsigned seed = 0; seed < 10; ++seed) {
    Random random(seed);
    remake();
    const Ball ball{{0.75, 0.4, 0.8}};
    const double speed = random.uniform(0.2, 1.0), side = random.chance(0.5) ? 1.0 : -1.0;
    Ball robot{{0.75, 0.1, 0.85}, 0.25, true};
    see({robot, ball}, 20);
    for (int i = 0; i < 40; ++i) {
      robot.centre.x() += side * speed * kFrame;
      EXPECT_EQ(see({robot, ball}).appeared, 0U) << seed << ", " << i;
    }
    EXPECT_GT(sharesOf(ball).on_ball, 10U);
  }
}

TEST_F(AppearancesTest, OutlinesAndNoisySurfacesHaveNot) {
  for (const double noise : {0.004, 0.008}) {
    noise_ = std::normal_distribution<double>(0.0, noise);
    remake();
    Random random(3);
    see({{{0.75, 0.3, 0.8}}}, 5);
    for (int i = 0; i < 200; ++i) {
      // An outline wavers by a centimetre.
      see({{{0.75, 0.3, 0.8}, 0.08 + random.uniform(-0.005, 0.005)}});
      EXPECT_EQ(map_.appeared, 0U) << i;
    }
  }
}

TEST_F(AppearancesTest, WhatCameWhileNobodyLookedHasNot) {
  const Ball ball{{0.75, 0.2, 0.8}};
  see({}, 20);
  now_ += 5.0;
  for (int i = 0; i < 20; ++i) EXPECT_EQ(see({ball}).appeared, 0U) << i;
  EXPECT_GT(sharesOf(ball).on_ball, 10U);
}

TEST_F(AppearancesTest, ASlowSensorTellsAsWell) {
  frame_s_ = 0.4;
  see({}, 5);
  const Ball ball{{0.75, 0.2, 0.8}};
  see({ball});
  EXPECT_GT(sharesOf(ball).of_ball, 10U);
}

TEST_F(AppearancesTest, ALaserTellsNothingOfIt) {
  is_whole_ = false;
  see({}, 20);
  EXPECT_EQ(moved({1.1, 0.2, 0.8}, {-1.0, 0.0, 0.0}, 12).of_ball, 0U);
}

TEST_F(AppearancesTest, ZeroIsNoneAndAMapThatBeginsAnewKnowsNothing) {
  config_.appearances.lasts_s = 0.0;
  remake();
  see({}, 20);
  EXPECT_EQ(moved({1.1, 0.2, 0.8}, {-1.0, 0.0, 0.0}, 12).of_ball, 0U);
  config_.appearances.lasts_s = 1.0;
  remake();
  see({}, 20);
  EXPECT_GT(moved({1.1, 0.2, 0.8}, {-1.0, 0.0, 0.0}, 6).of_ball, 0U);
  mapper_->clear();
  for (int i = 0; i < 6; ++i) EXPECT_EQ(see({{{0.9, 0.2, 0.8}}}).appeared, 0U) << i;
}

}  // namespace
}  // namespace tccm
