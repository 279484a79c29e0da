#include "fit/primitives_file.h"

#include <gtest/gtest.h>
#include <urdf_model/pose.h>

#include <algorithm>

#include "support/near.h"
#include "support/random.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

const char* const kExample = R"(# by hand
links:
  upper_arm:
    - {shape: box, size: [0.1, 0.2, 0.3], xyz: [1, 2, 3], rpy: [0.1, 0.2, 0.3]}
    - {shape: cylinder, radius: 0.05, length: 0.4}
  forearm: [{shape: capsule, radius: 5e-2, length: 0, xyz: [0, 0, -1]}]
  "hand/left":
  - shape: sphere
    radius: 0.07
)";

/// The error's text, which has to be one line that begins with the owner.
std::string errorOf(const std::string& yaml) {
  try {
    (void)readPrimitives(yaml, "robot.yaml");
  } catch (const ConfigError& error) {
    const std::string text = error.what();
    EXPECT_EQ(text.rfind("robot.yaml: ", 0), 0U) << text;
    EXPECT_EQ(text.find('\n'), std::string::npos) << text;
    EXPECT_LT(text.size(), 1500U);
    return text;
  }
  ADD_FAILURE() << "nothing was thrown for " << yaml.substr(0, 300);
  return {};
}

/// Whether the error names all of these.
void expectRefused(const std::string& yaml, const std::vector<std::string>& parts) {
  const std::string error = errorOf(yaml);
  for (const std::string& part : parts) {
    EXPECT_NE(error.find(part), std::string::npos) << "'" << part << "' is missing in: " << error;
  }
}

std::string arm(const std::string& primitive) {
  return "links:\n  arm:\n    - {shape: sphere, radius: 1}\n    - " + primitive + "\n";
}

std::string times(const std::string& text, int count) {
  std::string repeated;
  for (int i = 0; i < count; ++i) repeated += text;
  return repeated;
}

TEST(PrimitivesFileTest, AllShapesAreReadWithAndWithoutPlaces) {
  const LinkPrimitives links = readPrimitives(kExample, "robot.yaml");
  ASSERT_EQ(links.size(), 3U);
  const auto& arm = links.at("upper_arm");
  ASSERT_EQ(arm.size(), 2U);
  EXPECT_TRUE(test::isNearly(std::get<Box>(arm[0].shape).half_extents, {0.05, 0.1, 0.15}, 1e-15));
  EXPECT_DOUBLE_EQ(std::get<Cylinder>(arm[1].shape).radius, 0.05);
  EXPECT_DOUBLE_EQ(std::get<Cylinder>(arm[1].shape).half_length, 0.2);
  EXPECT_TRUE(test::isNearly(arm[1].pose, Pose::Identity(), 0.0));
  const PlacedShape& capsule = links.at("forearm").at(0);
  EXPECT_EQ(std::get<Capsule>(capsule.shape).half_length, 0.0);
  EXPECT_TRUE(test::isNearly(capsule.pose.translation(), {0, 0, -1}, 0.0));
  EXPECT_DOUBLE_EQ(std::get<Sphere>(links.at("hand/left").at(0).shape).radius, 0.07);
}

TEST(PrimitivesFileTest, AnglesAreThoseOfAUrdf) {
  const PlacedShape box = readPrimitives(kExample, "robot.yaml").at("upper_arm").at(0);
  urdf::Rotation expected;
  expected.setFromRPY(0.1, 0.2, 0.3);
  Pose pose = Pose::Identity();
  pose.linear() =
      Eigen::Quaterniond(expected.w, expected.x, expected.y, expected.z).toRotationMatrix();
  pose.translation() << 1, 2, 3;
  EXPECT_TRUE(test::isNearly(box.pose, pose, 1e-12));
}

TEST(PrimitivesFileTest, WhatIsNoListOfPrimitivesIsRefusedNamingLinkAndLine) {
  expectRefused(arm("{shape: sphere}"), {"'arm'", "primitive 2", "'radius' is missing", "line 4"});
  expectRefused(arm("{shape: box, size: [1, 2]}"), {"'arm'", "primitive 2", "size", "three"});
  expectRefused(arm("{shape: box, size: [1, 2, 3, 4]}"), {"three"});
  expectRefused(arm("{shape: box, size: 1}"), {"three"});
  expectRefused(arm("{shape: box, radius: 1}"), {"'size' is missing"});
  expectRefused(arm("{shape: box, size: [1, x, 3]}"), {"size", "number"});
  expectRefused(arm("{shape: box, size: [1, 0, 3]}"), {"primitive 2", "box size", "line 4"});
  expectRefused(arm("{shape: cylinder, radius: 1}"), {"'length' is missing"});
  expectRefused(arm("{shape: cylinder, radius: 1, length: 0}"), {"length"});
  expectRefused(arm("{shape: cone, radius: 1}"), {"cone"});
  expectRefused(arm("{radius: 1}"), {"'shape' is missing"});
  expectRefused(arm("{shape: [sphere], radius: 1}"), {"shape"});
  expectRefused(arm("{shape: sphere, radius: 1, length: 1}"), {"'length' is unknown"});
  expectRefused(arm("{shape: sphere, radius: 1, xzy: [0, 0, 0]}"), {"'xzy' is unknown"});
  expectRefused(arm("{shape: sphere, radius: 1, radius: 2}"), {"'radius' is there twice"});
  expectRefused(arm("{shape: sphere, radius: 1, xyz: [0, 0, 1001]}"), {"xyz", "1001"});
  expectRefused(arm("sphere"), {"primitive 2", "map"});
  expectRefused(arm("~"), {"primitive 2", "map"});
  expectRefused(arm("{shape: sphere, radius: \"1\"}"), {"radius", "number"});
  for (const char* bad : {".nan", ".inf", "-.inf", "nan", "inf", "-1", "0", "1001", "1e999", "",
                          "~", "[1]", "{a: 1}", "1 m", "true"}) {
    expectRefused(arm("{shape: sphere, radius: " + std::string(bad) + "}"), {"'arm'", "radius"});
  }
}

TEST(PrimitivesFileTest, WhatIsNoMapOfLinksIsRefused) {
  expectRefused("links: {arm: []}", {"'arm'", "ignored_links"});
  expectRefused("links: {arm: }", {"'arm'", "list"});
  expectRefused("links: {arm: {shape: sphere, radius: 1}}", {"'arm'", "list"});
  expectRefused("links:\n  arm: [{shape: sphere, radius: 1}]\n  arm: [{shape: sphere, radius: 1}]",
                {"'arm' is there twice", "line 3"});
  expectRefused("links: []", {"links", "map"});
  expectRefused("links:", {"links", "map"});
  expectRefused("links: {[a]: []}", {"key"});
  expectRefused("link: {}", {"'link' is unknown"});
  expectRefused("links: {}\nscale: 1", {"'scale' is unknown"});
  expectRefused("{}", {"'links' is missing"});
  for (const char* bad : {"", "# nothing", "just a word", "- 1", "links: {", "a: b: c",
                          "\t\tlinks: {}", "links: *none", ",i", "links: {}\n, x", "links: {} x",
                          "links: {}]", "links: {}\n---\nlinks: {}", "%YAML 9", "\xff\xfe\x01"}) {
    errorOf(bad);
  }
}

TEST(PrimitivesFileTest, BombsAndGarbageAreRefused) {
  for (const char* opening : {"[", "{", "- ", "? ", "{a: ", "[{", "-\t"})
    errorOf(times(opening, 100000));
  std::string stairs = "links:\n";
  for (int i = 1; i < 2500; ++i) stairs += std::string(static_cast<std::size_t>(i), ' ') + "a:\n";
  errorOf(stairs);
  errorOf("links: {a: &a [{shape: sphere, radius: 1}" + times(", {shape: sphere, radius: 1}", 999) +
          "], " +
          [] {
            std::string aliases;
            for (int i = 0; i < 9999; ++i) aliases += "l" + std::to_string(i) + ": *a, ";
            return aliases;
          }() +
          "}");
  std::string bomb = "links: {a: &a0 [x]";
  for (int i = 1; i < 60; ++i) {
    const std::string alias = "*a" + std::to_string(i - 1);
    bomb +=
        ", l" + std::to_string(i) + ": &a" + std::to_string(i) + " [" + alias + ", " + alias + "]";
  }
  errorOf(bomb + "}");
  errorOf("links: &a {arm: [*a]}");
  test::Random random(1);
  std::string garbage;
  for (int i = 0; i < 10'000'000; ++i) garbage += static_cast<char>(random.integer(0, 255));
  errorOf(garbage);
  errorOf(times("x", 10'000'000));
  std::replace(garbage.begin(), garbage.end(), '\0', ' ');
  errorOf(garbage.substr(0, 1'000'000));
  errorOf("links: {" + times("a: [], ", 120'000) + "}");
}

TEST(PrimitivesFileTest, RandomlyDamagedFilesAreReadOrRefusedAndNothingElse) {
  test::Random random(2);
  const std::string whole = kExample;
  int taken = 0;
  for (int i = 0; i < 5000; ++i) {
    std::string damaged = whole;
    const int last = static_cast<int>(whole.size()) - 1;
    if (random.chance(0.2)) damaged.resize(static_cast<std::size_t>(random.integer(1, last)));
    for (int flips = random.integer(0, 3); flips > 0; --flips) {
      const int place = random.integer(0, static_cast<int>(damaged.size()) - 1);
      damaged[static_cast<std::size_t>(place)] = static_cast<char>(random.integer(0, 255));
    }
    try {
      for (const auto& [link, shapes] : readPrimitives(damaged, "robot.yaml")) {
        EXPECT_FALSE(shapes.empty()) << link;
        for (const PlacedShape& placed : shapes) {
          EXPECT_NO_THROW(validate(placed.shape, link));
          EXPECT_TRUE(isRigid(placed.pose));
        }
      }
      ++taken;
    } catch (const ConfigError& error) {
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    }
  }
  EXPECT_GT(taken, 100);
  EXPECT_LT(taken, 4900);
}

TEST(PrimitivesFileTest, WritingIsReadableOneLineAPrimitive) {
  LinkPrimitives links = readPrimitives(kExample, "robot.yaml");
  EXPECT_EQ(writePrimitives(links, "Two lines,\nof a comment"), R"(# Two lines,
# of a comment
links:
  forearm:
    - {shape: capsule, radius: 0.05, length: 0, xyz: [0, 0, -1]}
  "hand/left":
    - {shape: sphere, radius: 0.07}
  upper_arm:
    - {shape: box, size: [0.1, 0.2, 0.3], xyz: [1, 2, 3], rpy: [0.1, 0.2, 0.3]}
    - {shape: cylinder, radius: 0.05, length: 0.4}
)");
  EXPECT_EQ(readPrimitives(writePrimitives({}, ""), "none").size(), 0U);
}

/// A point on the surface or inside, corners and rims more often.
Vector3 pointOf(const Shape& shape, test::Random& random) {
  const UprightBox box = bounds(shape, Pose::Identity());
  for (;;) {
    Vector3 p = random.pointIn(box);
    if (random.chance(0.5)) p = (p.array() < 0.0).select(box.min(), box.max());
    if (std::holds_alternative<Sphere>(shape)) p = box.max().x() * random.direction();
    if (distance(shape, p) == 0.0) return p;
    if (random.chance(0.2)) return Vector3::Zero();
  }
}

TEST(PrimitivesFileTest, WhatIsWrittenAndReadAgainIsTheSameAndNoSmaller) {
  test::Random random(3);
  for (int i = 0; i < 3000; ++i) {
    PlacedShape placed{random.shape(static_cast<std::size_t>(i) % test::kShapeKinds),
                       random.pose(2.0)};
    if (random.chance(0.3)) {
      placed.pose.linear() = random.axisRotation();  // pitched by a right angle, many of them
    }
    const std::string text = writePrimitives({{"arm", {placed}}}, "");
    const PlacedShape back = readPrimitives(text, "robot.yaml").at("arm").at(0);
    ASSERT_EQ(back.shape.index(), placed.shape.index());
    EXPECT_TRUE(test::isNearly(back.pose, placed.pose, 2e-9)) << text;
    const Vector3 grown =
        bounds(back.shape, Pose::Identity()).max() - bounds(placed.shape, Pose::Identity()).max();
    EXPECT_GE(grown.minCoeff(), 0.0) << text;
    EXPECT_LE(grown.maxCoeff(), 2e-9) << text;
    for (int k = 0; k < 10; ++k) {
      const Vector3 p = pointOf(placed.shape, random);
      EXPECT_EQ(distance(back.shape, p), 0.0) << text;
      EXPECT_LE(distance(back.shape, back.pose.inverse() * (placed.pose * p)), 2e-9) << text;
    }
    const std::string again = writePrimitives({{"arm", {back}}}, "");
    EXPECT_EQ(again.substr(0, again.find("rpy")), text.substr(0, text.find("rpy")));
  }
}

TEST(PrimitivesFileTest, EveryLinkNameSurvives) {
  LinkPrimitives links;
  for (const char* name :
       {"yes",  "null", "~", "1",  "1.5", "a: b", "- a", "#", "",  " ", "a\"b",     "a\\b",
        "a\nb", "{a}",  "[", "*a", "&a",  "!a",   "%a",  "@", "`", "'", "l\xc3\xa9"}) {
    links[name] = {{Sphere{1.0}}};
  }
  const LinkPrimitives back = readPrimitives(writePrimitives(links, "a\tb\r\nc: {"), "names");
  EXPECT_EQ(back.size(), links.size());
  for (const auto& [name, shapes] : links) EXPECT_EQ(back.count(name), 1U) << name;
}

TEST(PrimitivesFileTest, WhatIsNoPrimitiveIsNotWritten) {
  EXPECT_THROW((void)writePrimitives({{"arm", {{Sphere{-1.0}}}}}, ""), ConfigError);
  PlacedShape nowhere{Sphere{1.0}};
  nowhere.pose.translation().x() = std::nan("");
  EXPECT_THROW((void)writePrimitives({{"arm", {nowhere}}}, ""), ConfigError);
}

}  // namespace
}  // namespace tccm
