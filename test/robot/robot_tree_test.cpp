/// How a robot model's links hang together: fixed values, floating and planar joints, and URDFs
/// that are no tree.
#include <gtest/gtest.h>

#include <cmath>

#include "robot/kinematics.h"
#include "support/near.h"
#include "support/refusal.h"
#include "support/tiny_robot.h"
#include "tccm_monitor/config_error.h"
#include "tccm_monitor/robot_model.h"

namespace tccm {
namespace {

using namespace test::urdf_text;
using test::names;
using test::refusalOf;

using Links = std::vector<std::string>;

/// world -(free)-> base -(lift, from -0.5 to 1)-> arm, which a finger mimics.
std::string vehicle(const std::string& type) {
  return robotOf(
      linkOf("world") + ballLink("base") + ballLink("arm") + ballLink("finger") +
      jointOf("free", type, "world", "base") +
      jointOf("lift", "prismatic", "base", "arm", axisOf("0 0 1") + limitOf("-0.5", "1")) +
      jointOf("grip", "prismatic", "arm", "finger",
              axisOf("1 0 0") + limitOf("-9", "9") +
                  "<mimic joint=\"lift\" multiplier=\"2\" offset=\"0.1\"/>"));
}

TEST(RobotTreeTest, ALinkUnderAFloatingOrPlanarJointIsARootThatTransformsPlace) {
  for (const std::string type : {"floating", "planar"}) {
    const RobotModel model(vehicle(type), {});
    EXPECT_EQ(model.rootLinks(), Links{"base"}) << "nothing is watched above it";
    EXPECT_EQ(model.links(), (Links{"base", "arm", "finger"}));
    EXPECT_EQ(model.variables().size(), 1U);
  }
}

TEST(RobotTreeTest, TwoRootsAreWatchedEachWhereItIs) {
  const auto model = test::modelOf(
      robotOf(ballLink("base") + ballLink("trailer") + ballLink("mast") +
              jointOf("hitch", "planar", "base", "trailer") +
              jointOf("weld", "fixed", "trailer", "mast", "<origin xyz=\"0 0 1\"/>")));
  ASSERT_EQ(model->rootLinks(), (Links{"base", "trailer"}));
  Pose trailer = Pose::Identity();
  trailer.translation().x() = -2.0;
  Kinematics kinematics(model);
  kinematics.update({}, {Pose::Identity(), trailer});
  EXPECT_TRUE(test::isNearly(Vector3(kinematics.linkPoses()[0].translation()), Vector3::Zero(), 0));
  EXPECT_TRUE(test::isNearly(Vector3(kinematics.linkPoses()[2].translation()),
                             Vector3(-2.0, 0.0, 1.0), 1e-12));
}

/// base -(weld)-> mast -(turn)-> head -(screw)-> camera
std::string lookout() {
  return robotOf(ballLink("base") + ballLink("mast") + ballLink("head") + linkOf("camera") +
                 jointOf("weld", "fixed", "base", "mast", "<origin xyz=\"0 0 1\"/>") +
                 jointOf("turn", "continuous", "mast", "head", axisOf("0 0 1")) +
                 jointOf("screw", "fixed", "head", "camera", "<origin xyz=\"0.1 0 0\"/>"));
}

std::shared_ptr<const RobotModel> lookoutTrusting(const std::vector<std::string>& frames,
                                                  const std::string& prefix = "") {
  RobotModel::Config config;
  config.trusted_frames = frames;
  config.tf_prefix = prefix;
  return test::modelOf(lookout(), config);
}

TEST(RobotTreeTest, ATrustedLinkThatNoJointMovesIsARoot) {
  for (const char* name : {"mast", "m?st", "robots/one/mast"}) {
    const auto model = lookoutTrusting({name}, "/robots/one");
    EXPECT_EQ(model->rootLinks(), (Links{"base", "mast"})) << name;
    EXPECT_EQ(model->variables().size(), 1U) << "the head still turns";
    EXPECT_TRUE(model->warnings().empty());
  }
}

TEST(RobotTreeTest, ATrustedLinkThatAJointMovesKeepsItsWayAheadAndItIsTold) {
  const auto model = lookoutTrusting({"head"});
  EXPECT_EQ(model->rootLinks(), Links{"base"});
  EXPECT_EQ(model->variables().size(), 1U);
  ASSERT_EQ(model->warnings().size(), 1U);
  EXPECT_TRUE(names(model->warnings()[0], "'head'"));
  EXPECT_EQ(model->frames().roots.size(), 2U) << "it is compared from there on";
}

TEST(RobotTreeTest, ATrustedNameThatMeansNoLinkIsTold) {
  const auto model = lookoutTrusting({"laser"});
  ASSERT_EQ(model->warnings().size(), 1U);
  EXPECT_TRUE(names(model->warnings()[0], "'laser'"));
}

TEST(RobotTreeTest, FramesHaveAllLinksAlsoThoseThatAreNotWatched) {
  const auto model = lookoutTrusting({});
  EXPECT_EQ(model->links(), (Links{"base", "mast", "head"}));
  EXPECT_EQ(model->frames().links, (Links{"base", "mast", "head", "camera"}));
}

TEST(RobotTreeTest, AJointThatMakesNoSenseIsLeftOutOfTheFramesWithWhatHangsOnIt) {
  const auto model = test::modelOf(
      robotOf(ballLink("base") + linkOf("a") + linkOf("b") + linkOf("c") +
              jointOf("odd", "revolute", "base", "a", axisOf("1 0 0") + limitOf("1", "-1")) +
              jointOf("weld", "fixed", "a", "b") + jointOf("other", "fixed", "base", "c")));
  EXPECT_EQ(model->frames().links, (Links{"base", "c"}));
}

TEST(RobotTreeTest, FramesAreNamedAsRobotStatePublisherNamesThem) {
  EXPECT_EQ(lookoutTrusting({})->frameOf("base"), "base");
  EXPECT_EQ(lookoutTrusting({})->frameOf("/base"), "base");
  for (const char* prefix : {"left", "/left"}) {
    const auto model = lookoutTrusting({}, prefix);
    EXPECT_EQ(model->frameOf("base"), "left/base");
    EXPECT_EQ(model->frameOf("/base"), "base");
    EXPECT_EQ(model->rootFrames(), Links{"left/base"});
    EXPECT_EQ(model->rootLinks(), Links{"base"});
  }
}

TEST(RobotTreeTest, AMimicOfAJointWithoutPositionIsRefused) {
  const std::string urdf = robotOf(
      ballLink("a") + ballLink("b") + ballLink("c") + jointOf("weld", "fixed", "a", "b") +
      jointOf("follow", "continuous", "b", "c", axisOf("1 0 0") + "<mimic joint=\"weld\"/>"));
  EXPECT_TRUE(names(refusalOf(urdf), "'follow'"));
}

TEST(RobotTreeTest, AFixedValueStandsInForAJointThatNobodyPublishes) {
  RobotModel::Config config;
  config.fixed_joints["lift"] = 0.25;
  const auto model = test::modelOf(vehicle("floating"), config);
  EXPECT_TRUE(model->variables().empty());
  Kinematics kinematics(model);
  kinematics.update({}, {Pose::Identity()});
  EXPECT_TRUE(test::isNearly(Vector3(kinematics.linkPoses()[2].translation()),
                             Vector3(0.6, 0.0, 0.25), 1e-12))
      << "its mimic follows";
}

TEST(RobotTreeTest, AFixedValueForNoJointOrBeyondItsLimitsIsRefusedNamingIt) {
  const auto refused = [](const std::string& joint, double position) {
    RobotModel::Config config;
    config.fixed_joints[joint] = position;
    return refusalOf(vehicle("floating"), config);
  };
  EXPECT_EQ(refused("lift", 1.0), "");
  EXPECT_TRUE(names(refused("lift", 1.1), "fixed_joints/lift"));
  EXPECT_TRUE(names(refused("lift", std::nan("")), "fixed_joints/lift"));
  EXPECT_TRUE(names(refused("elbow", 0.0), "fixed_joints/elbow"));
  EXPECT_TRUE(names(refused("grip", 0.0), "fixed_joints/grip")) << "it mimics another";
  EXPECT_TRUE(names(refused("free", 0.0), "fixed_joints/free"));
}

TEST(RobotTreeTest, ALinkWithTwoParentsIsRefusedNamingItAndBothJoints) {
  const std::string message = refusalOf(
      robotOf(ballLink("a") + ballLink("b") + ballLink("c") + jointOf("ab", "fixed", "a", "b") +
              jointOf("ac", "fixed", "a", "c") + jointOf("bc", "fixed", "b", "c")));
  EXPECT_TRUE(names(message, "'c'") && names(message, "'ac'") && names(message, "'bc'")) << message;
}

TEST(RobotTreeTest, ACircleOfLinksIsRefused) {
  EXPECT_NE(refusalOf(robotOf(ballLink("a") + ballLink("b") + jointOf("ab", "fixed", "a", "b") +
                              jointOf("ba", "fixed", "b", "a"))),
            "");
  const std::string beside =
      refusalOf(robotOf(ballLink("base") + ballLink("a") + ballLink("b") +
                        jointOf("ab", "fixed", "a", "b") + jointOf("ba", "fixed", "b", "a")));
  EXPECT_TRUE(names(beside, "link 'a'") && names(beside, "circle")) << beside;
  EXPECT_NE(refusalOf(robotOf(ballLink("a") + jointOf("aa", "fixed", "a", "a"))), "");
}

TEST(RobotTreeTest, NamesKeepWhatXmlEscapesAndCommentsMayHoldWhatTheyLike) {
  const RobotModel model(robotOf("<!-- " + std::string(5000, '=') + "<a b='c' -->" +
                                 ballLink("a&lt;b&amp;amp;&quot;&apos;&gt;&#x42; \xc3\xa9")),
                         {});
  EXPECT_EQ(model.links(), Links{"a<b&amp;\"'>B \xc3\xa9"});
}

TEST(RobotTreeTest, WhatIsNoXmlIsRefusedNamingTheLine) {
  for (const std::string wrong : {"<link name=a/>", "<link name='a' name='b'/>", "<link></joint>",
                                  "<link", "<!-- ", "<link name='a'>\xe9</link>"}) {
    const std::string message = refusalOf("<robot name=\"x\">\n" + ballLink("a") + "\n" + wrong);
    EXPECT_TRUE(names(message, "line 3") || names(message, "UTF-8")) << wrong << ": " << message;
  }
}

TEST(RobotTreeTest, WhatTheParserFindsWrongIsNamed) {
  EXPECT_TRUE(names(
      refusalOf(robotOf(ballLink("a") + ballLink("b") + jointOf("ab", "ball", "a", "b"))), "ab"));
  EXPECT_TRUE(
      names(refusalOf(robotOf(test::linkOf("a", test::collisionOf(test::sphereOf("wide"))))), "a"));
  EXPECT_TRUE(
      names(refusalOf(robotOf(ballLink("a") + jointOf("ab", "fixed", "a", "lost"))), "lost"));
  EXPECT_TRUE(names(refusalOf(robotOf(linkOf("base", test::collisionOf(test::sphereOf("nan"))))),
                    "[base]"));
  EXPECT_TRUE(names(refusalOf(robotOf(linkOf("base", test::collisionOf(test::sphereOf("-0.1"))))),
                    "link 'base'"));
}

TEST(RobotTreeTest, AFaultOnOneLinkOfManyIsNotPassedOver) {
  const std::string broken_visual =
      "<visual><geometry><sphere radius=\"nan\"/></geometry></visual>";
  for (const std::string& parts :
       {test::collisionOf(test::sphereOf("nan")), test::collisionOf("<mesh/>"),
        test::collisionOf("<blob/>"), broken_visual + test::collisionOf(test::sphereOf("0.1"))}) {
    const std::string message = refusalOf(
        robotOf(ballLink("base") + linkOf("hand", parts) + jointOf("j", "fixed", "base", "hand")));
    EXPECT_TRUE(names(message, "hand")) << parts << ": " << message;
  }
}

TEST(RobotTreeTest, GarbageOfTenMegabytesIsRefusedAtOnce) {
  std::string deep = "<robot name=\"deep\">";
  for (int i = 0; i < 500000; ++i) deep += "<link name=\"a\">";
  EXPECT_TRUE(names(refusalOf(deep), "nested"));
  EXPECT_TRUE(names(refusalOf("<robot name=\"x\" " + std::string(10000000, 'a') + ">"), "tag"));
  EXPECT_NE(refusalOf(std::string(10000000, '<')), "");
  EXPECT_NE(refusalOf(std::string(10000000, '\0')), "");
  EXPECT_TRUE(names(refusalOf(std::string(40000000, ' ')), "32 MB"));
  EXPECT_EQ(refusalOf("<?xml version=\"1.0\"?><!-- <a><b> --><robot name=\"x\">" + ballLink("a") +
                      "<!-- " + std::string(1000, '<') + " --></robot>"),
            "");
}

}  // namespace
}  // namespace tccm
