/// Slides without limits, or measured beyond them, and what mimics such: far out they make long
/// levers.

#include <gtest/gtest.h>

#include <cmath>

#include "robot/kinematics.h"
#include "robot/motion_bound.h"
#include "support/random.h"
#include "support/tiny_robot.h"

namespace tccm {
namespace {

using namespace test::urdf_text;
using test::Random;

const std::vector<Pose> kAtOrigin{Pose::Identity()};
const std::string kNoLimits = "<limit effort=\"1\" velocity=\"1\"/>";

std::string text(const Vector3& v) {
  return std::to_string(v.x()) + " " + std::to_string(v.y()) + " " + std::to_string(v.z());
}

std::string mimicOf(const std::string& joint, double multiplier, double offset) {
  return "<mimic joint=\"" + joint + "\" multiplier=\"" + std::to_string(multiplier) +
         "\" offset=\"" + std::to_string(offset) + "\"/>";
}

/// Of the bound the first shape's, on a way from one place to the other.
MotionBound boundAlong(const RobotModel& model, const JointPath& way) {
  std::vector<std::size_t> shapes;
  std::vector<double> radii;
  for (std::size_t i = 0; i < model.shapes().size(); ++i) {
    shapes.push_back(i);
    radii.push_back(boundingRadius(model.shapes()[i].shape));
  }
  MotionBound bound(model, shapes, radii);
  bound.cover(way);
  return bound;
}

/// A turning joint, and a slide on it that carries a ball of 50 mm.
std::shared_ptr<const RobotModel> turningSlide(const std::string& limits) {
  return test::modelOf(
      robotOf(linkOf("base") + linkOf("upper") + ballLink("hand") +
              jointOf("turn", "continuous", "base", "upper", axisOf("0 0 1")) +
              jointOf("reach", "prismatic", "upper", "hand", axisOf("1 0 0") + limits)));
}

double leverOfTurn(const std::string& limits, double from, double to) {
  const auto model = turningSlide(limits);
  const std::size_t turn = model->variables()[0].name == "turn" ? 0 : 1;
  JointPath way(2);
  for (const double reach : {from, to}) {
    std::vector<double> positions(2, 0.0);
    positions[1 - turn] = reach;
    way.add(way.empty() ? 0.0 : 1.0, positions);
  }
  return boundAlong(*model, way).leverArms(0)[turn];
}

TEST(MotionBoundSlidesTest, WithoutLimitsTheLeverIsAsLongAsTheWayLeads) {
  EXPECT_NEAR(leverOfTurn(kNoLimits, 6.0, 6.2), 6.2 + 0.05, 1e-12);
  EXPECT_NEAR(leverOfTurn(kNoLimits, -7.5, 6.2), 7.5 + 0.05, 1e-12);
  EXPECT_NEAR(leverOfTurn(kNoLimits, 0.0, 0.1), 0.1 + 0.05, 1e-12);
}

TEST(MotionBoundSlidesTest, BeyondALimitItGrowsByWhatIsBeyond) {
  EXPECT_NEAR(leverOfTurn(limitOf("-0.2", "0.6"), 0.1, 0.5), 0.6 + 0.05, 1e-12);
  EXPECT_NEAR(leverOfTurn(limitOf("-0.2", "0.6"), 0.1, 0.75), 0.75 + 0.05, 1e-12);
}

TEST(MotionBoundSlidesTest, AWayWithinTheLimitsMakesItAsShortAsBefore) {
  const auto model = turningSlide(kNoLimits);
  MotionBound bound = boundAlong(*model, [] {
    JointPath way(2);
    way.add(0.0, {6.0, 6.0});
    return way;
  }());
  JointPath home(2);
  home.add(0.0, {0.0, 0.0});
  bound.cover(home);
  EXPECT_NEAR(bound.leverArms(0)[model->variables()[0].name == "turn" ? 0 : 1], 0.05, 1e-12);
}

/// A chain of joints, most of which slide, with and without limits; some mimic another.
std::string randomChain(Random& random, int links) {
  std::string elements = linkOf("l0");
  for (int i = 1; i <= links; ++i) {
    const std::string number = std::to_string(i);
    elements +=
        linkOf("l" + number, collisionOf(test::sphereOf(std::to_string(random.uniform(0.02, 0.3))),
                                         text(random.point(0.2))));
    const bool slides = random.chance(0.6);
    std::string more = "<origin xyz=\"" + text(random.point(0.4)) + "\" rpy=\"" +
                       text(random.point(1.5)) + "\"/>" + axisOf(text(random.direction()));
    if (slides) more += random.chance(0.4) ? limitOf("-0.4", "0.3") : kNoLimits;
    if (i > 1 && random.chance(0.4)) {
      more += mimicOf("j1", random.uniform(-2.0, 2.0), random.uniform(-1.0, 1.0));
    }
    elements += jointOf("j" + number, slides ? "prismatic" : "continuous",
                        "l" + std::to_string(i - 1), "l" + number, more);
  }
  return robotOf(elements);
}

/// Somewhere far out: within its limits or beyond them.
std::vector<double> somewhere(const RobotModel& model, Random& random) {
  std::vector<double> positions;
  for (std::size_t v = 0; v < model.variables().size(); ++v) {
    const double reach = random.chance(0.5) ? 1.0 : random.uniform(1.0, 12.0);
    positions.push_back(random.uniform(-reach, reach));
  }
  return positions;
}

/// Of random motions those that take a ball further than the bound, by placing it again and again.
int motionsBeyondTheBound(const std::shared_ptr<const RobotModel>& model, Random& random,
                          int motions) {
  constexpr int kSteps = 12;
  Kinematics kinematics(model);
  int beyond = 0;
  std::vector<double> positions;
  for (int motion = 0; motion < motions; ++motion) {
    const std::vector<double> from = somewhere(*model, random);
    std::vector<double> to = somewhere(*model, random);
    const double share = std::pow(10.0, random.uniform(-3.0, 0.0));
    for (std::size_t v = 0; v < from.size(); ++v) to[v] = from[v] + share * (to[v] - from[v]);
    JointPath way(from.size());
    way.add(0.0, from);
    way.add(1.0, to);
    const MotionBound bound = boundAlong(*model, way);
    kinematics.update(from, kAtOrigin);
    const std::vector<Pose> begin = kinematics.shapePoses();
    bool is_beyond = false;
    for (int k = 1; k <= kSteps; ++k) {
      way.positionsAt(1.0 * k / kSteps, positions);
      kinematics.update(positions, kAtOrigin);
      std::vector<double> travel(from.size());
      way.travelUntil(1.0 * k / kSteps, travel);
      for (std::size_t i = 0; i < begin.size(); ++i) {
        const double most = bound.displacement(i, travel) + 1e-9;
        const double radius = std::get<Sphere>(model->shapes()[i].shape).radius;
        for (int axis = 0; axis < 3; ++axis) {
          for (const double end : {-radius, radius}) {
            const Vector3 p_shape = end * Vector3::Unit(axis);
            const Vector3 moved = kinematics.shapePoses()[i] * p_shape - begin[i] * p_shape;
            is_beyond = is_beyond || moved.norm() > most;
          }
        }
      }
    }
    if (is_beyond) ++beyond;
  }
  return beyond;
}

TEST(MotionBoundSlidesTest, NoneOf180000RandomMotionsLeadsFurther) {
  Random random(19);
  int beyond = 0;
  for (int robot = 0; robot < 600; ++robot) {
    const auto model = test::modelOf(randomChain(random, random.integer(2, 4)));
    beyond += motionsBeyondTheBound(model, random, 300);
  }
  EXPECT_EQ(beyond, 0);
}

}  // namespace
}  // namespace tccm
