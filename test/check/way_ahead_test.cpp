#include "check/way_ahead.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/checked_robot.h"
#include "support/cuboid_scene.h"
#include "support/tiny_robot.h"

namespace tccm {
namespace {

using namespace test::urdf_text;
using test::addBlock;

constexpr double kPadding = 0.04;
const std::vector<Pose> kAtOrigin{Pose::Identity()};

/// Stops what touches within 0.3 s and half the braking time at 2 m/s^2.
Halting halting(double delay_s) { return {1.0, 0.3, 0.1, delay_s, {2.0, 0.0}}; }

/// The slider robot: padded, its hand reaches 90 mm around (slide, 0, 0.5).
class WayAheadTest : public ::testing::Test {
 protected:
  WayAheadTest() {
    CollisionCheck::Config collision;
    collision.support_points = 1;
    robot_ = test::checked(model_, LinkUse({1.0, kPadding}), collision);
  }

  /// Along a way of the hand through such places, evenly over that time.
  void look(const std::vector<double>& places, double delay_s, double margin_max_m = 0.1,
            double over_s = 1.0) {
    JointPath path(2);
    for (std::size_t i = 0; i < places.size(); ++i) {
      std::vector<double> positions(2, 0.0);
      positions[model_->variables()[0].name == "slide" ? 0 : 1] = places[i];
      path.add(over_s * static_cast<double>(i) / static_cast<double>(places.size() - 1), positions);
    }
    ahead_ = std::make_unique<WayAhead>(robot_, 0.02, margin_max_m);
    PoseCheck here(robot_, 1.5);
    std::vector<double> positions;
    path.positionsAt(0.0, positions);
    here.place(positions, kAtOrigin);
    PoseFindings findings;
    here.findContacts(map_, findings);
    ahead_->begin(halting(delay_s), findings.contacts, here.posture(), 1'000'000);
    EXPECT_TRUE(ahead_->lookAlong({map_, path, kAtOrigin}));
  }

  std::shared_ptr<const RobotModel> model_ = test::sliderModel();
  std::shared_ptr<CheckedRobot> robot_;
  CuboidMap map_ = test::emptyMap();
  std::unique_ptr<WayAhead> ahead_;
};

TEST_F(WayAheadTest, WhatTouchesIsFoundWithinAFewMillimetres) {
  addBlock(map_, {Vector3(0.5, -0.2, 0.3), Vector3(0.6, 0.2, 0.7)});
  look({0.0, 0.8}, 0.0);
  ASSERT_TRUE(ahead_->touch());
  EXPECT_NEAR(ahead_->touch()->contact.time_s, 0.41 / 0.8, 0.003 / 0.8);
  EXPECT_GE(ahead_->touch()->contact.time_s, 0.41 / 0.8 - 1e-6);
  EXPECT_NEAR(ahead_->touch()->contact.distance_m, 0.41, 0.01);
  EXPECT_FALSE(ahead_->touch()->stops) << "it halts within 0.5 s";
  EXPECT_FALSE(ahead_->margin());
}

TEST_F(WayAheadTest, InFreeSpaceAFewPlacesAreEnough) {
  look({0.0, 0.8}, 0.05);
  EXPECT_FALSE(ahead_->touch() || ahead_->margin());
  EXPECT_LE(ahead_->poses(), 10U);
}

TEST_F(WayAheadTest, AWayThatIsTooLongToBeLookedAtSaysSo) {
  look({0.0, 40.0}, 0.0, 0.1, 2.0);
  EXPECT_FALSE(ahead_->isTooLong()) << "200 places, a fifth of a metre apart";
  for (const double metres : {60.0, 1e3, 1e6, 1e12}) {
    look({0.0, metres}, 0.0, 0.1, 2.0);
    EXPECT_TRUE(ahead_->isTooLong()) << metres;
  }
}

TEST_F(WayAheadTest, ThereAndBackIsFollowedToItsTurn) {
  addBlock(map_, {Vector3(0.5, -0.2, 0.3), Vector3(0.6, 0.2, 0.7)});
  look({0.0, 0.44, 0.0}, 0.0);
  ASSERT_TRUE(ahead_->touch());
  EXPECT_NEAR(ahead_->touch()->contact.time_s, 0.5 * 0.41 / 0.44, 0.004);
}

/// The wall begins 120 or 140 mm beside the hand's middle.
TEST_F(WayAheadTest, AMarginForItsSpeedMakesALinkLarger) {
  const auto comesNear = [this](double y, double delay_s, double most_m = 0.1) {
    map_ = test::emptyMap();
    addBlock(map_, {Vector3(0.0, y, 0.3), Vector3(1.0, y + 0.1, 0.7)});
    look({0.0, 0.4}, delay_s, most_m);
    EXPECT_FALSE(ahead_->touch());
    return ahead_->margin().has_value();
  };
  EXPECT_TRUE(comesNear(0.12, 0.1)) << "0.4 m/s for 0.1 s are 40 mm";
  EXPECT_EQ(ahead_->margin()->scale, 0.1);
  EXPECT_FALSE(comesNear(0.14, 0.1));
  EXPECT_FALSE(comesNear(0.12, 0.07)) << "28 mm";
  EXPECT_TRUE(comesNear(0.14, 0.8, 0.06));
  EXPECT_FALSE(comesNear(0.16, 0.8, 0.06)) << "no more than the most";
  EXPECT_FALSE(comesNear(0.12, 0.0));
}

TEST_F(WayAheadTest, AMarginThatIsAheadCountsAsATouchAfterTheDelay) {
  addBlock(map_, {Vector3(0.5, -0.2, 0.3), Vector3(0.6, 0.2, 0.7)});
  look({0.0, 0.5}, 0.02);
  ASSERT_TRUE(ahead_->touch() && ahead_->margin());
  EXPECT_NEAR(ahead_->margin()->contact.time_s, ahead_->touch()->contact.time_s - 0.02, 0.01);
  EXPECT_NEAR(ahead_->margin()->scale, ahead_->touch()->scale, 0.02);
}

TEST_F(WayAheadTest, WhatTouchesNowIsNotAheadUntilItWasLeft) {
  addBlock(map_, {Vector3(0.5, -0.2, 0.3), Vector3(0.6, 0.2, 0.7)});
  look({0.42, 0.0}, 0.0);
  EXPECT_FALSE(ahead_->touch());
  look({0.42, 0.2, 0.42}, 0.0);
  ASSERT_TRUE(ahead_->touch()) << "it comes back";
  EXPECT_NEAR(ahead_->touch()->contact.time_s, 0.98, 0.02);
}

TEST_F(WayAheadTest, AWayThatEndsBeforeHaltingDoesNotCount) {
  JointPath path(2);
  path.add(0.0, {0.0, 0.0});
  path.add(0.5, {2.0, 2.0});
  PoseCheck here(robot_, 1.5);
  here.place({0.0, 0.0}, kAtOrigin);
  ahead_ = std::make_unique<WayAhead>(robot_, 0.02, 0.1);
  ahead_->begin({0.5, 0.3, 0.1, 0.02, 2.0}, {}, here.posture(), 1'000'000);
  EXPECT_FALSE(ahead_->lookAlong({map_, path, kAtOrigin})) << "4 m/s: 1.02 s";
}

double speedOf(const std::string& urdf, const JointPath& path, double horizon_s) {
  const auto robot = test::checked(test::modelOf(urdf), LinkUse({1.0, 0.0}), {});
  WaySpeeds speeds(robot);
  const CuboidMap map = test::emptyMap();
  speeds.find({map, path, kAtOrigin}, {horizon_s, 0.3, 0.1, 0.0, 2.0});
  return speeds.of(0);
}

TEST(WaySpeedsTest, WhatTurnsIsAsFastAsItsOutermostPointHoweverOftenItTurns) {
  const std::string urdf =
      robotOf(linkOf("base") + linkOf("arm", collisionOf("<box size=\"0.8 0.1 0.1\"/>")) +
              jointOf("turn", "continuous", "base", "arm", axisOf("0 0 1")));
  const double radius = std::sqrt(0.4 * 0.4 + 2 * 0.05 * 0.05);
  for (const double rate : {0.01, 1.0, 16.0 * M_PI, 90.0}) {
    JointPath path(1);
    path.add(0.0, {0.0});
    path.add(0.5, {0.5 * rate});
    EXPECT_NEAR(speedOf(urdf, path, 0.5), rate * radius, 1e-6 * rate);
  }
}

TEST(WaySpeedsTest, TheFastestPartOfTheWayCounts) {
  JointPath path(1);
  path.add(0.0, {0.0});
  path.add(0.2, {0.02});
  path.add(0.22, {0.05});
  path.add(0.5, {0.06});
  const std::string urdf =
      robotOf(linkOf("base") + ballLink("hand") +
              jointOf("slide", "prismatic", "base", "hand", axisOf("1 0 0") + limitOf("-1", "1")));
  EXPECT_NEAR(speedOf(urdf, path, 0.5), 1.5, 1e-6);
  EXPECT_NEAR(speedOf(urdf, path, 0.1), 0.1, 1e-6) << "as far as is looked along";
}

}  // namespace
}  // namespace tccm
