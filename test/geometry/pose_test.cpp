#include "tccm_monitor/pose.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "support/near.h"
#include "support/random.h"

namespace tccm {
namespace {

using test::isNearly;
using test::Random;

Time atSeconds(double seconds) { return Time(fromSeconds(seconds)); }

Pose turnedAboutZ(double angle, const Vector3& translation) {
  Pose pose(Eigen::AngleAxisd(angle, Vector3::UnitZ()));
  pose.translation() = translation;
  return pose;
}

TEST(PoseTest, InterpolationIsLinearInPlaceAndSphericalInRotation) {
  const Pose from = turnedAboutZ(0.2, {1.0, 2.0, 3.0});
  const Pose to = turnedAboutZ(1.2, {2.0, 0.0, 3.5});
  EXPECT_TRUE(isNearly(Interpolation(from, to).at(0.0), from, 1e-12));
  EXPECT_TRUE(isNearly(Interpolation(from, to).at(1.0), to, 1e-12));
  EXPECT_TRUE(
      isNearly(Interpolation(from, to).at(0.25), turnedAboutZ(0.45, {1.25, 1.5, 3.125}), 1e-12));
}

TEST(PoseTest, InterpolationTakesTheShorterWayRound) {
  const Pose from = turnedAboutZ(3.0, Vector3::Zero());
  const Pose to = turnedAboutZ(-3.0, Vector3::Zero());
  EXPECT_TRUE(
      isNearly(Interpolation(from, to).at(0.5), turnedAboutZ(M_PI, Vector3::Zero()), 1e-12));
}

TEST(PoseTest, InterpolationOfRandomPosesStaysRigidAndTurnsEvenly) {
  Random random(1);
  for (int i = 0; i < 2000; ++i) {
    const Pose from = random.pose(2.0), to = random.pose(2.0);
    const double u = random.uniform(0.0, 1.0);
    const Pose between = Interpolation(from, to).at(u);
    ASSERT_TRUE(isRigid(between));
    const double whole =
        Eigen::Quaterniond(from.linear()).angularDistance(Eigen::Quaterniond(to.linear()));
    const double part =
        Eigen::Quaterniond(from.linear()).angularDistance(Eigen::Quaterniond(between.linear()));
    ASSERT_NEAR(part, u * whole, 1e-6);
  }
}

TEST(PoseTest, RotationsAreInterpolatedAsByEigen) {
  Random random(3);
  for (int i = 0; i < 2000; ++i) {
    const Pose from = random.pose(2.0);
    // From no turn at all, over such as a scan brings, to half a turn.
    const double angle = i % 4 == 0 ? 0.0 : std::pow(10.0, random.uniform(-10.0, 0.49));
    Pose to = random.pose(2.0);
    to.linear() = from.linear() * Eigen::AngleAxisd(angle, random.direction());
    const double u = random.uniform(0.0, 1.0);
    const Eigen::Quaterniond q_from(from.linear()), q_to(to.linear());
    Pose expected = Pose::Identity();
    expected.linear() = q_from.slerp(u, q_to).toRotationMatrix();
    expected.translation() = (1.0 - u) * from.translation() + u * to.translation();
    ASSERT_TRUE(isNearly(Interpolation(from, to).at(u), expected, 1e-12)) << angle << ' ' << u;
  }
}

TEST(PoseTest, OnlyFiniteRightHandedRotationsAreRigid) {
  EXPECT_TRUE(isRigid(Pose::Identity()));
  Pose pose = Pose::Identity();
  pose.translation().y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(isRigid(pose));
  pose = Pose::Identity();
  pose.translation().x() = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(isRigid(pose));
  pose = Pose::Identity();
  pose.linear().setZero();  // what an all-zero quaternion becomes
  EXPECT_FALSE(isRigid(pose));
  pose = Pose::Identity();
  pose.linear() *= 1.01;
  EXPECT_FALSE(isRigid(pose));
  pose = Pose::Identity();
  pose.linear()(2, 2) = -1.0;  // a mirror
  EXPECT_FALSE(isRigid(pose));
}

TEST(PosePathTest, AnEmptyPathCoversNothing) {
  const PosePath path;
  EXPECT_FALSE(path.covers(atSeconds(0.0), atSeconds(0.0)));
  EXPECT_FALSE(path.at(atSeconds(0.0)));
}

TEST(PosePathTest, ASinglePoseHoldsAtItsInstantAlone) {
  PosePath path;
  ASSERT_TRUE(path.add(atSeconds(1.0), turnedAboutZ(0.5, Vector3::UnitX())));
  ASSERT_TRUE(path.at(atSeconds(1.0)));
  EXPECT_TRUE(isNearly(*path.at(atSeconds(1.0)), turnedAboutZ(0.5, Vector3::UnitX()), 0.0));
  EXPECT_FALSE(path.at(atSeconds(1.0) + Duration(1)));
  EXPECT_FALSE(path.at(atSeconds(1.0) - Duration(1)));
}

TEST(PosePathTest, NothingIsKnownOutsideTheInstantsAdded) {
  PosePath path;
  ASSERT_TRUE(path.add(atSeconds(1.0), Pose::Identity()));
  ASSERT_TRUE(path.add(atSeconds(2.0), turnedAboutZ(1.0, Vector3::UnitX())));
  EXPECT_TRUE(path.covers(atSeconds(1.0), atSeconds(2.0)));
  EXPECT_FALSE(path.covers(atSeconds(0.999), atSeconds(1.5)));
  EXPECT_FALSE(path.covers(atSeconds(1.5), atSeconds(2.001)));
  EXPECT_FALSE(path.at(atSeconds(0.999)));
  EXPECT_FALSE(path.at(atSeconds(2.001)));
  EXPECT_TRUE(path.at(atSeconds(2.0)));
}

TEST(PosePathTest, EqualOrEarlierStampsAndBrokenPosesAreRefusedAndChangeNothing) {
  PosePath path;
  ASSERT_TRUE(path.add(atSeconds(1.0), Pose::Identity()));
  EXPECT_FALSE(path.add(atSeconds(1.0), turnedAboutZ(1.0, Vector3::UnitX())));
  EXPECT_FALSE(path.add(atSeconds(0.5), turnedAboutZ(1.0, Vector3::UnitX())));
  Pose broken = Pose::Identity();
  broken.linear()(0, 0) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(path.add(atSeconds(2.0), broken));
  EXPECT_FALSE(path.covers(atSeconds(1.0), atSeconds(2.0)));
  EXPECT_TRUE(isNearly(*path.at(atSeconds(1.0)), Pose::Identity(), 0.0));
}

TEST(PosePathTest, ALongGapIsInterpolatedBetweenItsEnds) {
  PosePath path;
  ASSERT_TRUE(path.add(atSeconds(0.0), turnedAboutZ(0.0, Vector3::Zero())));
  ASSERT_TRUE(path.add(atSeconds(0.01), turnedAboutZ(0.1, {0.1, 0.0, 0.0})));
  ASSERT_TRUE(path.add(atSeconds(10.01), turnedAboutZ(1.1, {0.1, 0.0, 2.0})));
  EXPECT_TRUE(isNearly(*path.at(atSeconds(0.005)), turnedAboutZ(0.05, {0.05, 0.0, 0.0}), 1e-9));
  EXPECT_TRUE(isNearly(*path.at(atSeconds(5.01)), turnedAboutZ(0.6, {0.1, 0.0, 1.0}), 1e-9));
}

TEST(PosePathTest, AnswersDoNotDependOnTheOrderOfQuestions) {
  Random random(2);
  PosePath path;
  std::vector<Pose> poses;
  for (int i = 0; i < 50; ++i) {
    poses.push_back(random.pose(1.0));
    ASSERT_TRUE(path.add(atSeconds(0.1 * i), poses.back()));
  }
  for (int k = 0; k < 2000; ++k) {
    const int i = random.integer(0, 48);
    const double u = random.chance(0.2) ? 0.0 : random.uniform(0.0, 1.0);
    const auto pose = path.at(atSeconds(0.1 * i) + fromSeconds(0.1 * u));
    ASSERT_TRUE(pose);
    ASSERT_TRUE(isNearly(
        *pose,
        Interpolation(poses[static_cast<std::size_t>(i)], poses[static_cast<std::size_t>(i) + 1])
            .at(u),
        1e-6));
  }
}

TEST(PosePathTest, AClearedPathStartsAnewAlsoAtAnEarlierTime) {
  PosePath path;
  ASSERT_TRUE(path.add(atSeconds(5.0), Pose::Identity()));
  ASSERT_TRUE(path.add(atSeconds(6.0), Pose::Identity()));
  ASSERT_TRUE(path.at(atSeconds(5.5)));
  path.clear();
  EXPECT_FALSE(path.at(atSeconds(5.5)));
  ASSERT_TRUE(path.add(atSeconds(1.0), turnedAboutZ(0.3, Vector3::UnitY())));
  EXPECT_TRUE(isNearly(*path.at(atSeconds(1.0)), turnedAboutZ(0.3, Vector3::UnitY()), 0.0));
}

TEST(PoseTest, NoPointWithinTheRadiusIsDisplacedByMore) {
  Random random(4);
  double closest = 1.0;
  for (int i = 0; i < 2000; ++i) {
    const Pose from = random.pose(1.0), to = random.pose(1.0);
    const double radius = random.uniform(0.0, 0.5);
    const double most = displacement(from, to, radius);
    const Vector3 p =
        radius * random.pointIn({Vector3::Constant(-1.0), Vector3::Ones()}).normalized();
    const double moved = (to * p - from * p).norm();
    ASSERT_LE(moved, most + 1e-9);
    closest = std::min(closest, most - moved);
  }
  EXPECT_LT(closest, 0.05) << "and the bound is of use";
  EXPECT_NEAR(
      displacement(turnedAboutZ(0.0, {0.0, 0.0, 0.0}), turnedAboutZ(0.5, {0.3, 0.0, 0.4}), 0.2),
      0.5 + 0.5 * 0.2, 1e-9);
}

}  // namespace
}  // namespace tccm
