#include "tccm_monitor/robot_model.h"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "robot/link_use.h"
#include "support/near.h"
#include "support/refusal.h"
#include "support/shared_data.h"
#include "support/tiny_robot.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

using namespace test::urdf_text;
using test::refusalOf;

::testing::AssertionResult refusedNaming(const std::string& what, const std::string& urdf,
                                         const RobotModel::Config& config = {}) {
  const std::string message = refusalOf(urdf, config);
  if (message.empty()) return ::testing::AssertionFailure() << "it was taken";
  if (message.find('\n') != std::string::npos) {
    return ::testing::AssertionFailure() << "more than one line: " << message;
  }
  if (message.find(what) != std::string::npos) return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure() << "'" << message << "' does not name " << what;
}

std::string oneLink(const std::string& geometry) {
  return robotOf(linkOf("base", collisionOf(geometry)));
}

/// base, and "hand" with a ball, joined as stated.
std::string twoLinks(const std::string& type, const std::string& more) {
  return robotOf(linkOf("base") + ballLink("hand") + jointOf("wrist", type, "base", "hand", more));
}

RobotModel::Config monitoring(const std::vector<std::string>& patterns) {
  RobotModel::Config config;
  config.monitored_links = patterns;
  return config;
}

std::vector<std::size_t> shapesOf(const RobotModel& model, const std::vector<std::string>& links) {
  LinkUse use;
  use.links = links;
  return model.shapesFor(use, kCollisionKeys).shapes;
}

TEST(RobotModelTest, TextThatIsNoUrdfIsRefused) {
  EXPECT_TRUE(refusedNaming("robot_description", ""));
  EXPECT_TRUE(refusedNaming("robot_description", "garbage"));
  EXPECT_TRUE(refusedNaming("robot_description", "<robot name=\"x\">"));
  EXPECT_TRUE(refusedNaming("robot_description", robotOf("")));
}

TEST(RobotModelTest, TwoRootsAreRefused) {
  EXPECT_TRUE(refusedNaming("robot_description", robotOf(ballLink("one") + ballLink("two"))));
}

TEST(RobotModelTest, ARobotWithoutAnyCollisionElementIsRefused) {
  EXPECT_TRUE(refusedNaming("collision", robotOf(linkOf("base"))));
}

TEST(RobotModelTest, AMeshThatCannotBeReadIsRefusedNamingTheLink) {
  const std::string mesh = collisionOf("<mesh filename=\"package://a/b.stl\"/>");
  const std::string urdf =
      robotOf(linkOf("base", mesh) + ballLink("hand") + jointOf("wrist", "fixed", "base", "hand"));
  EXPECT_TRUE(refusedNaming("'base'", urdf));
  EXPECT_TRUE(refusedNaming("'base'", urdf, monitoring({"b*"})));
  EXPECT_EQ(refusalOf(urdf, monitoring({"hand"})), "");
}

TEST(RobotModelTest, AMeshThatCannotBeReadBesideAPrimitiveIsRefusedToo) {
  const std::string mesh = collisionOf("<mesh filename=\"package://a/b.stl\"/>");
  EXPECT_TRUE(
      refusedNaming("'base'", robotOf(linkOf("base", collisionOf(sphereOf("0.1")) + mesh))));
}

TEST(RobotModelTest, AMonitoredLinkWithoutCollisionElementIsRefusedNamingIt) {
  const std::string urdf = twoLinks("fixed", "");
  EXPECT_TRUE(refusedNaming("'base'", urdf, monitoring({"base"})));
  EXPECT_TRUE(refusedNaming("'base'", urdf, monitoring({"*"})));
}

TEST(RobotModelTest, APatternThatMatchesNoLinkIsRefusedNamingKeyAndPattern) {
  const std::string urdf = twoLinks("fixed", "");
  EXPECT_TRUE(refusedNaming("monitored_links", urdf, monitoring({"hand", "hnad*"})));
  EXPECT_TRUE(refusedNaming("'hnad*'", urdf, monitoring({"hand", "hnad*"})));
  RobotModel::Config capsules;
  capsules.capsule_links = {"arm?"};
  EXPECT_TRUE(refusedNaming("capsule_links", urdf, capsules));
  EXPECT_TRUE(refusedNaming("'arm?'", urdf, capsules));
}

TEST(RobotModelTest, AMimicOfAJointThatIsNotThereIsRefused) {
  EXPECT_NE(refusalOf(twoLinks("continuous", "<mimic joint=\"nothing\"/>")), "");
}

TEST(RobotModelTest, MimicsInACircleAreRefusedNamingOneOfThem) {
  const std::string urdf =
      robotOf(linkOf("base") + linkOf("middle") + ballLink("hand") +
              jointOf("first", "continuous", "base", "middle", "<mimic joint=\"second\"/>") +
              jointOf("second", "continuous", "middle", "hand", "<mimic joint=\"first\"/>"));
  EXPECT_TRUE(refusedNaming("'first'", urdf));
  EXPECT_NE(refusalOf(twoLinks("continuous", "<mimic joint=\"wrist\"/>")), "");
}

TEST(RobotModelTest, AnAxisWithoutDirectionIsRefusedNamingTheJoint) {
  EXPECT_TRUE(refusedNaming("'wrist'", twoLinks("continuous", axisOf("0 0 1e-9"))));
  EXPECT_TRUE(refusedNaming("'wrist'", twoLinks("prismatic", axisOf("0 0 0") + limitOf("0", "1"))));
}

TEST(RobotModelTest, SizesThatAreNoSizesAreRefused) {
  for (const std::string size : {"nan", "inf", "-0.1", "1e9"}) {
    EXPECT_NE(refusalOf(oneLink(sphereOf(size))), "") << size;
    EXPECT_NE(refusalOf(oneLink("<box size=\"0.1 0.1 " + size + "\"/>")), "") << size;
    EXPECT_NE(refusalOf(oneLink("<cylinder radius=\"0.1\" length=\"" + size + "\"/>")), "") << size;
    EXPECT_NE(refusalOf(oneLink("<cylinder radius=\"" + size + "\" length=\"0.1\"/>")), "") << size;
  }
  EXPECT_TRUE(refusedNaming("'base'", oneLink(sphereOf("-0.1"))));
}

TEST(RobotModelTest, AnOriginThatIsNotFiniteIsRefused) {
  EXPECT_NE(refusalOf(robotOf(linkOf("base", collisionOf(sphereOf("0.1"), "0 nan 0")))), "");
  EXPECT_NE(refusalOf(twoLinks("fixed", "<origin xyz=\"0 0 inf\"/>")), "");
}

TEST(RobotModelTest, ALowerLimitAboveTheUpperIsRefusedNamingTheJoint) {
  EXPECT_TRUE(refusedNaming("'wrist'", twoLinks("revolute", limitOf("1", "-1"))));
}

TEST(RobotModelTest, AFloatingJointThatMovesNoMonitoredLinkIsNoMatter) {
  const std::string urdf = robotOf(ballLink("base") + ballLink("balloon") +
                                   jointOf("string", "floating", "base", "balloon"));
  EXPECT_EQ(refusalOf(urdf, monitoring({"base"})), "");
}

std::string chain() {
  return robotOf(ballLink("base") + ballLink("arm_1") + ballLink("arm_2") + ballLink("head") +
                 jointOf("shoulder", "revolute", "base", "arm_1", limitOf("-1", "2")) +
                 jointOf("elbow", "continuous", "arm_1", "arm_2") +
                 jointOf("neck", "prismatic", "base", "head", limitOf("0", "0.3")));
}

TEST(RobotModelTest, WithoutPatternsEveryLinkWithACollisionElementIsMonitored) {
  const RobotModel model(twoLinks("continuous", ""), {});
  ASSERT_EQ(model.shapes().size(), 1U);
  EXPECT_EQ(model.linkOf(0), "hand");
  EXPECT_EQ(RobotModel(chain(), {}).shapes().size(), 4U);
}

TEST(RobotModelTest, PatternsChooseLinksByStarAndQuestionMark) {
  EXPECT_EQ(RobotModel(chain(), monitoring({"arm_?"})).shapes().size(), 2U);
  EXPECT_EQ(RobotModel(chain(), monitoring({"a*", "head"})).shapes().size(), 3U);
  EXPECT_EQ(RobotModel(chain(), monitoring({"*_2", "arm_2"})).shapes().size(), 1U);
}

TEST(RobotModelTest, OnlyJointsThatMoveMonitoredLinksAreVariables) {
  const RobotModel model(chain(), monitoring({"arm_1"}));
  ASSERT_EQ(model.variables().size(), 1U);
  EXPECT_EQ(model.variables()[0].name, "shoulder");
  EXPECT_EQ(model.links(), (std::vector<std::string>{"base", "arm_1"}));
  EXPECT_TRUE(model.hasJoint("elbow"));
  EXPECT_TRUE(model.hasJoint("neck"));
  EXPECT_FALSE(model.hasJoint("arm_1"));
}

TEST(RobotModelTest, LimitsAreKeptForAllButContinuousJoints) {
  const RobotModel model(chain(), {});
  for (const JointVariable& variable : model.variables()) {
    EXPECT_EQ(variable.lower.has_value(), variable.name != "elbow") << variable.name;
    EXPECT_EQ(variable.upper.has_value(), variable.name != "elbow") << variable.name;
    if (variable.name != "shoulder") continue;
    EXPECT_EQ(variable.lower, -1.0);
    EXPECT_EQ(variable.upper, 2.0);
  }
}

TEST(RobotModelTest, ParentsComeBeforeTheirChildren) {
  const RobotModel model(chain(), {});
  EXPECT_EQ(model.name(), "tiny");
  EXPECT_EQ(model.rootLinks(), std::vector<std::string>{"base"});
  ASSERT_EQ(model.joints().size() + 1, model.links().size());
  for (const RobotJoint& joint : model.joints()) EXPECT_LT(joint.parent, joint.child);
}

TEST(RobotModelTest, EveryCollisionElementOfALinkIsAShape) {
  const std::string three = collisionOf(sphereOf("0.1"), "1 0 0") +
                            collisionOf("<box size=\"0.2 0.4 0.6\"/>", "0 2 0") +
                            collisionOf("<cylinder radius=\"0.3\" length=\"0.8\"/>", "0 0 3");
  const RobotModel model(robotOf(linkOf("base", three)), {});
  ASSERT_EQ(model.shapes().size(), 3U);
  EXPECT_EQ(std::get<Sphere>(model.shapes()[0].shape).radius, 0.1);
  EXPECT_TRUE(test::isNearly(std::get<Box>(model.shapes()[1].shape).half_extents,
                             Vector3(0.1, 0.2, 0.3), 1e-12));
  EXPECT_EQ(std::get<Cylinder>(model.shapes()[2].shape).radius, 0.3);
  EXPECT_EQ(std::get<Cylinder>(model.shapes()[2].shape).half_length, 0.4);
  for (int i = 0; i < 3; ++i) {
    const Vector3 expected = (i + 1.0) * Vector3::Unit(i);
    const LinkShape& shape = model.shapes()[static_cast<std::size_t>(i)];
    EXPECT_TRUE(test::isNearly(Vector3(shape.T_link_shape.translation()), expected, 1e-12));
    EXPECT_EQ(shape.link, 0U);
  }
}

TEST(RobotModelTest, CylindersOfCapsuleLinksKeepTheirStraightPart) {
  RobotModel::Config config;
  config.capsule_links = {"base"};
  const RobotModel model(oneLink("<cylinder radius=\"0.1\" length=\"0.5\"/>"), config);
  const auto& capsule = std::get<Capsule>(model.shapes()[0].shape);
  EXPECT_EQ(capsule.radius, 0.1);
  EXPECT_EQ(capsule.half_length, 0.25);
}

TEST(RobotModelTest, AMimicFollowsItsSourceThroughOthers) {
  const std::string urdf =
      robotOf(linkOf("base") + linkOf("a") + linkOf("b") + ballLink("c") +
              jointOf("first", "continuous", "base", "a") +
              jointOf("second", "continuous", "a", "b",
                      "<mimic joint=\"first\" multiplier=\"2\" offset=\"0.5\"/>") +
              jointOf("third", "continuous", "b", "c",
                      "<mimic joint=\"second\" multiplier=\"-3\" offset=\"0.25\"/>"));
  const RobotModel model(urdf, {});
  ASSERT_EQ(model.variables().size(), 1U);
  EXPECT_EQ(model.variables()[0].name, "first");
  const RobotJoint& third = model.joints().back();
  EXPECT_EQ(third.name, "third");
  EXPECT_DOUBLE_EQ(third.multiplier, -6.0);
  EXPECT_DOUBLE_EQ(third.offset, -3.0 * 0.5 + 0.25);
}

TEST(RobotModelTest, AMimicOnTheWayNeedsItsSourceAlsoWhereThatMovesNothingElse) {
  const std::string urdf =
      robotOf(linkOf("base") + linkOf("drive") + ballLink("finger") +
              jointOf("motor", "prismatic", "base", "drive", limitOf("0", "1")) +
              jointOf("follower", "prismatic", "base", "finger",
                      limitOf("0", "1") + "<mimic joint=\"motor\"/>"));
  const RobotModel model(urdf, {});
  ASSERT_EQ(model.variables().size(), 1U);
  EXPECT_EQ(model.variables()[0].name, "motor");
}

TEST(RobotModelTest, ShapesOfAPatternAreFoundAndAWrongOneIsRefusedNamingItsKey) {
  const RobotModel model(chain(), {});
  EXPECT_EQ(shapesOf(model, {}).size(), 4U);
  EXPECT_EQ(shapesOf(model, {"arm_*"}).size(), 2U);
  try {
    (void)shapesOf(model, {"leg"});
    FAIL() << "it was taken";
  } catch (const ConfigError& error) {
    EXPECT_NE(std::string(error.what()).find("collision_links: 'leg'"), std::string::npos);
  }
}

TEST(RobotModelTest, ALinkThatIsNotMonitoredHasNoShapesToChoose) {
  const RobotModel model(chain(), monitoring({"arm_2"}));
  EXPECT_THROW((void)shapesOf(model, {"arm_1"}), ConfigError);
}

TEST(RobotModelTest, Pr2Has17LinksWithPrimitives) {
  std::ifstream file(test::sharedDataFolder() + "/robots/pr2_moveit/pr2.urdf");
  if (!file) GTEST_SKIP() << "robots/pr2_moveit/pr2.urdf is not in the shared data";
  std::stringstream urdf;
  urdf << file.rdbuf();
  EXPECT_NE(refusalOf(urdf.str()), "") << "most of PR2's links have meshes";
  const RobotModel model(
      urdf.str(), monitoring({"base_footprint", "base_bellow_link", "??_caster_?_wheel_link",
                              "head_plate_frame", "head_mount_link", "head_mount_kinect_ir_link",
                              "head_mount_kinect_rgb_link", "head_mount_prosilica_link",
                              "?_gripper_motor_accelerometer_link"}));
  EXPECT_EQ(model.shapes().size(), 17U);
  EXPECT_TRUE(model.hasJoint("r_gripper_r_finger_joint"));
  for (const JointVariable& variable : model.variables()) {
    EXPECT_EQ(variable.name.find("finger"), std::string::npos) << variable.name;
  }
}

}  // namespace
}  // namespace tccm
