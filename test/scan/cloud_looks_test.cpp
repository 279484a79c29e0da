#include "scan/cloud_looks.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/near.h"
#include "support/random.h"

namespace tccm {
namespace {

using test::isNearly;
using test::Random;

/// A camera of 64 x 48 that looks at a wall, or such points loosely.
struct View {
  Cloud cloud;
  CloudState state;
  std::vector<CloudPlace> places{CloudPlace()};

  [[nodiscard]] std::vector<Look> looks(CloudLooks& taker) const {
    std::vector<Look> looks;
    taker.take(
        cloud, state, places, [](std::size_t) { return std::size_t{0}; }, looks);
    return looks;
  }
};

constexpr float kPixel = 1.0F / 550.0F;

View wall(bool organised, float away = 2.0F) {
  View view;
  view.cloud.width = organised ? 64 : 64 * 48;
  view.cloud.height = organised ? 48 : 1;
  for (int row = 0; row < 48; ++row) {
    for (int column = 0; column < 64; ++column) {
      const Eigen::Vector3f d(kPixel * static_cast<float>(column - 32),
                              kPixel * static_cast<float>(row - 24), 1.0F);
      view.cloud.points.push_back(away * d);
      view.state.ranges.push_back(view.cloud.points.back().norm());
      view.state.kinds.push_back(BeamKind::kReturn);
    }
  }
  return view;
}

void forget(View& view, std::size_t i) {
  view.cloud.points[i].setConstant(std::nanf(""));
  view.state.ranges[i] = 0.0F;
  view.state.kinds[i] = BeamKind::kUnknown;
}

TEST(CloudLooksTest, AWallIsSeenByOneLookForEachBlock) {
  for (const bool organised : {true, false}) {
    CloudLooks taker{{}};
    const auto looks = wall(organised).looks(taker);
    EXPECT_GE(looks.size(), 20U);
    EXPECT_LE(looks.size(), 60U);  // 3072 points
    for (const Look& look : looks) {
      EXPECT_EQ(look.what, Seen::kSurface);
      EXPECT_NEAR(look.end.z(), 2.0, 0.02);
      EXPECT_TRUE(isNearly(look.viewpoint, Vector3::Zero(), 0.0));
    }
  }
}

TEST(CloudLooksTest, TheNearestRangeOfABlockTellsHowFarWasSeen) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    Random random(seed);
    View view = wall(random.chance(0.5));
    const auto i = static_cast<std::size_t>(random.integer(0, 64 * 48 - 1));
    const Eigen::Vector3f direction = view.cloud.points[i].normalized();
    view.cloud.points[i] = direction;
    view.state.ranges[i] = 1.0F;
    // Also one that a filter took: where it ended nothing is known.
    if (random.chance(0.5)) view.state.kinds[i] = BeamKind::kMixedPixel;
    CloudLooks taker{{}};
    std::size_t near = 0;
    for (const Look& look : view.looks(taker)) {
      if (look.end.norm() > 1.5) continue;
      ++near;
      EXPECT_NEAR(look.end.norm(), 1.0, 1e-5);
      EXPECT_LE(std::acos(look.end.normalized().dot(direction.cast<double>())), 0.0175) << seed;
    }
    EXPECT_EQ(near, 1U) << seed;
  }
}

TEST(CloudLooksTest, OnePointOfTheRobotMakesABlockALookAtTheRobot) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    Random random(seed);
    View view = wall(random.chance(0.5));
    view.state.kinds[static_cast<std::size_t>(random.integer(0, 64 * 48 - 1))] = BeamKind::kSelf;
    CloudLooks taker{{}};
    std::size_t robot = 0;
    for (const Look& look : view.looks(taker)) robot += look.what == Seen::kRobot ? 1 : 0;
    EXPECT_EQ(robot, 1U) << seed;
  }
}

TEST(CloudLooksTest, WhatWasNotMeasuredIsUnclearInItsOldDirection) {
  View view = wall(true);
  CloudLooks taker{{}};
  const std::size_t looks = view.looks(taker).size();
  for (std::size_t i = 0; i < view.cloud.points.size(); ++i) {
    if (i % 64 < 32) forget(view, i);
  }
  std::size_t unclear = 0;
  const auto now = view.looks(taker);
  EXPECT_EQ(now.size(), looks);
  for (const Look& look : now) {
    unclear += look.what == Seen::kUnclear ? 1 : 0;
    EXPECT_EQ(look.what == Seen::kUnclear, look.end.x() < 0.0);
  }
  EXPECT_GE(unclear, looks / 3);
}

TEST(CloudLooksTest, ABlockThatIsMostlyFilteredOutIsUnclear) {
  for (const BeamKind kind : {BeamKind::kMixedPixel, BeamKind::kShadow, BeamKind::kTooClose}) {
    for (const bool organised : {true, false}) {
      View view = wall(organised);
      for (BeamKind& of : view.state.kinds) of = kind;
      CloudLooks taker{{}};
      for (const Look& look : view.looks(taker)) EXPECT_EQ(look.what, Seen::kUnclear);
    }
  }
}

TEST(CloudLooksTest, NoLookReachesFurtherThanTheNearestPointAround) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    Random random(seed);
    View view = wall(random.chance(0.5));
    for (std::size_t i = 0; i < view.cloud.points.size(); ++i) {
      const float away = static_cast<float>(random.uniform(0.5, 3.0));
      view.cloud.points[i] *= away / view.state.ranges[i];
      view.state.ranges[i] = away;
      if (random.chance(0.1)) forget(view, i);
    }
    CloudLooks taker{{}};
    for (const Look& look : view.looks(taker)) {
      if (look.what != Seen::kSurface) continue;
      for (std::size_t i = 0; i < view.cloud.points.size(); ++i) {
        if (view.state.ranges[i] == 0.0F) continue;
        const Vector3 p = view.cloud.points[i].cast<double>();
        const bool same_direction = p.normalized().dot(look.end.normalized()) > std::cos(0.002);
        if (!same_direction) continue;
        EXPECT_LE(look.end.norm(), p.norm() + 1e-5) << seed;
      }
    }
  }
}

}  // namespace
}  // namespace tccm
