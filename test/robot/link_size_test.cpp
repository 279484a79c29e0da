#include "robot/link_size.h"

#include <gtest/gtest.h>

#include "support/random.h"

namespace tccm {
namespace {

using test::Random;

constexpr unsigned kMembers = 50;
constexpr double kMax = 3.0;  // [m]

/// Of a part of a robot and what stands beside it, as robots are: within a factor of five.
struct Part {
  double longest_m;
  std::vector<double> others_m;

  explicit Part(Random& random) : longest_m(random.uniform(0.02, 1.0)) {
    for (int i = random.integer(1, 4); i > 0; --i) {
      others_m.push_back(longest_m * std::pow(5.0, random.uniform(-1.0, 1.0)));
    }
    others_m.push_back(0.0);
  }
};

TEST(LinkSizeTest, TheLongestSideIsThatOfTheBoxAroundAShape) {
  EXPECT_DOUBLE_EQ(longestSide(Box{{0.1, 0.5, 0.2}}), 1.0);
  EXPECT_DOUBLE_EQ(longestSide(Cylinder{0.4, 0.1}), 0.8);
  EXPECT_DOUBLE_EQ(longestSide(Capsule{0.1, 0.4}), 1.0);
  EXPECT_DOUBLE_EQ(longestSide(Sphere{0.3}), 0.6);
}

TEST(LinkSizeTest, WhatIsLongerThanTheLimitIsToldWithSizeLimitAndCause) {
  EXPECT_EQ(sizeDefect(240.0, kMax, "its mesh a.stl", true),
            "its mesh a.stl is 240 m long, and link_size_max_m is 3 m (millimetres? scale 0.001 is "
            "missing)");
  EXPECT_NE(sizeDefect(3.01, kMax, "its box", false), "");
  EXPECT_EQ(sizeDefect(3.0, kMax, "its box", false), "");
}

TEST(LinkSizeTest, MeshesOfAThousandTimesTheirSizeAreFound) {
  for (unsigned seed = 0; seed < kMembers; ++seed) {
    Random random(seed);
    const Part part(random);
    const MeshSize mesh{1000.0 * part.longest_m, part.others_m};
    const std::string defect = unitDefect(mesh, 1e4, "its mesh a.stl");
    EXPECT_NE(defect.find("scale 0.001 is missing"), std::string::npos) << seed << defect;
  }
}

TEST(LinkSizeTest, MeshesOfAThousandthOfTheirSizeAreFound) {
  for (unsigned seed = 0; seed < kMembers; ++seed) {
    Random random(seed);
    const Part part(random);
    const MeshSize mesh{0.001 * part.longest_m, part.others_m};
    const std::string defect = unitDefect(mesh, kMax, "its mesh a.stl");
    EXPECT_NE(defect.find("one too many"), std::string::npos) << seed << defect;
  }
}

TEST(LinkSizeTest, PartsAsRobotsHaveThemAreTaken) {
  for (unsigned seed = 0; seed < kMembers; ++seed) {
    Random random(seed);
    const Part part(random);
    EXPECT_EQ(unitDefect({part.longest_m, part.others_m}, kMax, ""), "") << seed;
    // A small camera on a long mast, and a base whose joints stand side by side.
    const double mast_m = random.uniform(0.5, 3.0);
    EXPECT_EQ(unitDefect({random.uniform(0.004, 0.1), {mast_m}}, kMax, ""), "") << seed;
    EXPECT_EQ(unitDefect({random.uniform(0.5, 3.0), {random.uniform(0.016, 0.1)}}, kMax, ""), "")
        << seed;
    // Offsets that a drawing left behind.
    EXPECT_EQ(unitDefect({part.longest_m, {random.uniform(0.0, 4e-4)}}, kMax, ""), "") << seed;
  }
}

TEST(LinkSizeTest, WithoutAnythingBesideItNothingIsKnown) {
  EXPECT_FALSE(saysEnough({0.5, {}}));
  EXPECT_FALSE(saysEnough({0.5, {0.0, 1e-5}}));
  EXPECT_EQ(unitDefect({2.9, {0.0}}, kMax, ""), "");
  EXPECT_EQ(unitDefect({1e-4, {}}, kMax, ""), "");
}

}  // namespace
}  // namespace tccm
