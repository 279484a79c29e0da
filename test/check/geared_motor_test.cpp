/// Trajectories of a motor that turns without limits, and moves an arm at a gear: the arm's way is
/// judged as it is, and not modulo whole turns of the motor.

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <memory>

#include "check/checker_config.h"
#include "support/cuboid_scene.h"
#include "support/look_around.h"
#include "support/shared_data.h"
#include "support/tiny_robot.h"

namespace tccm {
namespace {

using namespace test::urdf_text;
using test::Random;

constexpr unsigned kMembers = 40;
const Time kNow = Time(fromSeconds(100.0));
const Vector3 kShoulder(0.3, 0.0, 0.8);

/// A bar of 0.5 m on a shoulder that is the motor's mimic.
std::string gearedUrdf(double multiplier) {
  return robotOf(linkOf("base_link") + linkOf("rotor") +
                 linkOf("arm", collisionOf("<box size=\"0.5 0.05 0.05\"/>", "0.25 0 0")) +
                 jointOf("motor", "continuous", "base_link", "rotor", axisOf("0 0 1")) +
                 jointOf("shoulder", "revolute", "base_link", "arm",
                         "<origin xyz=\"0.3 0 0.8\"/>" + axisOf("0 0 1") + limitOf("-3", "3") +
                             "<mimic joint=\"motor\" multiplier=\"" + std::to_string(multiplier) +
                             "\"/>"));
}

/// A box of 60 mm where the arm is at that angle, 0.4 m from its shoulder.
std::shared_ptr<const CuboidMap> mapOfBoxAt(double angle) {
  const auto map = std::make_shared<CuboidMap>(test::emptyMap());
  const Vector3 centre = kShoulder + 0.4 * Vector3(std::cos(angle), std::sin(angle), 0.0);
  test::addBlock(*map, {centre - Vector3::Constant(0.03), centre + Vector3::Constant(0.03)});
  map->viewpoint = Vector3(0.3, 0.0, 1.8);
  map->stamp = kNow;
  test::lookAround(*map);
  return map;
}

/// @return what is said of the motor's way, while the arm points ahead.
Cause answerTo(const std::string& urdf, double box_angle, const std::vector<double>& motor) {
  Checker::Config config;
  config.pose.check_occlusion = false;
  Checker checker(test::modelOf(urdf), config);
  checker.setRootPose(0, kNow, Pose::Identity(), true);
  checker.addJoints(kNow, kNow, {"motor"}, {0.0}, {0.0});
  checker.setMap(kNow, mapOfBoxAt(box_angle));
  JointTrajectory trajectory;
  trajectory.names = {"motor"};
  for (const double position : motor) {
    const auto after = static_cast<double>(trajectory.points.size() + 1);
    trajectory.points.push_back({30.0 * after, {position}, {}, {}});
  }
  return checker.checkTrajectory(kNow, trajectory).cause;
}

TEST(GearedMotorTest, ABoxOnTheArmsWayIsFoundHoweverOftenTheMotorTurns) {
  for (unsigned seed = 0; seed < kMembers; ++seed) {
    Random random(seed);
    const double side = random.chance(0.5) ? 1.0 : -1.0;
    const double gear = random.uniform(0.004, 0.2) * (random.chance(0.5) ? 1.0 : -1.0);
    const double box_angle = side * random.uniform(0.8, 1.4);
    const double until = box_angle + side * random.uniform(-0.05, 0.5);
    std::vector<double> motor{until / gear};
    if (random.chance(0.5)) motor.insert(motor.begin(), 0.0);
    const Cause found = answerTo(gearedUrdf(gear), box_angle, motor);
    EXPECT_EQ(found.reason, Reason::kCollision) << seed << found.detail;
    EXPECT_EQ(found.link, "arm") << seed;
  }
}

TEST(GearedMotorTest, AWayThatEndsBeforeTheBoxOrGoesAwayFromItIsFree) {
  for (unsigned seed = 0; seed < kMembers; ++seed) {
    Random random(seed);
    const double side = random.chance(0.5) ? 1.0 : -1.0;
    const double gear = random.uniform(0.004, 0.2) * (random.chance(0.5) ? 1.0 : -1.0);
    const double box_angle = side * random.uniform(0.8, 1.4);
    const double until = box_angle - side * random.uniform(0.45, 2.0);
    const Cause found = answerTo(gearedUrdf(gear), box_angle, {until / gear, 0.0});
    EXPECT_EQ(found.reason, Reason::kClear) << seed << found.detail;
  }
}

TEST(GearedMotorTest, TheSharedRobotsArmCollidesBeforeItsMotorHasTurnedBy150Radians) {
  const std::string path = test::sharedDataFolder() + "/cases/geared-mimic/gear.urdf";
  std::ifstream file(path);
  if (!file) GTEST_SKIP() << "no " << path;
  const std::string urdf{std::istreambuf_iterator<char>(file), {}};
  for (const std::vector<double>& motor : {std::vector{150.0}, std::vector{0.0, 150.0}}) {
    EXPECT_EQ(answerTo(urdf, 1.5, motor).reason, Reason::kCollision);
  }
  EXPECT_EQ(answerTo(urdf, 1.5, {100.0}).reason, Reason::kClear);
}

}  // namespace
}  // namespace tccm
