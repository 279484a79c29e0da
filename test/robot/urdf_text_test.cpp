#include "robot/urdf_text.h"

#include <gtest/gtest.h>

#include <fstream>

#include "support/error_of.h"
#include "support/random.h"
#include "support/refusal.h"
#include "support/shared_data.h"
#include "support/tiny_robot.h"

namespace tccm {
namespace {

using namespace test::urdf_text;
using test::errorOf;
using test::names;
using test::Random;
using test::refusalOf;

constexpr unsigned kMembers = 30;

std::string geometryOf(const std::string& shapes) { return "<geometry>" + shapes + "</geometry>"; }

std::string randomShape(Random& random) {
  const std::vector<std::string> shapes{"<box size=\"0.1 0.1 0.1\"/>", sphereOf("0.1"),
                                        "<cylinder radius=\"0.1\" length=\"0.2\"/>"};
  return shapes[static_cast<std::size_t>(random.integer(0, 2))];
}

std::string randomCase(Random& random, std::string word) {
  for (char& letter : word) {
    if (random.chance(0.3)) letter = static_cast<char>(std::toupper(letter));
  }
  word[0] = static_cast<char>(std::toupper(word[0]));
  return word;
}

std::string element(const std::string& name, const std::string& content) {
  return "<" + name + ">" + content + "</" + name + ">";
}

std::string robotWith(const std::string& hand_elements) {
  return robotOf(ballLink("base") + linkOf("hand", hand_elements) +
                 jointOf("wrist", "fixed", "base", "hand"));
}

void expectRefused(const std::string& urdf, const std::string& word, unsigned seed) {
  const std::string refusal = refusalOf(urdf);
  EXPECT_TRUE(names(refusal, word)) << seed << ": " << refusal << "\n" << urdf;
}

TEST(UrdfTextTest, TwoGeometriesInOneCollisionAreRefusedNamingTheLink) {
  for (unsigned seed = 0; seed < kMembers; ++seed) {
    Random random(seed);
    std::string geometries;
    for (int i = random.integer(2, 4); i > 0; --i) geometries += geometryOf(randomShape(random));
    const std::string hand = collisionOf(sphereOf("0.1")) + element("collision", geometries);
    expectRefused(robotWith(hand), "link 'hand'", seed);
    expectRefused(robotWith(hand), "more than one <geometry>", seed);
  }
}

TEST(UrdfTextTest, TwoShapesInOneGeometryAreRefusedNamingTheLink) {
  for (unsigned seed = 0; seed < kMembers; ++seed) {
    Random random(seed);
    std::string shapes;
    for (int i = random.integer(2, 4); i > 0; --i) shapes += randomShape(random);
    if (random.chance(0.3)) shapes += "<capsule radius=\"1\" length=\"1\"/>";
    const std::string hand = element("collision", geometryOf(shapes));
    expectRefused(robotWith(hand), "link 'hand'", seed);
    expectRefused(robotWith(hand), "more than one shape", seed);
  }
}

TEST(UrdfTextTest, NamesWithCapitalLettersAreRefused) {
  for (unsigned seed = 0; seed < kMembers; ++seed) {
    Random random(seed);
    const std::string shape = geometryOf(randomShape(random));
    const std::string collision = randomCase(random, "collision");
    expectRefused(robotWith(collisionOf(sphereOf("0.1")) + element(collision, shape)),
                  "<" + collision + ">", seed);
    const std::string link = randomCase(random, "link");
    expectRefused(robotOf(ballLink("base") + "<" + link + " name=\"a\"/>"), "<" + link + ">", seed);
    const std::string geometry = randomCase(random, "geometry");
    expectRefused(robotWith(element("collision", shape + element(geometry, randomShape(random)))),
                  "<" + geometry + ">", seed);
  }
}

TEST(UrdfTextTest, SeveralCollisionElementsAndWhatIsNoBodyAreTaken) {
  for (unsigned seed = 0; seed < kMembers; ++seed) {
    Random random(seed);
    std::string hand;
    const int count = random.integer(1, 4);
    for (int i = 0; i < count; ++i) {
      hand += "<collision name=\"c\"><origin xyz=\"0 0 0\"/><!-- a part --><geometry><!-- one -->" +
              randomShape(random) + "</geometry><verbose value=\"x\"/></collision>";
    }
    hand += "<self_collision_checking/>";
    const std::string urdf = robotOf(
        ballLink("base") + linkOf("hand", hand) + jointOf("wrist", "fixed", "base", "hand") +
        "<gazebo reference=\"hand\"><Collision/><collision><geometry/><geometry/>"
        "</collision></gazebo>");
    EXPECT_EQ(refusalOf(urdf), "") << seed;
    const auto model = test::modelOf(urdf);
    EXPECT_EQ(model->shapes().size(), static_cast<std::size_t>(count) + 1U) << seed;
    EXPECT_TRUE(model->warnings().empty()) << seed;
  }
}

TEST(UrdfTextTest, SurplusVisualGeometryMattersWhereItIsTheBody) {
  const std::string two = geometryOf(sphereOf("0.1")) + geometryOf(sphereOf("0.2"));
  for (const std::string& visuals :
       {element("visual", two), element("visual", geometryOf(sphereOf("0.1") + sphereOf("0.2"))),
        element("visual", geometryOf(sphereOf("0.1"))) +
            element("Visual", geometryOf(sphereOf("1")))}) {
    const std::string urdf = robotWith(collisionOf(sphereOf("0.1")) + visuals);
    EXPECT_EQ(refusalOf(urdf), "");
    RobotModel::Config config;
    config.visual_links = {"hand"};
    EXPECT_TRUE(names(refusalOf(urdf, config), "link 'hand'")) << visuals;
  }
}

TEST(UrdfTextTest, TheSharedRobotOfTwoGeometriesIsRefused) {
  const std::string path =
      test::sharedDataFolder() + "/cases/urdf-surplus-geometry/two_geometries.urdf";
  std::ifstream file(path);
  if (!file) GTEST_SKIP() << "no " << path;
  const std::string urdf{std::istreambuf_iterator<char>(file), {}};
  EXPECT_TRUE(names(refusalOf(urdf), "link 'a'")) << refusalOf(urdf);
}

}  // namespace
}  // namespace tccm
