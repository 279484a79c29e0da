#include "robot/motion_bound.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "robot/kinematics.h"
#include "simulation/robot/dual_arm.h"
#include "support/random.h"
#include "support/tiny_robot.h"

namespace tccm {
namespace {

using namespace test::urdf_text;
using test::Random;

constexpr double kRounding = 1e-12;
constexpr double kPi = 3.14159265358979323846;

std::string originOf(const std::string& xyz, const std::string& rpy = "0 0 0") {
  return "<origin xyz=\"" + xyz + "\" rpy=\"" + rpy + "\"/>";
}

/// A link with a ball of 50 mm.
std::string ballAt(const std::string& link, const std::string& xyz) {
  return linkOf(link, collisionOf(test::sphereOf("0.05"), xyz));
}

std::string mimicOf(const std::string& joint, const std::string& multiplier,
                    const std::string& offset) {
  return "<mimic joint=\"" + joint + "\" multiplier=\"" + multiplier + "\" offset=\"" + offset +
         "\"/>";
}

std::vector<std::size_t> allShapes(const RobotModel& model) {
  std::vector<std::size_t> shapes(model.shapes().size());
  std::iota(shapes.begin(), shapes.end(), 0U);
  return shapes;
}

/// Of all shapes as they are.
MotionBound boundOf(const RobotModel& model) {
  std::vector<double> radii;
  for (const LinkShape& shape : model.shapes()) radii.push_back(boundingRadius(shape.shape));
  return {model, allShapes(model), radii};
}

std::size_t shapeOf(const RobotModel& model, const std::string& link) {
  for (std::size_t i = 0; i < model.shapes().size(); ++i) {
    if (model.linkOf(i) == link) return i;
  }
  throw std::out_of_range(link);
}

/// How far the shape moves for each unit of the variable's travel.
double leverArm(const MotionBound& bound, const RobotModel& model, std::size_t shape,
                std::size_t variable) {
  std::vector<double> travel(model.variables().size(), 0.0);
  travel[variable] = 1.0;
  return bound.displacement(shape, travel);
}

double leverArm(const std::string& urdf, const std::string& link, const std::string& joint) {
  const auto model = test::modelOf(urdf);
  return leverArm(boundOf(*model), *model, shapeOf(*model, link),
                  simulation::variableIndex(*model, joint));
}

TEST(MotionBoundTest, ARotationMovesABallByItsDistanceFromTheAxisAndItsRadius) {
  const auto turned = [](const std::string& xyz) {
    return leverArm(robotOf(linkOf("base") + ballAt("arm", xyz) +
                            jointOf("turn", "revolute", "base", "arm",
                                    originOf("1 2 3") + axisOf("0 0 1") + limitOf("-3", "3"))),
                    "arm", "turn");
  };
  EXPECT_NEAR(turned("0.5 0 0"), 0.55, kRounding);
  EXPECT_NEAR(turned("0.3 -0.4 7"), 0.55, kRounding)
      << "how far along the axis makes no difference";
  EXPECT_NEAR(turned("0 0 7"), 0.05, kRounding);
}

TEST(MotionBoundTest, DisplacementIsTravelTimesLeverArmAddedUp) {
  const auto model = test::modelOf(
      robotOf(linkOf("base") + ballAt("upper", "0 0 0") + ballAt("hand", "0.2 0 0") +
              jointOf("turn", "continuous", "base", "upper", axisOf("0 0 1")) +
              jointOf("reach", "prismatic", "upper", "hand",
                      originOf("0.1 0 0") + axisOf("1 0 0") + limitOf("-0.3", "0.4"))));
  const MotionBound bound = boundOf(*model);
  std::vector<double> travel(2);
  travel[simulation::variableIndex(*model, "turn")] = 0.5;
  travel[simulation::variableIndex(*model, "reach")] = 0.25;
  // The ball's middle is 0.2 m from its link, that at most 0.1 + 0.4 m from the axis.
  EXPECT_NEAR(bound.displacement(shapeOf(*model, "hand"), travel), 0.5 * 0.75 + 0.25, kRounding);
  EXPECT_NEAR(bound.displacement(shapeOf(*model, "upper"), travel), 0.5 * 0.05, kRounding);
  EXPECT_EQ(bound.displacement(shapeOf(*model, "hand"), {0.0, 0.0}), 0.0);
}

TEST(MotionBoundTest, ATranslationMovesEveryPointByItself) {
  const auto model = test::sliderModel();
  const MotionBound bound = boundOf(*model);
  const std::size_t slide = simulation::variableIndex(*model, "slide");
  EXPECT_EQ(leverArm(bound, *model, shapeOf(*model, "hand"), slide), 1.0);
  EXPECT_EQ(leverArm(bound, *model, shapeOf(*model, "other"), slide), 0.0)
      << "it hangs on another joint";
}

/// turn, about z, -(0.8 m)-> bend -(0.6 m)-> the hand, 0.5 m further along y.
std::string chain(const std::string& axis_of_bend) {
  return robotOf(
      linkOf("base") + linkOf("upper") + linkOf("fore") + linkOf("wrist") +
      ballAt("hand", "0.5 0 0") +
      jointOf("turn", "revolute", "base", "upper", axisOf("0 0 1") + limitOf("-3", "3")) +
      jointOf("bend", "revolute", "upper", "fore",
              originOf("0.8 0 0") + axisOf(axis_of_bend) + limitOf("-3", "3")) +
      jointOf("weld", "fixed", "fore", "wrist", originOf("0 0.6 0", "0 0 1.57079632679489662")) +
      jointOf("tip", "fixed", "wrist", "hand"));
}

TEST(MotionBoundTest, AJointFurtherUpTheChainReachesAsFarAsTheStretchedArm) {
  EXPECT_NEAR(leverArm(chain("0 0 1"), "hand", "bend"), 0.6 + 0.5 + 0.05, 1e-9);
  EXPECT_NEAR(leverArm(chain("0 0 1"), "hand", "turn"), 0.8 + 0.6 + 0.5 + 0.05, 1e-9);
}

TEST(MotionBoundTest, WhatLiesOnTheAxisOfAJointIsNotMovedByItNorFurtherByTheNext) {
  EXPECT_NEAR(leverArm(chain("0 1 0"), "hand", "bend"), 0.05, 1e-9);
  EXPECT_NEAR(leverArm(chain("0 1 0"), "hand", "turn"), std::hypot(0.8, 0.6 + 0.5) + 0.05, 1e-9);
}

TEST(MotionBoundTest, FixedJointsBetweenLeaveTheLeverArmExact) {
  // 0.5 m along x, turned into -z by the weld's pitch: on the way down the axis of the joint.
  const std::string urdf =
      robotOf(linkOf("base") + linkOf("upper") + linkOf("between") + ballAt("hand", "0.5 0 0") +
              jointOf("turn", "revolute", "base", "upper",
                      originOf("9 9 9") + axisOf("0 0 1") + limitOf("-3", "3")) +
              jointOf("weld", "fixed", "upper", "between",
                      originOf("0.3 0.4 0", "0 1.57079632679489662 0")) +
              jointOf("tip", "fixed", "between", "hand", originOf("0.1 0 0")));
  EXPECT_NEAR(leverArm(urdf, "hand", "turn"), 0.5 + 0.05, 1e-9);
}

TEST(MotionBoundTest, WhatIsFixedToTheBaseDoesNotMove) {
  const std::string urdf =
      robotOf(ballAt("base", "0 0 0") + ballAt("hand", "0.5 0 0") + ballAt("box", "1 0 0") +
              jointOf("turn", "revolute", "base", "hand", axisOf("0 0 1") + limitOf("-3", "3")) +
              jointOf("weld", "fixed", "base", "box"));
  EXPECT_EQ(leverArm(urdf, "base", "turn"), 0.0);
  EXPECT_EQ(leverArm(urdf, "box", "turn"), 0.0);
}

TEST(MotionBoundTest, ARobotWithoutJointsDoesNotMove) {
  const auto model = test::modelOf(robotOf(ballAt("base", "0 0 0") + ballAt("box", "1 0 0") +
                                           jointOf("weld", "fixed", "base", "box")));
  EXPECT_EQ(boundOf(*model).displacement(1, {}), 0.0);
}

TEST(MotionBoundTest, ASlideIsTakenAsFarOutAsItsLimits) {
  const auto turned = [](const std::string& limits) {
    return leverArm(
        robotOf(linkOf("base") + linkOf("upper") + ballAt("hand", "0 0 0") +
                jointOf("turn", "revolute", "base", "upper", axisOf("0 0 1") + limitOf("-3", "3")) +
                jointOf("reach", "prismatic", "upper", "hand",
                        originOf("0.2 0 0") + axisOf("1 0 0") + limits)),
        "hand", "turn");
  };
  EXPECT_NEAR(turned(limitOf("-0.1", "0.7")), 0.2 + 0.7 + 0.05, kRounding);
  EXPECT_GE(turned(limitOf("-0.9", "0.7")), 0.2 + 0.7 + 0.05 - kRounding);
  EXPECT_NEAR(turned(limitOf("-1.3", "0.7")), 1.3 - 0.2 + 0.05, kRounding);
  EXPECT_NEAR(turned("<limit effort=\"1\" velocity=\"1\"/>"), 0.2 + 0.05, kRounding)
      << "without limits: at zero until a way is covered";
}

TEST(MotionBoundTest, AMimicMovesByItsMultipleOfTheJointItFollows) {
  const auto follower = [](const std::string& multiplier, const std::string& type) {
    return leverArm(
        robotOf(linkOf("base") + ballAt("hand", "0.5 0 0") + ballAt("finger", "0.3 0 0") +
                jointOf("turn", "revolute", "base", "hand", axisOf("0 0 1") + limitOf("-3", "3")) +
                jointOf("follow", type, "base", "finger",
                        axisOf("0 0 1") + limitOf("-9", "9") + mimicOf("turn", multiplier, "0.1"))),
        "finger", "turn");
  };
  EXPECT_NEAR(follower("1", "revolute"), 0.35, kRounding);
  EXPECT_NEAR(follower("-2", "revolute"), 0.70, kRounding);
  EXPECT_NEAR(follower("-0.1", "prismatic"), 0.1, kRounding);
}

TEST(MotionBoundTest, AMimicOnTheSameChainAddsToTheJointItFollows) {
  const std::string urdf =
      robotOf(linkOf("base") + linkOf("upper") + ballAt("hand", "0.3 0 0") +
              jointOf("turn", "revolute", "base", "upper", axisOf("0 0 1") + limitOf("-3", "3")) +
              jointOf("follow", "revolute", "upper", "hand",
                      originOf("0.5 0 0") + axisOf("0 0 1") + limitOf("-9", "9") +
                          mimicOf("turn", "2", "0")));
  EXPECT_NEAR(leverArm(urdf, "hand", "turn"), 2.0 * 0.35 + 0.85, kRounding);
}

TEST(MotionBoundTest, ASlideThatMimicsIsAsFarOutAsItsMultipleAndOffsetTakeIt) {
  const std::string urdf = robotOf(
      linkOf("base") + linkOf("upper") + ballAt("hand", "0 0 0") + ballAt("other", "0 0 0") +
      jointOf("lead", "prismatic", "base", "other", axisOf("1 0 0") + limitOf("-0.1", "0.2")) +
      jointOf("turn", "revolute", "base", "upper", axisOf("0 0 1") + limitOf("-3", "3")) +
      jointOf("follow", "prismatic", "upper", "hand",
              axisOf("1 0 0") + limitOf("-9", "9") + mimicOf("lead", "-2", "-0.3")));
  EXPECT_NEAR(leverArm(urdf, "hand", "turn"), 2.0 * 0.2 + 0.3 + 0.05, kRounding);
}

TEST(MotionBoundTest, OnlyTheShapesAskedForAreKnownByTheirPlaceInTheList) {
  const auto model = test::sliderModel();
  const std::size_t other = shapeOf(*model, "other");
  const MotionBound bound(*model, {other}, {0.3});
  EXPECT_EQ(leverArm(bound, *model, 0, simulation::variableIndex(*model, "glide")), 1.0);
  EXPECT_EQ(leverArm(bound, *model, 0, simulation::variableIndex(*model, "slide")), 0.0);
}

TEST(MotionBoundTest, WhatShapesGrowByCounts) {
  const auto model = test::modelOf(
      robotOf(linkOf("base") + ballAt("arm", "0.5 0 0") +
              jointOf("turn", "revolute", "base", "arm", axisOf("0 0 1") + limitOf("-3", "3"))));
  EXPECT_NEAR(leverArm(MotionBound(*model, {0}, {0.25}), *model, 0, 0), 0.75, kRounding);
}

/// Points of a shape that no other of its points can outrun: how far a point is moved from one
/// place of a rigid body to another is convex in the point.
std::vector<Vector3> outermostPoints(const Shape& shape) {
  constexpr int kAround = 12;
  std::vector<Vector3> points;
  const auto ring = [&points](double radius, double z) {
    for (int k = 0; k < kAround; ++k) {
      const double angle = 2.0 * kPi * k / kAround;
      points.emplace_back(radius * std::cos(angle), radius * std::sin(angle), z);
    }
  };
  const auto ball = [&](double radius, double z) {
    for (const double latitude : {-1.2, -0.6, 0.0, 0.6, 1.2}) {
      ring(radius * std::cos(latitude), z + radius * std::sin(latitude));
    }
    points.emplace_back(0.0, 0.0, z + radius);
    points.emplace_back(0.0, 0.0, z - radius);
  };
  if (const auto* box = std::get_if<Box>(&shape)) {
    for (int corner = 0; corner < 8; ++corner) {
      const Vector3 sign(corner & 1 ? 1.0 : -1.0, corner & 2 ? 1.0 : -1.0, corner & 4 ? 1.0 : -1.0);
      points.emplace_back(box->half_extents.cwiseProduct(sign));
    }
  } else if (const auto* cylinder = std::get_if<Cylinder>(&shape)) {
    ring(cylinder->radius, cylinder->half_length);
    ring(cylinder->radius, -cylinder->half_length);
  } else if (const auto* capsule = std::get_if<Capsule>(&shape)) {
    ball(capsule->radius, capsule->half_length);
    ball(capsule->radius, -capsule->half_length);
  } else {
    ball(std::get<Sphere>(shape).radius, 0.0);
  }
  return points;
}

/// How far any point of each shape gets from where it began, on the straight way between two
/// positions.
std::vector<double> furthest(const std::shared_ptr<const RobotModel>& model,
                             const std::vector<double>& from, const std::vector<double>& to,
                             int steps) {
  Kinematics kinematics(model);
  const std::vector<Pose> roots(model->roots().size(), Pose::Identity());
  kinematics.update(from, roots);
  const std::vector<Pose> begin = kinematics.shapePoses();
  std::vector<double> result(begin.size(), 0.0);
  for (int k = 1; k <= steps; ++k) {
    std::vector<double> positions = from;
    for (std::size_t v = 0; v < from.size(); ++v) positions[v] += (to[v] - from[v]) * k / steps;
    kinematics.update(positions, roots);
    for (std::size_t i = 0; i < begin.size(); ++i) {
      for (const Vector3& point : outermostPoints(model->shapes()[i].shape)) {
        const double moved = (kinematics.shapePoses()[i] * point - begin[i] * point).norm();
        result[i] = std::max(result[i], moved);
      }
    }
  }
  return result;
}

std::vector<double> randomPositions(const RobotModel& model, Random& random) {
  std::vector<double> positions;
  for (const JointVariable& variable : model.variables()) {
    positions.push_back(
        random.uniform(variable.lower.value_or(-4.0), variable.upper.value_or(4.0)));
  }
  return positions;
}

/// Random moves, from tiny to the whole range, of all joints or some.
void expectNoPointIsFasterThanTheBound(const std::shared_ptr<const RobotModel>& model,
                                       Random& random, int moves) {
  const MotionBound bound = boundOf(*model);
  for (int move = 0; move < moves; ++move) {
    const std::vector<double> from = randomPositions(*model, random);
    std::vector<double> to = randomPositions(*model, random), travel(from.size());
    const double share = std::pow(10.0, random.uniform(-3.0, 0.0));
    for (std::size_t v = 0; v < from.size(); ++v) {
      to[v] = random.chance(0.3) ? from[v] : from[v] + share * (to[v] - from[v]);
      travel[v] = std::abs(to[v] - from[v]);
    }
    const std::vector<double> moved = furthest(model, from, to, 20);
    for (std::size_t i = 0; i < moved.size(); ++i) {
      EXPECT_LE(moved[i], bound.displacement(i, travel) + 1e-9)
          << model->linkOf(i) << " in move " << move;
    }
  }
}

TEST(MotionBoundTest, NoPointOfTheDualArmRobotMovesFurther) {
  Random random(1);
  expectNoPointIsFasterThanTheBound(simulation::dualArm(), random, 60);
}

std::string text(const Vector3& v) {
  return std::to_string(v.x()) + " " + std::to_string(v.y()) + " " + std::to_string(v.z());
}

std::string randomGeometry(Random& random) {
  const auto size = [&random] { return std::to_string(random.uniform(0.02, 0.3)); };
  switch (random.integer(0, 2)) {
    case 0:
      return "<box size=\"" + size() + " " + size() + " " + size() + "\"/>";
    case 1:
      return "<cylinder radius=\"" + size() + "\" length=\"" + size() + "\"/>";
    default:
      return test::sphereOf(size());
  }
}

/// Six joints of every kind at oblique places, each on one of the links before it; some follow the
/// first, which has limits.
std::string randomUrdf(Random& random) {
  std::string elements = linkOf("l0", collisionOf(randomGeometry(random), text(random.point(0.2))));
  for (int i = 1; i <= 6; ++i) {
    const std::string number = std::to_string(i);
    elements += linkOf("l" + number, collisionOf(randomGeometry(random), text(random.point(0.2))));
    const std::array<std::string, 4> kinds{"revolute", "prismatic", "continuous", "fixed"};
    const auto kind =
        static_cast<std::size_t>(i == 1 ? random.integer(0, 1) : random.integer(0, 3));
    std::string more = originOf(text(random.point(0.4)), text(random.point(1.5))) +
                       axisOf(text(random.direction()));
    if (kind == 0) more += limitOf("-2.5", "2");
    if (kind == 1) more += limitOf("-0.4", "0.3");
    if (i > 1 && kind != 3 && random.chance(0.3)) {
      more += mimicOf("j1", std::to_string(random.uniform(-2.0, 2.0)),
                      std::to_string(random.uniform(-1.0, 1.0)));
    }
    elements += jointOf("j" + number, kinds[kind],
                        "l" + std::to_string(random.integer(std::max(0, i - 2), i - 1)),
                        "l" + number, more);
  }
  return robotOf(elements);
}

TEST(MotionBoundTest, NoPointOfRandomRobotsMovesFurther) {
  Random random(2);
  for (int robot = 0; robot < 150; ++robot) {
    RobotModel::Config config;
    config.capsule_links = {"l1", "l3"};
    expectNoPointIsFasterThanTheBound(test::modelOf(randomUrdf(random), config), random, 6);
  }
}

/// The largest that a small move of one joint does, over many poses.
TEST(MotionBoundTest, OneJointAloneReachesAThirdOfTheBoundSomewhere) {
  constexpr double kTravel = 0.01;
  const auto model = simulation::dualArm();
  const MotionBound bound = boundOf(*model);
  Random random(3);
  const std::size_t shapes = model->shapes().size();
  for (std::size_t v = 0; v < model->variables().size(); ++v) {
    std::vector<double> largest(shapes, 0.0);
    for (int pose = 0; pose < 150; ++pose) {
      const std::vector<double> from = randomPositions(*model, random);
      std::vector<double> to = from;
      to[v] += kTravel;
      const std::vector<double> moved = furthest(model, from, to, 1);
      for (std::size_t i = 0; i < shapes; ++i) largest[i] = std::max(largest[i], moved[i]);
    }
    for (std::size_t i = 0; i < shapes; ++i) {
      EXPECT_LE(leverArm(bound, *model, i, v) * kTravel, 3.0 * largest[i])
          << model->linkOf(i) << " by " << model->variables()[v].name;
    }
  }
}

}  // namespace
}  // namespace tccm
