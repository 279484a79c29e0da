#include "check/keep_out.h"

#include <cmath>
#include <limits>

#include "support/keep_out_fixture.h"
#include "support/refusal.h"

namespace tccm {
namespace {

using namespace test::urdf_text;
using test::at;
using test::errorOf;
using test::keepOutBox;
using test::kStart;
using test::names;
using test::Regions;
using test::wall;
using test::wallRow;

class KeepOutTest : public test::KeepOutFixture {};

TEST_F(KeepOutTest, ALinkInARegionIsAStopThatNamesBoth) {
  checker_->setKeepOut(wall());
  EXPECT_EQ(feedAndCheck(kStart, clear_, 0.70).reason, Reason::kClear);
  const Verdict& verdict = feedAndCheck(kStart + 0.02, clear_, 0.72);
  EXPECT_EQ(verdict.reason, Reason::kKeepOut);
  EXPECT_EQ(verdict.level, Level::kStop);
  EXPECT_EQ(verdict.link, "hand");
  EXPECT_EQ(verdict.detail, "hand is in keep-out region 'wall'");
  EXPECT_TRUE(verdict.keep_out);
  EXPECT_FALSE(verdict.collision) << "nothing of the map is touched";
  ASSERT_EQ(verdict.now.keep_out.size(), 1U);
  EXPECT_EQ(checker_->model()->linkOf(verdict.now.keep_out.front().shape), "hand");
  EXPECT_TRUE(verdict.now.contacts.empty());
}

TEST_F(KeepOutTest, OneOfTheConfigurationIsThereFromTheStart) {
  config_.keep_out.regions = {wallRow()};
  remake();
  EXPECT_EQ(feedAndCheck(kStart, clear_, 0.70).reason, Reason::kClear);
  EXPECT_EQ(feedAndCheck(kStart + 0.02, clear_, 0.72).reason, Reason::kKeepOut);
}

TEST_F(KeepOutTest, OneThatIsTurnedReachesWhereItsCornersAre) {
  Regions::Region row = wallRow();
  row.size_y_m = row.size_x_m = 0.2;
  config_.keep_out.regions = {row};
  config_.keep_out.regions[0].yaw_rad = 0.25 * M_PI;  // its edge is at 0.9 - 0.1414
  remake();
  EXPECT_EQ(feedAndCheck(kStart, clear_, 0.66).reason, Reason::kClear);
  EXPECT_EQ(feedAndCheck(kStart + 0.02, clear_, 0.675).reason, Reason::kKeepOut);
}

TEST_F(KeepOutTest, RollPitchAndYawTurnAboutTheFramesAxesInThisOrder) {
  Regions::Region row;
  row.roll_rad = 0.5 * M_PI;
  row.pitch_rad = 0.5 * M_PI;
  // y goes to z by the roll, and to x by the pitch.
  EXPECT_TRUE(
      (row.region().T_frame_box.linear() * Vector3::UnitY()).isApprox(Vector3::UnitX(), 1e-9));
  row.yaw_rad = 0.5 * M_PI;
  EXPECT_TRUE(
      (row.region().T_frame_box.linear() * Vector3::UnitY()).isApprox(Vector3::UnitY(), 1e-9));
}

TEST_F(KeepOutTest, AheadItStopsTheRobotWithTheTime) {
  checker_->setKeepOut(wall());
  const Verdict& verdict = feedAndCheck(kStart, clear_, 0.55, 0.4);
  EXPECT_EQ(verdict.reason, Reason::kKeepOutAhead);
  EXPECT_EQ(verdict.level, Level::kStop);
  EXPECT_EQ(verdict.link, "hand");
  EXPECT_EQ(verdict.detail.substr(0, 38), "hand enters keep-out region 'wall' in ");
  EXPECT_NEAR(std::stod(verdict.detail.substr(38)), 400.0, 15.0) << verdict.detail;
  EXPECT_TRUE(verdict.keep_out);
  EXPECT_FALSE(verdict.first_contact) << "of the map";
  EXPECT_EQ(feedAndCheck(kStart + 0.02, clear_, 0.40, 0.4).reason, Reason::kReleasing);
  remake();
  checker_->setKeepOut(wall());
  EXPECT_EQ(feedAndCheck(kStart, clear_, 0.40, 0.4).reason, Reason::kClear) << "beyond the horizon";
  remake();
  checker_->setKeepOut(wall());
  EXPECT_EQ(feedAndCheck(kStart, clear_, 0.55, -0.4).reason, Reason::kClear) << "away";
}

TEST_F(KeepOutTest, LaterThanTheRobotHaltsItSlowsDown) {
  stopLate();
  checker_->setKeepOut(wall());
  feedAndCheck(kStart, clear_, 0.546, 0.4);
  const Verdict& verdict = feedAndCheck(kStart + 0.01, clear_, 0.55, 0.4);
  EXPECT_EQ(verdict.reason, Reason::kKeepOutAhead);
  EXPECT_EQ(verdict.level, Level::kSlow);
  EXPECT_GT(verdict.speed_scale, 0.0);
  EXPECT_LT(verdict.speed_scale, 1.0);
}

TEST_F(KeepOutTest, TheCommandedTrajectoryIsLookedAlongToo) {
  checker_->setKeepOut(wall());
  feed(kStart, clear_, 0.55);
  ASSERT_EQ(
      checker_->command(at(kStart), {{"slide"}, {{0.0, {0.55}, {}, {}}, {0.5, {0.8}, {}, {}}}}),
      "");
  const Verdict& verdict = check(kStart);
  EXPECT_EQ(verdict.reason, Reason::kKeepOutAhead);
  EXPECT_TRUE(verdict.follows_trajectory);
}

TEST_F(KeepOutTest, WhatIsHeldMustNotEnterEither) {
  checker_->setKeepOut(wall());
  AttachedObject ball{"ball", "hand", {Sphere{0.03}}};
  ball.primitive.pose.translation().x() = 0.12;  // 0.1 m further than the hand
  checker_->attach(ball);
  EXPECT_EQ(feedAndCheck(kStart, clear_, 0.60).reason, Reason::kClear);
  const Verdict& verdict = feedAndCheck(kStart + 0.02, clear_, 0.62);
  EXPECT_EQ(verdict.reason, Reason::kKeepOut);
  EXPECT_EQ(verdict.detail, "'ball' on hand is in keep-out region 'wall'");
}

TEST_F(KeepOutTest, NoExemptionLiftsIt) {
  checker_->setKeepOut(wall());
  const PlacedShape everywhere{Box{Vector3::Constant(10.0)}, Pose::Identity()};
  checker_->addExemption(at(kStart), {"grasping", "hand", everywhere, Time()}, 10.0);
  EXPECT_EQ(feedAndCheck(kStart, post_, 0.55, 0.4).reason, Reason::kKeepOutAhead);
  EXPECT_EQ(feedAndCheck(kStart + 0.02, post_, 0.75).reason, Reason::kKeepOut);
}

TEST_F(KeepOutTest, OfBothTheCollisionIsNamedFirst) {
  checker_->setKeepOut(wall());
  const Verdict& verdict = feedAndCheck(kStart, post_, 0.75);
  EXPECT_EQ(verdict.reason, Reason::kCollision);
  EXPECT_NE(std::find(verdict.reasons.begin(), verdict.reasons.end(), Reason::kKeepOut),
            verdict.reasons.end());
}

TEST_F(KeepOutTest, AStateOrTrajectoryThatEntersOneIsNotFree) {
  checker_->setKeepOut(wall());
  feed(kStart, clear_, 0.0);
  EXPECT_EQ(checker_->checkState(at(kStart), {"slide"}, {0.70}).cause.reason, Reason::kClear);
  const StateAnswer state = checker_->checkState(at(kStart), {"slide"}, {0.72});
  EXPECT_EQ(state.cause.reason, Reason::kKeepOut);
  EXPECT_EQ(state.cause.link, "hand");
  EXPECT_EQ(state.cause.detail, "hand is in keep-out region 'wall'");
  const JointTrajectory way{{"slide"}, {{1.0, {0.5}, {}, {}}, {2.0, {0.9}, {}, {}}}};
  const TrajectoryAnswer answer = checker_->checkTrajectory(at(kStart), way);
  EXPECT_EQ(answer.cause.reason, Reason::kKeepOut);
  EXPECT_EQ(answer.index, 1U);
  EXPECT_NEAR(answer.time_s, 1.0 + 0.21 / 0.4, 0.02);
  EXPECT_TRUE(names(answer.cause.detail, "hand enters keep-out region 'wall' after 1.5"))
      << answer.cause.detail;
  EXPECT_FALSE(answer.contact);
  EXPECT_LT(answer.clearances_m[1], 1e-9) << "regions count";
}

/// A way into a region between two waypoints that are free.
TEST_F(KeepOutTest, ATrajectoryIsLookedAlongBetweenTheWaypoints) {
  checker_->setKeepOut(keepOutBox("slab", {0.4, 0.0, 0.5}, {0.01, 0.01, 0.01}));
  feed(kStart, clear_, 0.0);
  const JointTrajectory way{{"slide"}, {{1.0, {0.8}, {}, {}}}};
  EXPECT_EQ(checker_->checkTrajectory(at(kStart), way).cause.reason, Reason::kKeepOut);
}

TEST_F(KeepOutTest, OfATrajectoryTheEarlierOfRegionAndMapIsNamed) {
  const JointTrajectory way{{"slide"}, {{1.0, {0.5}, {}, {}}, {2.0, {0.9}, {}, {}}}};
  feed(kStart, post_, 0.0);  // touched from 0.71 m on
  checker_->setKeepOut(keepOutBox("further", {0.95, 0.0, 0.5}, {0.2, 0.4, 1.0}));
  TrajectoryAnswer answer = checker_->checkTrajectory(at(kStart), way);
  EXPECT_EQ(answer.cause.reason, Reason::kCollision);
  EXPECT_TRUE(answer.contact);
  for (const double x : {0.85, 0.45}) {  // in the same stretch, and in one before
    checker_->setKeepOut(keepOutBox("nearer", {x, 0.0, 0.5}, {0.2, 0.4, 1.0}));
    answer = checker_->checkTrajectory(at(kStart), way);
    EXPECT_EQ(answer.cause.reason, Reason::kKeepOut) << x;
    EXPECT_EQ(answer.index, x > 0.5 ? 1U : 0U);
    EXPECT_FALSE(answer.contact);
  }
}

TEST_F(KeepOutTest, ClearancesCountItFromTheBarePrimitives) {
  checker_->setKeepOut(wall());
  const auto clearanceOfHand = [this](double now, const CuboidMap& map, double slide) {
    for (const LinkClearance& entry : feedAndCheck(now, map, slide).clearances) {
      if (checker_->model()->links()[entry.link] == "hand") return entry;
    }
    return LinkClearance();
  };
  LinkClearance clearance = clearanceOfHand(kStart, clear_, 0.6);
  EXPECT_NEAR(clearance.distance_m, 0.8 - 0.6 - 0.05, 1e-6);
  EXPECT_TRUE(clearance.is_region);
  EXPECT_EQ(clearance.cuboid, 0U);
  checker_->setKeepOut(keepOutBox("wall", {0.95, 0.0, 0.5}, {0.2, 0.4, 1.0}));
  clearance = clearanceOfHand(kStart + 0.02, post_, 0.6);
  EXPECT_NEAR(clearance.distance_m, 0.8 - 0.6 - 0.05, 1e-6) << "the map is nearer";
  EXPECT_FALSE(clearance.is_region);
}

TEST_F(KeepOutTest, BeingInOneHoldsUntilAResetWhichIsRefusedWhileItLasts) {
  config_.permission.hold_until_reset = true;
  remake();
  checker_->setKeepOut(wall());
  EXPECT_EQ(run(kStart, kStart + 0.1, clear_, 0.72).reason, Reason::kKeepOut);
  EXPECT_EQ(checker_->reset(), "KEEP_OUT lasts");
  checker_->removeKeepOut("wall");
  const Verdict& verdict = run(kStart + 0.125, kStart + 1.5, clear_, 0.72);
  EXPECT_EQ(verdict.reason, Reason::kAwaitingReset);
  EXPECT_EQ(verdict.latched, Reason::kKeepOut);
  EXPECT_EQ(checker_->reset(), "");
  EXPECT_EQ(feedAndCheck(kStart + 1.525, clear_, 0.72).reason, Reason::kClear);
}

TEST_F(KeepOutTest, WhatWasOnlyAheadIsReleasedByItself) {
  config_.permission.hold_until_reset = true;
  remake();
  checker_->setKeepOut(wall());
  EXPECT_EQ(feedAndCheck(kStart, clear_, 0.6, 0.4).reason, Reason::kKeepOutAhead);
  checker_->removeKeepOut("wall");
  EXPECT_EQ(run(kStart + 0.025, kStart + 0.5, clear_, 0.6).reason, Reason::kReleasing);
  EXPECT_EQ(run(kStart + 0.525, kStart + 1.3, clear_, 0.6).reason, Reason::kClear);
}

TEST_F(KeepOutTest, ARobotInOneMayMoveOutAndNotFurtherIn) {
  config_.permission.hold_until_reset = true;
  remake();
  checker_->setKeepOut(wall());
  EXPECT_EQ(run(kStart, kStart + 0.1, clear_, 0.72).reason, Reason::kKeepOut);
  const Verdict& out = feedAndCheck(kStart + 0.125, clear_, 0.72, -0.1);
  EXPECT_EQ(out.reason, Reason::kMovingOut);
  EXPECT_EQ(out.detail, "hand moves out of keep-out region 'wall'");
  EXPECT_FALSE(out.stop);
  EXPECT_EQ(feedAndCheck(kStart + 0.15, clear_, 0.72, 0.1).reason, Reason::kKeepOut);
  EXPECT_EQ(feedAndCheck(kStart + 0.175, clear_, 0.82, -0.1).reason, Reason::kKeepOut)
      << "its middle is inside: no way out can be told";
}

/// The hand leaves a post at x = 0.8 backwards, into a region behind it.
TEST_F(KeepOutTest, AWayOutOfAContactMustNotLeadIntoARegion) {
  EXPECT_EQ(feedAndCheck(kStart, post_, 0.72, -0.1).reason, Reason::kMovingOut);
  remake();
  checker_->setKeepOut(
      keepOutBox("behind", {0.59, 0.0, 0.5}, {0.02, 0.4, 1.0}));  // touched at 0.69
  const Verdict& verdict = feedAndCheck(kStart, post_, 0.72, -0.1);
  EXPECT_TRUE(verdict.stop);
  EXPECT_EQ(verdict.reason, Reason::kKeepOutAhead);
}

TEST_F(KeepOutTest, ARegionOfAMovingBaseGoesAlongAndOneOfTheFixedFrameStays) {
  checker_->setKeepOut(wall());
  checker_->setKeepOut(keepOutBox("own", {-0.5, 0.0, 0.5}, {0.2, 0.4, 1.0}, "/base"));
  double now = kStart;
  const auto nameAt = [&](double base_x, double slide) {
    now += 0.1;
    checker_->setRootPose(0, at(now), test::placedAt(base_x, 0.0, 0.0), false);
    feedAllButRoot(now, clear_, slide);
    const Verdict& verdict = check(now);
    EXPECT_TRUE(verdict.placed);
    if (verdict.now.keep_out.empty()) return std::string();
    return checker_->keepOut()[verdict.now.keep_out.front().cuboid].name;
  };
  EXPECT_EQ(nameAt(0.0, 0.0), "");
  EXPECT_EQ(nameAt(0.0, -0.35), "own");
  EXPECT_EQ(nameAt(0.5, -0.35), "own");
  EXPECT_EQ(nameAt(0.5, -0.1), "");
  EXPECT_EQ(nameAt(0.5, 0.25), "wall");
  EXPECT_EQ(nameAt(0.0, 0.25), "");
}

}  // namespace
}  // namespace tccm
