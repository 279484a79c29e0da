#include "check/way_check.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "check/pose_check.h"
#include "geometry/overlap.h"
#include "simulation/robot/dual_arm.h"
#include "support/checked_robot.h"
#include "support/checker_fixture.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

using namespace test::urdf_text;
using test::addBlock;
using test::kStart;
using test::Random;

constexpr double kRounding = 1e-9;
constexpr double kPadding = 0.04;
constexpr double kStep = 0.02;

const std::vector<Pose> kAtOrigin{Pose::Identity()};

std::shared_ptr<CheckedRobot> padded(const std::shared_ptr<const RobotModel>& model,
                                     double padding_m = kPadding) {
  CollisionCheck::Config collision;
  collision.support_points = 1;
  return test::checked(model, LinkUse({1.0, padding_m}), collision);
}

/// The slider robot: padded, its balls reach 90 mm around (slide, 0, 0.5) and (glide, 0.5, 0.5).
class WayCheckTest : public ::testing::Test {
 protected:
  /// A way through such places at such times.
  struct Place {
    double time_s, slide, glide;
  };
  [[nodiscard]] JointPath way(const std::vector<Place>& places) const {
    JointPath path(2);
    for (const Place& place : places) {
      std::vector<double> positions(2);
      positions[simulation::variableIndex(*model_, "slide")] = place.slide;
      positions[simulation::variableIndex(*model_, "glide")] = place.glide;
      path.add(place.time_s, positions);
    }
    return path;
  }
  std::optional<WayContact> first(const JointPath& path) {
    return check_.firstContact({map_, path, kAtOrigin}, path.begin(), path.end());
  }
  /// A wall across the way of one of the balls.
  void addWall(double x, double y) {
    addBlock(map_, {Vector3(x, y - 0.2, 0.3), Vector3(x + 0.1, y + 0.2, 0.7)});
  }
  [[nodiscard]] std::string link(const WayContact& contact) const {
    return model_->linkOf(contact.contact.shape);
  }

  std::shared_ptr<const RobotModel> model_ = test::sliderModel();
  CuboidMap map_ = test::emptyMap();
  std::shared_ptr<CheckedRobot> robot_ = padded(model_);
  WayCheck check_{robot_, kStep};
};

TEST_F(WayCheckTest, AWayThatTouchesNothingIsFree) {
  addWall(0.8, 0.0);
  EXPECT_FALSE(first(way({{0.0, 0.0, 0.0}, {1.0, 0.70, 1.2}})));
  EXPECT_FALSE(first(way({{0.0, 0.0, 0.0}}))) << "one point";
}

/// The wall's face is at 0.5 m: the ball touches it from 0.41 m on.
TEST_F(WayCheckTest, TheFirstContactHasItsTimeDistanceShapeAndCuboid) {
  addWall(0.5, 0.0);
  const auto found = first(way({{2.0, 0.0, 0.0}, {3.0, 0.8, 0.0}}));
  ASSERT_TRUE(found);
  EXPECT_GE(found->time_s, 0.41 / 0.8 - kRounding);
  EXPECT_LE(found->time_s, 0.41 / 0.8 + 0.5 * kStep / 0.8 + kRounding) << "from the way's start on";
  EXPECT_EQ(link(*found), "hand");
  const UprightBox cuboid = map_.box(map_.cuboids[found->contact.cuboid]);
  EXPECT_NEAR(cuboid.min().x(), 0.5, kRounding);
  EXPECT_GE(found->distance_m, 0.41 - kRounding);
  EXPECT_LE(found->distance_m, 0.43) << "of that cuboid, which may lie beside the way";
  EXPECT_FALSE(found->by_margin);
}

TEST_F(WayCheckTest, OnlyTheStretchAskedForIsLookedAt) {
  addWall(0.5, 0.0);
  const JointPath path = way({{0.0, 0.0, 0.0}, {1.0, 1.0, 0.0}});
  EXPECT_FALSE(check_.firstContact({map_, path, kAtOrigin}, 0.0, 0.40));
  EXPECT_FALSE(check_.firstContact({map_, path, kAtOrigin}, 0.70, 1.0)) << "beyond it";
  const auto found = check_.firstContact({map_, path, kAtOrigin}, 0.3, 0.6);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->time_s, 0.41 - 0.3, 0.5 * kStep + kRounding);
  EXPECT_NEAR(found->distance_m, 0.41 - 0.3, 0.02) << "from where the stretch begins";
}

TEST_F(WayCheckTest, BothEndsBelongToIt) {
  addWall(0.5, 0.0);
  const auto at_begin = first(way({{0.0, 0.411, 0.0}, {1.0, 0.0, 0.0}}));
  ASSERT_TRUE(at_begin);
  EXPECT_EQ(at_begin->time_s, 0.0);
  EXPECT_EQ(at_begin->distance_m, 0.0);
  const auto at_end = first(way({{0.0, 0.0, 0.0}, {1.0, 0.4101, 0.0}}));
  ASSERT_TRUE(at_end);
  EXPECT_NEAR(at_end->time_s, 1.0, 0.001);
  EXPECT_TRUE(first(way({{0.0, 0.45, 0.0}}))) << "a way of one point is its begin";
}

TEST_F(WayCheckTest, ABeginThatIsKnownToBeFreeIsNotLookedAt) {
  addWall(0.5, 0.0);
  const JointPath path = way({{0.0, 0.411, 0.0}, {1.0, 0.0, 0.0}});
  EXPECT_FALSE(check_.firstContact({map_, path, kAtOrigin}, 0.0, 1.0, false));
  EXPECT_FALSE(check_.firstContact({map_, path, kAtOrigin}, 0.0, 0.0, false));
  EXPECT_TRUE(check_.firstContact({map_, path, kAtOrigin}, 0.0, 0.0, true));
}

TEST_F(WayCheckTest, OfTwoObstaclesTheFirstOnTheWayIsFound) {
  addWall(0.5, 0.0);
  addWall(0.9, 0.0);
  const auto ahead = first(way({{0.0, 0.0, 0.0}, {1.0, 1.0, 0.0}}));
  ASSERT_TRUE(ahead);
  EXPECT_NEAR(ahead->time_s, 0.41, 0.5 * kStep + kRounding);
  const auto back = first(way({{0.0, 1.3, 0.0}, {1.0, 0.3, 0.0}}));
  ASSERT_TRUE(back);
  EXPECT_NEAR(back->time_s, 1.3 - 1.09, 0.5 * kStep + kRounding) << "the wall ends at 1.0 m";
}

TEST_F(WayCheckTest, OfTwoLinksTheOneThatTouchesFirstIsNamed) {
  addWall(0.5, 0.0);
  addWall(0.7, 0.5);
  const auto hand_first = first(way({{0.0, 0.0, 0.0}, {1.0, 1.0, 1.0}}));
  ASSERT_TRUE(hand_first);
  EXPECT_EQ(link(*hand_first), "hand");
  const auto other_first = first(way({{0.0, 0.0, 0.3}, {1.0, 1.0, 1.3}}));
  ASSERT_TRUE(other_first);
  EXPECT_EQ(link(*other_first), "other");
  EXPECT_NEAR(other_first->time_s, 0.61 - 0.3, 0.5 * kStep + kRounding);
}

TEST_F(WayCheckTest, AWayThereAndBackIsFollowedToItsTurn) {
  addWall(0.5, 0.0);
  // It ends where it begins, and is in the wall from 0.41 to 0.44 m only.
  for (const double turn_s : {0.2, 0.5, 0.9}) {
    const auto found = first(way({{0.0, 0.0, 0.0}, {turn_s, 0.44, 0.0}, {1.0, 0.0, 0.0}}));
    ASSERT_TRUE(found) << turn_s;
    EXPECT_NEAR(found->time_s, turn_s, 0.07 * turn_s + 0.01) << "on the way there";
    EXPECT_LE(found->time_s, turn_s + kRounding);
  }
}

TEST_F(WayCheckTest, WhatAJumpPassesCountsAsTouched) {
  addWall(0.5, 0.0);
  EXPECT_TRUE(first(way({{0.0, 0.0, 0.0}, {0.5, 0.0, 0.0}, {0.5, 0.9, 0.0}, {1.0, 0.9, 0.0}})));
  EXPECT_FALSE(first(way({{0.0, 0.0, 0.0}, {0.5, 0.0, 0.0}, {0.5, 0.0, 0.1}, {1.0, 0.0, 0.1}})))
      << "a small one far away";
}

TEST_F(WayCheckTest, TheRootsPoseMovesTheWholeRobot) {
  addWall(0.5, 0.0);
  const JointPath path = way({{0.0, 0.0, 0.0}, {1.0, 0.2, 0.0}});
  EXPECT_FALSE(first(path));
  EXPECT_TRUE(check_.firstContact({map_, path, {test::placedAt(0.3, 0.0, 0.0)}}, 0.0, 1.0));
}

TEST_F(WayCheckTest, ACuboidWithoutSupportIsNoObstacle) {
  addBlock(map_, {Vector3(0.5, 0.0, 0.49), Vector3(0.52, 0.02, 0.51)}, 1);
  const JointPath path = way({{0.0, 0.0, 0.0}, {1.0, 0.9, 0.0}});
  EXPECT_TRUE(first(path));
  WayCheck supported(test::checked(model_, LinkUse({1.0, kPadding}), {}), kStep);
  EXPECT_FALSE(supported.firstContact({map_, path, kAtOrigin}, 0.0, 1.0));
}

/// The region takes in the whole wall of the hand.
PlacedShape wallRegion(double half_width) {
  return {Box{{0.1, half_width, 0.3}}, test::placedAt(0.55, 0.0, 0.5)};
}

TEST_F(WayCheckTest, WhatLiesInARegionThatALinkMayTouchIsNoContactOfThatLink) {
  addWall(0.5, 0.0);
  const JointPath path = way({{0.0, 0.0, 0.0}, {1.0, 0.9, 0.0}});
  const auto exempt = [this](std::size_t shape, double width) {
    ExemptRegions regions{{{wallRegion(width), {}}}, {{}, {}}};
    regions.of_shapes[shape] = {0};
    robot_->collision.exempt(regions);
  };
  const auto index =
      static_cast<std::size_t>(model_->linkOf(robot_->collision_body.shapes[0]) == "hand" ? 0 : 1);
  exempt(index, 0.21);
  EXPECT_FALSE(first(path));
  exempt(index, 0.1);
  EXPECT_TRUE(first(path)) << "part of the wall is outside, and the ball is as wide as it";
  exempt(1 - index, 0.21);
  EXPECT_TRUE(first(path)) << "it is the other link that may touch it";
  robot_->collision.exempt({});
  EXPECT_TRUE(first(path));
}

TEST_F(WayCheckTest, InFreeSpaceAFewPosesAreEnough) {
  EXPECT_FALSE(first(way({{0.0, 0.0, 0.0}, {1.0, 0.9, 0.9}})));
  EXPECT_LE(check_.poses(), 3U) << "both ends and the middle";
  addWall(1.3, 0.0);
  EXPECT_FALSE(first(way({{0.0, 0.0, 0.0}, {1.0, 1.2, 0.0}})));
  EXPECT_LE(check_.poses(), 12U) << "the last 10 mm before the wall";
}

TEST_F(WayCheckTest, NearAnObstacleThereAreNoMorePosesThanSteps) {
  addBlock(map_, {Vector3(0.0, 0.10, 0.3), Vector3(1.4, 0.2, 0.7)});
  EXPECT_FALSE(first(way({{0.0, 0.1, 0.0}, {1.0, 1.3, 0.0}})));
  EXPECT_GE(check_.poses(), 60U) << "a wall 10 mm beside the whole way";
  EXPECT_LE(check_.poses(), 4U * 60U);
}

/// A ball of 20 mm on a slide, and a wall of 30 mm across it. Padded, the ball has a diameter of
/// 120 mm, so that the wall fits between two poses that are 200 mm apart.
class ThinWallTest : public test::CheckerFixture {
 protected:
  ThinWallTest() {
    model_ = test::modelOf(
        robotOf(linkOf("base") + linkOf("hand", collisionOf(test::sphereOf("0.02"))) +
                jointOf("slide", "prismatic", "base", "hand",
                        "<origin xyz=\"0 0 0.5\"/>" + axisOf("1 0 0") + limitOf("-0.5", "1.4"))));
    Grid::Config grid;
    grid.cell_size_m = 0.01;
    wall_ = test::emptyMap(grid);
    addBlock(wall_, {Vector3(0.59, -0.2, 0.0), Vector3(0.62, 0.2, 1.0)});
    wall_.viewpoint = clear_.viewpoint;
    wall_.window = clear_.window;
    test::lookAround(wall_);
    config_.pose.check_occlusion = false;
    remake();
  }
  [[nodiscard]] PoseFindings pose(double slide) const {
    PoseCheck check(test::checked(model_, config_.pose), 1.5);
    PoseFindings findings;
    check.place({slide}, kAtOrigin);
    check.check(wall_, findings);
    return findings;
  }

  static constexpr double kFrom = 0.5, kTo = 0.7;  // [m]
  CuboidMap wall_;
};

TEST_F(ThinWallTest, IsMissedByACheckOfBothPosesAndFoundOnTheWayBetweenThem) {
  EXPECT_FALSE(pose(kFrom).collision);
  EXPECT_FALSE(pose(kTo).collision);
  WayCheck way(test::checked(model_, config_.pose), 0.02);
  JointPath path(1);
  path.add(0.0, {kFrom});
  path.add(0.5, {kTo});
  const auto found = way.firstContact({wall_, path, kAtOrigin}, 0.0, 0.5);
  ASSERT_TRUE(found);
  EXPECT_EQ(model_->linkOf(found->contact.shape), "hand");
  EXPECT_NEAR(wall_.box(wall_.cuboids[found->contact.cuboid]).center().x(), 0.605, 0.0101);
  // 30 mm at 0.4 m/s; half a step more at most.
  EXPECT_GE(found->time_s, 0.075 - kRounding);
  EXPECT_LE(found->time_s, 0.075 + 0.01 / 0.4 + kRounding);
}

TEST_F(ThinWallTest, StopsARobotWhoseVelocityLeadsThroughIt) {
  setRoot(kStart);
  checker_->addJoints(test::at(kStart), test::at(kStart), {"slide"}, {kFrom}, {0.4});
  setMap(kStart, wall_);
  const Verdict& verdict = check(kStart);
  EXPECT_TRUE(verdict.collision);
  EXPECT_TRUE(verdict.stop);
  EXPECT_EQ(verdict.reason, Reason::kCollisionAhead);
  EXPECT_EQ(verdict.link, "hand");
  EXPECT_FALSE(verdict.now.collision) << "the two poses themselves are free";
  EXPECT_FALSE(verdict.ahead.collision);
  ASSERT_TRUE(verdict.first_contact);
  EXPECT_NEAR(verdict.first_contact->time_s, 0.075, 0.026);
  EXPECT_NEAR(verdict.first_contact->distance_m, 0.03, 0.01);
}

TEST_F(ThinWallTest, DoesNotStopARobotThatComesToAHaltBeforeIt) {
  setRoot(kStart);
  checker_->addJoints(test::at(kStart), test::at(kStart), {"slide"}, {kFrom}, {0.05});
  setMap(kStart, wall_);
  EXPECT_EQ(check(kStart).reason, Reason::kClear);
}

TEST(WayCheckConfigTest, WrongLinksAreRefused) {
  LinkUse use;
  use.links = {"foot"};
  EXPECT_THROW(test::checked(test::sliderModel(), use, {}), ConfigError);
}

}  // namespace
}  // namespace tccm
