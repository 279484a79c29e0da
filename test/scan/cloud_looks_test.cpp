#include "scan/cloud_looks.h"

#include <gtest/gtest.h>

#include <algorithm>
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

/// At 2 m. @param across, down between neighbours [rad].
View wallOf(int width, int height, float across = kPixel, float down = kPixel) {
  View view;
  view.cloud.width = static_cast<std::size_t>(width);
  view.cloud.height = static_cast<std::size_t>(height);
  const int middle_row = height / 2, middle_column = width / 2;
  for (int row = 0; row < height; ++row) {
    for (int column = 0; column < width; ++column) {
      const Eigen::Vector3f d(across * static_cast<float>(column - middle_column),
                              down * static_cast<float>(row - middle_row), 1.0F);
      view.cloud.points.push_back(2.0F * d);
      view.state.ranges.push_back(view.cloud.points.back().norm());
      view.state.kinds.push_back(BeamKind::kReturn);
    }
  }
  return view;
}

View wall(bool organised) {
  View view = wallOf(64, 48);
  if (organised) return view;
  view.cloud.width *= view.cloud.height;
  view.cloud.height = 1;
  return view;
}

/// Of the wall, which lies in blocks of 10 x 10 pixels: those of each block.
std::vector<std::vector<std::size_t>> blocksOfWall() {
  std::vector<std::vector<std::size_t>> blocks(35);  // 7 x 5
  for (std::size_t i = 0; i < 3072; ++i) blocks[i / 64 / 10 * 7 + i % 64 / 10].push_back(i);
  return blocks;
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
    // Also one that a filter took: but no surface is there.
    const bool is_filtered = random.chance(0.5);
    if (is_filtered) view.state.kinds[i] = BeamKind::kMixedPixel;
    CloudLooks taker{{}};
    std::size_t near = 0;
    for (const Look& look : view.looks(taker)) {
      if (look.end.norm() > 1.5) continue;
      ++near;
      EXPECT_NEAR(look.end.norm(), 1.0, 1e-5);
      EXPECT_EQ(look.what, is_filtered ? Seen::kUnclear : Seen::kSurface) << seed;
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

TEST(CloudLooksTest, WhatIsThinnedOutSharesTheFateOfTheRest) {
  for (const BeamKind filtered : {BeamKind::kShadow, BeamKind::kMixedPixel}) {
    for (const bool is_filtered : {false, true}) {
      View view = wall(true);
      for (std::size_t i = 0; i < view.state.kinds.size(); ++i) {
        const bool is_taken = i / 64 % 2 == 0 && i % 2 == 0;
        if (!is_taken) view.state.kinds[i] = BeamKind::kThinned;
        if (is_taken && is_filtered) view.state.kinds[i] = filtered;
      }
      CloudLooks taker{{}};
      const auto looks = view.looks(taker);
      EXPECT_GE(looks.size(), 20U);
      for (const Look& look : looks) {
        EXPECT_EQ(look.what, is_filtered ? Seen::kUnclear : Seen::kSurface);
      }
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

TEST(CloudLooksTest, ABlockIsUnclearWhereMoreThanHalfOfItIsFilteredOutOrUnknown) {
  const auto blocks = blocksOfWall();
  for (unsigned seed = 0; seed < 20; ++seed) {
    Random random(seed);
    View view = wall(true);
    std::vector<std::size_t> lost;
    for (const std::vector<std::size_t>& block : blocks) {
      const int half = static_cast<int>(block.size() / 2);
      lost.push_back(static_cast<std::size_t>(half + random.integer(-1, 1)));
      for (std::size_t k = 0; k < lost.back(); ++k) {
        if (random.chance(0.5)) forget(view, block[k]);
        view.state.kinds[block[k]] = random.chance(0.5) ? BeamKind::kShadow : BeamKind::kMixedPixel;
      }
    }
    CloudLooks taker{{}};
    const auto looks = view.looks(taker);
    ASSERT_EQ(looks.size(), blocks.size());
    for (std::size_t i = 0; i < blocks.size(); ++i) {
      const bool is_unclear = 2 * lost[i] > blocks[i].size();
      EXPECT_EQ(looks[i].what, is_unclear ? Seen::kUnclear : Seen::kSurface) << seed << ", " << i;
      EXPECT_NEAR(looks[i].end.z(), 2.0, 0.02) << "what was not measured is not near";
    }
  }
}

TEST(CloudLooksTest, WhatWasNotMeasuredDoesNotJudgeWhatIsThinnedOut) {
  // Of each four points one was not thinned out, and of these each fourth row was measured.
  View view = wall(true);
  for (std::size_t i = 0; i < view.state.kinds.size(); ++i) {
    const bool is_taken = i / 64 % 2 == 0 && i % 2 == 0;
    if (!is_taken) {
      view.state.kinds[i] = BeamKind::kThinned;
    } else if (i / 64 % 8 != 0) {
      forget(view, i);
    }
  }
  CloudLooks taker{{}};
  const auto looks = view.looks(taker);
  ASSERT_EQ(looks.size(), 35U);
  for (const Look& look : looks) EXPECT_EQ(look.what, Seen::kSurface);
}

TEST(CloudLooksTest, ALookIsFromWhereItsBlocksFirstPointWasMeasured) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    Random random(seed);
    View view = wall(true);
    for (std::size_t i = 0; i < view.cloud.points.size(); ++i) {
      if (random.chance(0.7)) forget(view, i);
    }
    view.places.resize(view.cloud.points.size());
    for (std::size_t i = 0; i < view.places.size(); ++i) {
      view.places[i].T_fixed_sensor.setIdentity();
      view.places[i].T_fixed_sensor.translation().x() = static_cast<double>(i);
    }
    CloudLooks taker{{}};
    std::vector<Look> looks;
    taker.take(
        view.cloud, view.state, view.places, [](std::size_t i) { return i; }, looks);
    const auto blocks = blocksOfWall();
    ASSERT_EQ(looks.size(), blocks.size());
    for (std::size_t b = 0; b < blocks.size(); ++b) {
      const auto first = std::find_if(blocks[b].begin(), blocks[b].end(),
                                      [&](std::size_t i) { return view.state.ranges[i] > 0.0F; });
      ASSERT_NE(first, blocks[b].end());
      EXPECT_EQ(looks[b].viewpoint.x(), static_cast<double>(*first)) << seed << ", " << b;
    }
  }
}

TEST(CloudLooksTest, OfWhatIsBeyondTheLimitsOfRangeTheDirectionIsKnown) {
  View view = wall(true);
  CloudLooks before{{}};
  const auto seen = view.looks(before);
  for (std::size_t i = 0; i < view.cloud.points.size(); ++i) {
    if (i % 64 >= 20) continue;
    view.state.ranges[i] = 0.0F;
    view.state.kinds[i] = BeamKind::kUnknown;
  }
  CloudLooks taker{{}};
  const auto looks = view.looks(taker);
  ASSERT_EQ(looks.size(), seen.size());
  for (std::size_t i = 0; i < looks.size(); ++i) {
    EXPECT_EQ(looks[i].what, i % 7 < 2 ? Seen::kUnclear : Seen::kSurface) << i;
    EXPECT_TRUE(isNearly(looks[i].end.normalized(), seen[i].end.normalized(), 1e-4)) << i;
  }
}

TEST(CloudLooksTest, WhateverWasSeenBeforeACloudOfAnotherKindIsSeenAsIfItWereTheFirst) {
  Random random(7);
  CloudLooks taker{{}};
  for (int i = 0; i < 60; ++i) {
    View view = random.chance(0.3) ? wall(false)
                                   : wallOf(32 * random.integer(1, 3), 24 * random.integer(1, 3));
    const bool is_dark = random.chance(0.2);
    for (std::size_t k = 0; is_dark && k < view.cloud.points.size(); ++k) forget(view, k);
    CloudLooks fresh{{}};
    const auto looks = view.looks(taker), expected = view.looks(fresh);
    // Of one of the same size the directions are known from before.
    if (is_dark && !looks.empty()) continue;
    ASSERT_EQ(looks.size(), expected.size()) << i;
    for (std::size_t k = 0; k < looks.size(); ++k) {
      EXPECT_TRUE(isNearly(looks[k].end, expected[k].end, 1e-6)) << i;
      EXPECT_EQ(looks[k].what, expected[k].what) << i;
    }
  }
}

TEST(CloudLooksTest, InACloudOfAnotherSizeNoOldDirectionIsLeft) {
  CloudLooks taker{{}};
  EXPECT_FALSE(wall(true).looks(taker).empty());
  View dark = wallOf(80, 48);
  for (std::size_t i = 0; i < dark.cloud.points.size(); ++i) forget(dark, i);
  EXPECT_TRUE(dark.looks(taker).empty());
}

TEST(CloudLooksTest, TheStepIsThatBetweenNeighboursInRowsOrColumnsWhicheverIsLarger) {
  const auto stepOf = [](const View& view) {
    CloudLooks taker{{}};
    taker.begin(view.cloud, view.state);
    return taker.stepRad();
  };
  EXPECT_NEAR(stepOf(wallOf(64, 48, 0.002F, 0.004F)), 0.004F, 1e-4F);
  EXPECT_NEAR(stepOf(wallOf(64, 48, 0.004F, 0.002F)), 0.004F, 1e-4F);
  View narrow = wallOf(2, 60, 0.004F, 0.003F);
  forget(narrow, 0);
  EXPECT_NEAR(stepOf(narrow), 0.004F, 1e-4F) << "from one row's end to the next is no step";
  EXPECT_EQ(stepOf(wallOf(64, 48, 0.002F, 0.03F)), 0.0F) << "a row makes a block";
  EXPECT_EQ(stepOf(wallOf(64, 48, 0.03F, 0.002F)), 0.0F) << "a column makes a block";
  EXPECT_EQ(stepOf(wallOf(7, 7)), 0.0F) << "few neighbours do not tell";
  EXPECT_EQ(stepOf(wall(false)), 0.0F);
}

}  // namespace
}  // namespace tccm
