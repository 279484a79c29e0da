#include "robot/geometry_reader.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

#include "robot/link_size.h"
#include "support/mesh_texts.h"
#include "support/random.h"
#include "support/refusal.h"
#include "support/shared_data.h"
#include "support/tiny_robot.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

using namespace test::urdf_text;
using test::names;
using test::Random;
using test::refusalOf;

constexpr unsigned kMembers = 25;
const std::string kUri = "package://p/part.stl";

std::string numberText(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.9g", value);
  return text;
}

std::string meshOf(double scale = 1.0) {
  const std::string factor = numberText(scale);
  return "<mesh filename=\"" + kUri + "\" scale=\"" + factor + " " + factor + " " + factor + "\"/>";
}

std::string boxOf(double x, double y, double z) {
  return "<box size=\"" + numberText(x) + " " + numberText(y) + " " + numberText(z) + "\"/>";
}

/// A tetrahedron with that longest side.
std::string stlOf(double longest) {
  const Vector3 o(0, 0, 0), a(longest, 0, 0), b(0, 0.5 * longest, 0), c(0, 0, 0.3 * longest);
  return test::binaryStl({{o, a, b}, {o, a, c}, {o, b, c}, {a, b, c}});
}

RobotResources file(const std::string& content) {
  RobotResources resources;
  resources.read = [content](const std::string& uri) {
    if (uri != kUri) throw ConfigError(uri + ": there is no such file");
    return content;
  };
  return resources;
}

/// A hand at the end of an arm's joint, with a finger at another's.
std::string robotWith(const std::string& hand, double arm_m = 0.0, double finger_m = 0.0) {
  const auto origin = [](double metres) {
    return "<origin xyz=\"" + numberText(metres) + " 0 0\"/>";
  };
  return robotOf(ballLink("base") + linkOf("hand", hand) + linkOf("finger") +
                 jointOf("wrist", "continuous", "base", "hand", origin(arm_m) + axisOf("0 0 1")) +
                 jointOf("knuckle", "fixed", "hand", "finger", origin(finger_m)));
}

bool warns(const RobotModel& model, const std::string& word) {
  const auto& warnings = model.warnings();
  return std::any_of(warnings.begin(), warnings.end(),
                     [&](const std::string& warning) { return names(warning, word); });
}

TEST(GeometryReaderTest, AMeshInMillimetresIsRefusedWithLinkFileSizeAndCause) {
  for (unsigned seed = 0; seed < kMembers; ++seed) {
    Random random(seed);
    const double longest_mm = random.uniform(10.0, 900.0);
    const std::string hand = collisionOf(meshOf());
    const std::string refusal =
        refusalOf(robotWith(hand, random.uniform(0.0, 0.5)), {}, file(stlOf(longest_mm)));
    for (const std::string& word :
         {std::string("link 'hand'"), kUri, std::string("link_size_max_m"),
          std::string("scale 0.001 is missing")}) {
      EXPECT_TRUE(names(refusal, word)) << seed << ": " << refusal;
    }
    EXPECT_EQ(refusalOf(robotWith(collisionOf(meshOf(0.001))), {}, file(stlOf(longest_mm))), "")
        << seed;
  }
}

TEST(GeometryReaderTest, APrimitiveInMillimetresIsRefusedNamingTheLink) {
  for (unsigned seed = 0; seed < kMembers; ++seed) {
    Random random(seed);
    const double mm = random.uniform(10.0, 900.0);
    const std::string length = numberText(mm);
    const std::vector<std::string> shapes{boxOf(1.0, mm, 1.0), sphereOf(length),
                                          "<cylinder radius=\"1\" length=\"" + length + "\"/>",
                                          "<cylinder radius=\"" + length + "\" length=\"1\"/>"};
    const std::string& shape = shapes[static_cast<std::size_t>(random.integer(0, 3))];
    const std::string refusal = refusalOf(robotWith(collisionOf(shape)));
    EXPECT_TRUE(names(refusal, "link 'hand'") && names(refusal, "millimetres")) << refusal;
  }
}

TEST(GeometryReaderTest, TheLimitOfSizesCanBeRaisedAndThenUnitsAreToldByTheLinksOtherParts) {
  RobotModel::Config config;
  config.link_size_max_m = 1000.0;
  const auto refused = [&](const std::string& hand, double arm_m, double finger_m, double longest) {
    const std::string refusal =
        refusalOf(robotWith(hand, arm_m, finger_m), config, file(stlOf(longest)));
    return names(refusal, "link 'hand'") && names(refusal, "scale 0.001");
  };
  for (unsigned seed = 0; seed < kMembers; ++seed) {
    Random random(seed);
    const double longest = random.uniform(0.05, 0.5), beside = longest * random.uniform(0.3, 3.0);
    const std::string box = collisionOf(boxOf(beside, 0.1 * beside, 0.1 * beside));
    const std::string visual =
        "<visual><geometry>" + sphereOf(numberText(0.5 * beside)) + "</geometry></visual>";
    const std::string beside_box = box + collisionOf(meshOf());
    const std::string beside_visual = collisionOf(meshOf()) + visual;
    for (const double wrong : {1000.0 * longest, 0.001 * longest}) {
      EXPECT_TRUE(refused(collisionOf(meshOf()), beside, 0.0, wrong)) << seed;
      EXPECT_TRUE(refused(collisionOf(meshOf()), 0.0, beside, wrong)) << seed;
      EXPECT_TRUE(refused(beside_box, 0.0, 0.0, wrong)) << seed;
      EXPECT_TRUE(refused(beside_visual, 0.0, 0.0, wrong)) << seed;
    }
    EXPECT_EQ(
        refusalOf(robotWith(box + beside_visual, beside, beside), config, file(stlOf(longest))), "")
        << seed;
  }
}

TEST(GeometryReaderTest, WhatIsJustLargerThanTheLimitIsRefusedAndWhatIsJustSmallerTaken) {
  for (unsigned seed = 0; seed < kMembers; ++seed) {
    Random random(seed);
    RobotModel::Config config;
    config.link_size_max_m = random.uniform(0.5, 10.0);
    const double thin = random.uniform(0.01, 0.4);
    const auto shape = [&](double longest) -> std::string {
      switch (seed % 3) {
        case 0:
          return boxOf(thin, longest, thin);
        case 1:
          return sphereOf(numberText(0.5 * longest));
        default:
          return meshOf();
      }
    };
    const auto refusal = [&](double longest) {
      return refusalOf(robotWith(collisionOf(shape(longest))), config, file(stlOf(longest)));
    };
    const std::string said = refusal(config.link_size_max_m * random.uniform(1.001, 1.5));
    EXPECT_TRUE(names(said, "link 'hand'") && names(said, "link_size_max_m")) << seed << said;
    EXPECT_EQ(refusal(config.link_size_max_m * random.uniform(0.5, 0.999)), "") << seed;
  }
}

TEST(GeometryReaderTest, ThePrimitivesOfAFileAreHeldToTheLimitToo) {
  RobotModel::Config config;
  config.primitives_file = kUri;
  EXPECT_TRUE(
      names(refusalOf(robotWith(""), config, file("links: {hand: [{shape: sphere, radius: 50}]}")),
            "link 'hand'"));
}

TEST(GeometryReaderTest, PrimitivesOfSizeZeroAreLeftOutAndThinOnesStay) {
  for (unsigned seed = 0; seed < kMembers; ++seed) {
    Random random(seed);
    const double length = random.uniform(0.01, 1.0);
    const std::vector<std::string> nothing{boxOf(0, 0, 0), sphereOf("0"), sphereOf("0.0"),
                                           "<cylinder radius=\"0\" length=\"0\"/>"};
    const std::vector<std::string> thin{
        boxOf(length, length, 0), boxOf(0, 0, length),
        "<cylinder radius=\"0\" length=\"" + numberText(length) + "\"/>",
        "<cylinder radius=\"" + numberText(length) + "\" length=\"0\"/>"};
    const std::string& none = nothing[static_cast<std::size_t>(random.integer(0, 3))];
    const std::string& some = thin[static_cast<std::size_t>(random.integer(0, 3))];
    const RobotModel without(robotWith(collisionOf(none)), {});
    EXPECT_EQ(without.shapes().size(), 1U) << none;
    EXPECT_TRUE(warns(without, "link 'hand'") && warns(without, "left out")) << none;
    EXPECT_TRUE(without.variables().empty()) << "nobody has to publish the wrist";
    const RobotModel with(robotWith(collisionOf(some)), {});
    ASSERT_EQ(with.shapes().size(), 2U) << some;
    EXPECT_GE(longestSide(with.shapes()[1].shape), 0.999 * length) << some;
    EXPECT_TRUE(warns(with, "0.1 mm")) << some;
    const std::vector<std::string> solid{
        boxOf(length, 0.001, length), sphereOf(numberText(length)),
        "<cylinder radius=\"0.001\" length=\"" + numberText(length) + "\"/>"};
    EXPECT_TRUE(RobotModel(robotWith(collisionOf(solid[seed % 3])), {}).warnings().empty());
  }
}

TEST(GeometryReaderTest, ALinkOfEmptyGeometryIsNoneThatCanBeAskedFor) {
  RobotModel::Config config;
  config.monitored_links = {"hand"};
  const std::string urdf = robotWith(collisionOf(meshOf()));
  const RobotResources empty = file(test::binaryStl({}));
  EXPECT_TRUE(names(refusalOf(urdf, config, empty), "link 'hand'"));
  const RobotModel model(urdf, {}, empty);
  EXPECT_TRUE(warns(model, "empty") && warns(model, kUri));
  EXPECT_EQ(model.shapes().size(), 1U);
  const auto& without = model.linksWithoutShape();
  EXPECT_NE(std::find(without.begin(), without.end(), "hand"), without.end());
}

TEST(GeometryReaderTest, AnEmptyMeshIsLeftOutBesideTheLinksOtherGeometry) {
  for (unsigned seed = 0; seed < kMembers; ++seed) {
    Random random(seed);
    const double length = random.uniform(0.01, 1.0);
    const std::string box = collisionOf(boxOf(length, random.uniform(0.01, 1.0), 0.1));
    const std::string mesh = collisionOf(meshOf());
    const std::string urdf = robotWith(random.chance(0.5) ? mesh + box : box + mesh);
    const RobotModel without(urdf, {}, file(test::binaryStl({})));
    EXPECT_EQ(without.shapes().size(), 2U) << seed;
    ASSERT_EQ(without.warnings().size(), 1U) << seed;
    EXPECT_TRUE(warns(without, "empty") && warns(without, kUri)) << without.warnings()[0];
    const RobotModel with(urdf, {}, file(stlOf(length)));
    EXPECT_GE(with.shapes().size(), 3U) << seed;
    EXPECT_TRUE(with.warnings().empty()) << seed;
  }
}

RobotModel turningAbout(const std::string& axis, Random& random) {
  const std::string type = random.chance(0.5) ? "continuous" : "revolute";
  const double upper = random.uniform(0.1, 3.0);
  return {robotOf(ballLink("base") + ballLink("hand") +
                  jointOf("wrist", type, "base", "hand",
                          axisOf(axis) + limitOf("-1", numberText(upper)))),
          {}};
}

TEST(GeometryReaderTest, ARotationAboutNoAxisIsAFixedJointWithAWarning) {
  const std::vector<std::string> zeros{"0", "0.0", "-0", "-0.000", "0e5", "0.0E-3"};
  for (unsigned seed = 0; seed < kMembers; ++seed) {
    Random random(seed);
    const auto zero = [&] { return zeros[static_cast<std::size_t>(random.integer(0, 5))]; };
    const RobotModel fixed = turningAbout(zero() + " " + zero() + " " + zero(), random);
    EXPECT_EQ(fixed.shapes().size(), 2U) << seed;
    EXPECT_TRUE(fixed.variables().empty()) << seed;
    EXPECT_TRUE(warns(fixed, "joint 'wrist'")) << seed;
    const Vector3 axis = std::pow(10.0, random.uniform(-4.0, 3.0)) * random.direction();
    const RobotModel turning = turningAbout(
        numberText(axis.x()) + " " + numberText(axis.y()) + " " + numberText(axis.z()), random);
    EXPECT_EQ(turning.variables().size(), 1U) << seed;
    EXPECT_TRUE(turning.warnings().empty()) << seed;
  }
}

TEST(GeometryReaderTest, WarningsAreTheSameWhereTheFitIsKnown) {
  const RobotModel model(robotWith(collisionOf(meshOf()) + collisionOf(meshOf())), {},
                         file(stlOf(0.1) + "x"));
  EXPECT_EQ(model.warnings().size(), 2U);
}

TEST(GeometryReaderTest, TheSharedRobotInMillimetresIsRefused) {
  const std::string folder = test::sharedDataFolder() + "/cases/mesh-in-mm/";
  const auto read = [](const std::string& path) {
    std::ifstream stream(path, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(stream), {});
  };
  const std::string urdf = read(folder + "mm.urdf");
  if (urdf.empty()) GTEST_SKIP() << "no " << folder;
  RobotResources resources;
  resources.read = [&](const std::string&) { return read(folder + "packages/r/meshes/mm.stl"); };
  const std::string refusal = refusalOf(urdf, {}, resources);
  EXPECT_TRUE(names(refusal, "link 'arm'") && names(refusal, "mm.stl")) << refusal;
}

}  // namespace
}  // namespace tccm
