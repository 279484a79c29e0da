#include "check/area_check.h"

#include "support/checked_robot.h"
#include "support/checker_fixture.h"
#include "support/random.h"

namespace tccm {
namespace {

using test::at;
using test::kScanPeriod;
using test::kStart;
using test::Random;

constexpr unsigned kMembers = 30;

/// The slider robot. The area is 1.5 m x 2.0 m x 2.0 m, from (0, -1, 0) on.
class AreaCheckTest : public test::CheckerFixture {
 protected:
  void setRootAt(double now, const Vector3& place, bool is_static = false) {
    Pose T_fixed_root = Pose::Identity();
    T_fixed_root.translation() = place;
    checker_->setRootPose(0, at(now), T_fixed_root, is_static);
  }
  const Verdict& checkAt(double now, const Vector3& root, double slide = 0.0) {
    setRootAt(now, root);
    feedAllButRoot(now, clear_, slide);
    return check(now);
  }
  /// A place of the root at which neither ball is inside the area; 0.2 m beyond a side of it.
  static Vector3 outside(Random& random) {
    Vector3 place(random.uniform(-10, 10), random.uniform(-10, 10), random.uniform(-0.4, 1.4));
    const int side = random.integer(0, 5);
    if (side == 0) place.x() = random.uniform(-50.0, -0.26);
    if (side == 1) place.x() = random.uniform(1.76, 50.0);
    if (side == 2) place.y() = random.uniform(-50.0, -1.8);
    if (side == 3) place.y() = random.uniform(1.3, 50.0);
    if (side == 4) place.z() = random.uniform(-50.0, -0.8);
    if (side == 5) place.z() = random.uniform(1.8, 50.0);
    return place;
  }
};

TEST_F(AreaCheckTest, ARobotOutsideOfTheAreaIsAFaultThatTellsItsPlaceAndTheArea) {
  const Verdict& verdict = checkAt(kStart, {5.0, 0.25, 0.0});
  EXPECT_EQ(verdict.reason, Reason::kOutsideArea);
  EXPECT_EQ(verdict.level, Level::kFault);
  EXPECT_FALSE(verdict.known);
  EXPECT_EQ(verdict.link, "hand");
  for (const char* part :
       {"(5.00, 0.25, 0.50)", "x 0.00 to 1.50", "y -1.00 to 1.00", "z 0.00 to 2.00", "area_*_m"}) {
    EXPECT_NE(verdict.detail.find(part), std::string::npos) << verdict.detail;
  }
}

TEST_F(AreaCheckTest, WhereverItIsOutsideItIsAFaultAndWhereverAPartIsInsideItIsNone) {
  for (unsigned seed = 0; seed < kMembers; ++seed) {
    Random random(seed);
    remake();
    EXPECT_EQ(checkAt(kStart, outside(random)).reason, Reason::kOutsideArea) << seed;
    remake();
    const Vector3 inside(random.uniform(-0.04, 1.54), random.uniform(-1.04, 0.9),
                         random.uniform(-0.54, 1.54));
    const Verdict& verdict = checkAt(kStart, inside);
    EXPECT_EQ(verdict.reason, Reason::kClear) << seed << verdict.detail;
  }
}

TEST_F(AreaCheckTest, ARobotThatDrivesOffIsHeldUntilAPersonResets) {
  config_.permission.hold_until_reset = true;
  remake();
  double now = kStart;
  for (double x = 0.0; x < 3.0; x += 0.1) checkAt(now += kScanPeriod, {x, 0.0, 0.0});
  EXPECT_EQ(check(now).reason, Reason::kOutsideArea);
  for (int i = 0; i < 100; ++i) checkAt(now += kScanPeriod, {0.3, 0.0, 0.0});
  EXPECT_EQ(check(now).reason, Reason::kAwaitingReset);
  EXPECT_EQ(checker_->reset(), "");
}

/// As a mobile base below height_min_m that an arm stands on.
TEST_F(AreaCheckTest, WhatStandsStillBelowTheAreaIsNotTold) {
  using namespace test;
  model_ = modelOf(
      robotOf(ballLink("base") + ballLink("wheel") + ballLink("hand") +
              jointOf("axle", "fixed", "base", "wheel", "<origin xyz=\"0 0.3 0\"/>") +
              jointOf("lift", "prismatic", "base", "hand",
                      "<origin xyz=\"0.3 0 0.5\"/>" + axisOf("0 0 1") + limitOf("-1", "1"))));
  for (unsigned seed = 0; seed < kMembers; ++seed) {
    Random random(seed);
    for (const bool is_static : {true, false}) {
      remake();
      setRootAt(kStart, {random.uniform(0.0, 1.0), 0.0, random.uniform(-0.4, -0.1)}, is_static);
      setMap(kStart, clear_);
      checker_->addJoints(at(kStart), at(kStart), {"lift"}, {random.uniform(0.0, 1.0)}, {0.0});
      EXPECT_EQ(reasonAt(kStart), Reason::kClear) << seed;
    }
  }
}

TEST_F(AreaCheckTest, OfARobotThatStandsInTheAreaTheArmHasToBeInside) {
  using namespace test;
  model_ = modelOf(
      robotOf(ballLink("base") + ballLink("hand") +
              jointOf("lift", "prismatic", "base", "hand",
                      "<origin xyz=\"-1 0 0.5\"/>" + axisOf("0 0 1") + limitOf("-1", "1"))));
  for (const bool is_static : {true, false}) {
    remake();
    setRootAt(kStart, {0.5, 0.0, 0.5}, is_static);
    setMap(kStart, clear_);
    checker_->addJoints(at(kStart), at(kStart), {"lift"}, {0.0}, {0.0});
    EXPECT_EQ(reasonAt(kStart), is_static ? Reason::kOutsideArea : Reason::kClear);
  }
}

TEST_F(AreaCheckTest, AStateOrWayOutOfTheAreaIsNotFree) {
  const std::vector<std::string> both{"slide", "glide"};
  model_ = test::modelOf(test::sliderUrdf());
  feed(kStart, clear_);
  EXPECT_EQ(checker_->checkState(at(kStart), both, {1.0, 0.5}).cause.reason, Reason::kClear);
  for (unsigned seed = 0; seed < kMembers; ++seed) {
    Random random(seed);
    const double glide =
        random.chance(0.5) ? random.uniform(1.6, 90.0) : random.uniform(-90.0, -0.1);
    const std::vector<double> away{random.uniform(-0.5, -0.1), glide};
    EXPECT_EQ(checker_->checkState(at(kStart), both, away).cause.reason, Reason::kOutsideArea);
    JointTrajectory trajectory;
    trajectory.names = both;
    trajectory.points = {
        {1.0, {0.5, 0.5}, {}, {}}, {9.0, away, {}, {}}, {20.0, {0.5, 0.5}, {}, {}}};
    const TrajectoryAnswer answer = checker_->checkTrajectory(at(kStart), trajectory);
    EXPECT_EQ(answer.cause.reason, Reason::kOutsideArea) << answer.cause.detail;
    EXPECT_EQ(answer.index, 1U);
  }
}

/// All of it was looked at, and is free as far as the sensor can tell.
TEST_F(AreaCheckTest, AWayOutOfTheAreaIsUnseenWhateverTheSensorSaw) {
  for (unsigned seed = 0; seed < kMembers; ++seed) {
    Random random(seed);
    remake();
    const double speed = random.uniform(0.3, 1.0);
    run(kStart, kStart + 0.1, clear_, 0.5);
    const Verdict& within = feedAndCheck(kStart + 0.125, clear_, 0.5, speed);
    EXPECT_EQ(within.reason, Reason::kClear) << seed << within.detail;
    remake();
    const double slide = random.uniform(-0.02, 0.02);
    run(kStart, kStart + 0.1, clear_, slide);
    const Verdict& beyond = feedAndCheck(kStart + 0.125, clear_, slide, -speed);
    EXPECT_EQ(beyond.reason, Reason::kUnseenAhead) << seed;
    EXPECT_EQ(beyond.level, Level::kSlow) << seed;
    EXPECT_NE(beyond.detail.find("outside the map's area"), std::string::npos) << beyond.detail;
  }
}

}  // namespace
}  // namespace tccm
