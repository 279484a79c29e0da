/// Robot descriptions that are garbage, or made to do harm: one line that names the element, soon.
#include <gtest/gtest.h>

#include <ctime>
#include <string>
#include <vector>

#include "support/random.h"
#include "support/tiny_robot.h"
#include "tccm_monitor/config_error.h"
#include "tccm_monitor/robot_model.h"

namespace tccm {
namespace {

using namespace test::urdf_text;

constexpr std::size_t kTenMegabytes = 10'000'000;
constexpr double kSoon = 4.0;  // [s] of the processor's time

/// The one line by which a description is refused; empty where it is taken.
std::string refusal(const std::string& urdf, const RobotResources& resources = {}) {
  const std::clock_t begin = std::clock();
  std::string message;
  try {
    const RobotModel model(urdf, {}, resources);
  } catch (const ConfigError& error) {
    message = error.what();
    EXPECT_FALSE(message.empty());
    EXPECT_LT(message.size(), 1100U);
    for (const unsigned char c : message) EXPECT_GE(c, 0x20U) << message;
  }
  EXPECT_LT(static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC, kSoon);
  return message;
}

bool names(const std::string& message, const std::string& what) {
  return message.find(what) != std::string::npos;
}

std::string times(const std::string& text, std::size_t count) {
  std::string repeated;
  repeated.reserve(text.size() * count);
  for (std::size_t i = 0; i < count; ++i) repeated += text;
  return repeated;
}

std::string numbered(const std::string& name, int i) { return name + std::to_string(i); }

/// A base and a hand with what is put on it.
std::string withHand(const std::string& parts, const std::string& joint = "") {
  return robotOf(ballLink("base") + linkOf("hand", parts) +
                 jointOf("wrist", "continuous", "base", "hand", joint));
}

TEST(RobotGarbageTest, RandomBytesAreRefused) {
  test::Random random(1);
  std::string bytes;
  for (std::size_t i = 0; i < kTenMegabytes; ++i) {
    bytes += static_cast<char>(random.integer(0, 255));
  }
  EXPECT_TRUE(names(refusal(bytes), "line 1:"));
  const std::string marks = "<>/\"'=! ?-[]ab\n";
  std::string looks_like_xml;
  for (std::size_t i = 0; i < kTenMegabytes; ++i) {
    looks_like_xml += marks[static_cast<std::size_t>(random.integer(0, 14))];
  }
  EXPECT_NE(refusal(looks_like_xml), "");
  EXPECT_NE(refusal("<robot name=\"x\">" + looks_like_xml), "");
}

TEST(RobotGarbageTest, DeepNestingIsFoundBehindWhateverHidesItFromAScanner) {
  const std::string deep = times("<a>", 100000);
  const std::string comment = deep + "-->";  // as it looks where one began before it
  for (const std::string& hidden :
       {deep, "<!--> <![CDATA[ -->" + deep + "]]>", "<! <!-- >" + comment, "</ <!-- >" + comment,
        "<![CDATA[]]>" + deep, "<?xml version=\"> <!-- \"?>" + comment,
        "<?xml ' version=\"' > <!-- \" ?>" + comment, "<?xml x=\" version=\" ><!-- \" ?>" + comment,
        "<?xml x=\"> " + deep + "\" ?>", "<?xml version='1.0'?><\xc3\xa9 b='> <!-- '>" + comment,
        "<a b='\xf0'/>'><!-- " + comment}) {
    EXPECT_NE(refusal(hidden), "") << hidden.substr(0, 40);
    EXPECT_NE(refusal("<robot name=\"x\">" + hidden), "") << hidden.substr(0, 40);
  }
}

TEST(RobotGarbageTest, WhatIsCutOffWithinACharacterIsRefused) {
  for (const std::string end : {"\xf0", "\xef", "\xef\xbb", "\xc3"}) {
    for (const std::string begin : {"<?xml version=\"1.0\"?><robot name=\"", "\xef\xbb\xbf<robot>",
                                    "\xef\xbb\xbf<a", "\xef\xbb\xbf"}) {
      EXPECT_TRUE(names(refusal(begin + end), "UTF-8")) << begin;
    }
  }
  EXPECT_EQ(refusal("\xef\xbb\xbf<?xml version=\"1.0\" encoding='utf-8'?><!-- \xe9 -->\n" +
                    robotOf(ballLink("gr\xc3\xb6\xc3\x9f"
                                     "e"))),
            "")
      << "a comment may hold what it likes";
}

TEST(RobotGarbageTest, OneHugeAttributeIsRefused) {
  const std::string huge(kTenMegabytes, '1');
  EXPECT_TRUE(names(refusal(withHand(collisionOf(sphereOf(huge)))), "tag"));
  EXPECT_TRUE(names(refusal(linkOf(huge)), "tag"));
  EXPECT_TRUE(names(refusal(robotOf(linkOf(huge.substr(0, 60000)))), "robot_description"));
}

TEST(RobotGarbageTest, MillionsOfAttributesAreRefused) {
  std::string tag = "<link ";
  for (int i = 0; i < 6500; ++i) tag += numbered("a", i) + "='' ";
  EXPECT_TRUE(names(refusal(robotOf(times(tag + "/>", 180))), "<link>"));
}

TEST(RobotGarbageTest, TenMegabytesOfLinksAreRefused) {
  std::string links;
  for (int i = 0; links.size() < kTenMegabytes; ++i) links += ballLink(numbered("link", i));
  EXPECT_TRUE(names(refusal(robotOf(links)), "links and joints"));
  EXPECT_TRUE(names(refusal(robotOf(times("<link\v/>", 10001))), "links and joints"));
  EXPECT_NE(refusal(robotOf(times(ballLink("same"), 9000))), "");
}

TEST(RobotGarbageTest, AHundredThousandJointsAreRefused) {
  std::string joints;
  for (int i = 0; i < 100000; ++i) joints += jointOf(numbered("j", i), "fixed", "base", "hand");
  EXPECT_TRUE(names(refusal(robotOf(ballLink("base") + joints)), "links and joints"));
}

TEST(RobotGarbageTest, TheLongestChainThatIsTakenIsReadSoon) {
  std::string parts = ballLink("l0");
  for (int i = 1; i < 5000; ++i) {
    parts += ballLink(numbered("l", i)) +
             jointOf(numbered("j", i), "continuous", numbered("l", i - 1), numbered("l", i));
  }
  EXPECT_EQ(refusal(robotOf(parts)), "");
  EXPECT_TRUE(names(refusal(robotOf(parts + linkOf("alone"))), "alone")) << "it has two roots";
}

TEST(RobotGarbageTest, AChainOfMimicsIsRefusedNamingTheJoint) {
  std::string parts = ballLink("base") + ballLink("hand") +
                      jointOf(numbered("j", 4000), "continuous", "base", "hand");
  for (int i = 0; i < 4000; ++i) {
    parts += ballLink(numbered("l", i)) +
             jointOf(numbered("j", i), "continuous", "base", numbered("l", i),
                     "<mimic joint=\"" + numbered("j", i + 1) + "\"/>");
  }
  EXPECT_TRUE(names(refusal(robotOf(parts)), "joint 'j0'"));
}

TEST(RobotGarbageTest, FormatStringsDoNoHarm) {
  for (const std::string& parts :
       {collisionOf(sphereOf("%s%s%s%n")), collisionOf(sphereOf("0.1"), "%s%s%n 0 0"),
        collisionOf(sphereOf("&#37;s&#x25;n")), collisionOf("<box size=\"%n %n %n\"/>"),
        collisionOf("<cylinder radius=\"%s%n\" length=\"%s%n\"/>"),
        std::string("<visual><geometry><sphere radius=\"1\"/></geometry>"
                    "<material name=\"%n\"><color rgba=\"%s%n\"/></material></visual>"),
        std::string("<inertial><mass value=\"%s%n\"/></inertial>")}) {
    EXPECT_TRUE(names(refusal(withHand(parts)), "percent")) << parts;
  }
  RobotResources resources;
  resources.read = [](const std::string& uri) {
    return uri == "a%20b.obj" ? "v 0 0 1\nf 1" : "wrong";
  };
  EXPECT_EQ(refusal(withHand(collisionOf("<mesh filename=\"a%20b.obj\"/>")), resources), "");
}

TEST(RobotGarbageTest, ASizeThatIsNoneIsRefusedNamingTheLink) {
  for (const std::string size : {"nan", "-nan", "inf", "-inf", "1e999", "-0.1", "1e9", ""}) {
    for (const std::string& shape : {sphereOf(size), "<box size=\"1 1 " + size + "\"/>",
                                     "<cylinder radius=\"" + size + "\" length=\"1\"/>",
                                     "<cylinder radius=\"1\" length=\"" + size + "\"/>"}) {
      EXPECT_TRUE(names(refusal(withHand(collisionOf(shape))), "hand")) << shape;
    }
  }
}

TEST(RobotGarbageTest, AnOriginOrAxisThatSumsToInfinityIsRefusedNamingTheElement) {
  EXPECT_TRUE(names(refusal(withHand(collisionOf(sphereOf("0.1"), "1e300 0 0"))), "link 'hand'"));
  const std::string ball = collisionOf(sphereOf("0.1"));
  EXPECT_TRUE(names(refusal(withHand(ball, "<origin xyz=\"0 0 1e300\"/>")), "joint 'wrist'"));
  EXPECT_TRUE(names(refusal(withHand(ball, axisOf("1e200 0 0"))), "joint 'wrist'"));
  EXPECT_TRUE(names(refusal(withHand(ball, axisOf("0 0 1e-9"))), "joint 'wrist'"));
  EXPECT_EQ(refusal(withHand(ball, axisOf("0 0 1e3"))), "");
}

TEST(RobotGarbageTest, ACircleOfAllLinksNamesOneOfThem) {
  const std::string message =
      refusal(robotOf(ballLink("a") + ballLink("b") + jointOf("ab", "fixed", "a", "b") +
                      jointOf("ba", "fixed", "b", "a")));
  EXPECT_TRUE(names(message, "link 'a'") || names(message, "link 'b'")) << message;
  EXPECT_TRUE(names(message, "circle")) << message;
}

TEST(RobotGarbageTest, ALineBreakInANameStaysOutOfTheLine) {
  const std::string ball = collisionOf(sphereOf("0.1"));
  EXPECT_TRUE(names(refusal(robotOf(linkOf("a\nb", collisionOf(sphereOf("-1"))))), "'a b'"));
  EXPECT_TRUE(
      names(refusal(robotOf(linkOf("a", collisionOf("<mesh filename=\"x\ny\"/>")))), "x y"));
  EXPECT_NE(refusal(robotOf(ballLink("a") + ballLink("b") +
                            jointOf("j\nk", "continuous", "a", "b", axisOf("0 0 1e-9")))),
            "");
}

TEST(RobotGarbageTest, AnUnknownTypeOrMissingMeshIsRefusedNamingIt) {
  EXPECT_TRUE(names(
      refusal(robotOf(ballLink("a") + ballLink("b") + jointOf("ab", "hinge", "a", "b"))), "[ab]"));
  RobotResources resources;
  resources.read = [](const std::string& uri) -> std::string {
    throw ConfigError(uri + ": there is no such file");
  };
  const std::string message =
      refusal(withHand(collisionOf("<mesh filename=\"package://p/lost.stl\"/>")), resources);
  EXPECT_EQ(message, "link 'hand': package://p/lost.stl: there is no such file");
}

}  // namespace
}  // namespace tccm
