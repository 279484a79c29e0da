#include "robot/joint_rule.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/random.h"
#include "support/tiny_robot.h"

namespace tccm {
namespace {

using namespace test;

/// @param limit of the joint; may be empty.
JointRule turning(const std::string& type, const std::string& limit) {
  return rulesOf(*modelOf(robotOf(linkOf("base") + ballLink("hand") +
                                  jointOf("roll", type, "base", "hand", axisOf("1 0 0") + limit))),
                 0.2)
      .front();
}

TEST(JointRuleTest, TheToleranceIsTheParameterOrATenthOfTheRange) {
  EXPECT_NEAR(turning("revolute", limitOf("-0.5", "0.5")).limit_tolerance, 0.2, 1e-12);
  EXPECT_NEAR(turning("revolute", limitOf("-2", "2")).limit_tolerance, 0.4, 1e-12);
  EXPECT_NEAR(turning("prismatic", limitOf("0", "0.1")).limit_tolerance, 0.02, 1e-12);
  EXPECT_NEAR(turning("prismatic", limitOf("0", "1")).limit_tolerance, 0.1, 1e-12);
}

TEST(JointRuleTest, FiveTimesTheLimitIsBelievedOfASpeedOrAHundredRadiansOrTenMetres) {
  EXPECT_NEAR(turning("revolute", limitOf("-1", "1")).speed_believed, 5.0, 1e-12);
  EXPECT_EQ(turning("continuous", "").speed_believed, 100.0);
  EXPECT_EQ(turning("revolute", "<limit lower=\"-1\" upper=\"1\" effort=\"1\" velocity=\"0\"/>")
                .speed_believed,
            100.0)
      << "a limit of 0 is none";
  EXPECT_EQ(turning("prismatic", "<limit lower=\"-1\" upper=\"1\" effort=\"1\" velocity=\"0\"/>")
                .speed_believed,
            10.0);
}

TEST(JointRuleTest, ASpeedThatIsSlowIsBelievedWhateverTheLimit) {
  const auto limited = [](const std::string& type) {
    return turning(type, "<limit lower=\"0\" upper=\"0.33\" effort=\"1\" velocity=\"0.013\"/>");
  };
  EXPECT_EQ(limited("prismatic").speed_believed, 0.1) << "a torso that goes at 75 mm/s";
  EXPECT_EQ(limited("revolute").speed_believed, 0.5);
}

TEST(JointRuleTest, ADriverThatPublishesWithinHalfATurnMayBeAWholeTurnOff) {
  const JointRule rule = turning("revolute", limitOf("0", "4.5"));
  EXPECT_EQ(rule.beyond(-1.9), 0.0) << "4.38";
  EXPECT_NEAR(rule.beyond(-1.0), 1.0, 1e-12) << "5.28 is beyond as well";
  EXPECT_NEAR(rule.beyond(4.6), 0.1, 1e-12);
  EXPECT_NEAR(turning("revolute", limitOf("-3.1", "3.1")).beyond(5.0), 1.9, 1e-12)
      << "five degrees, in degrees, are not -1.28 rad";
}

TEST(JointRuleTest, DegreesAreAskedAfterByNameFigureAndLimit) {
  EXPECT_EQ(turning("revolute", limitOf("-3.1", "3.1")).textOfPosition(90.0),
            "joint 'roll' is published at 90 rad, its limits are -3.1 and 3.1 rad: are these "
            "degrees?");
  EXPECT_NE(turning("prismatic", limitOf("0", "0.3")).textOfPosition(150.0).find("millimetres"),
            std::string::npos);
}

TEST(JointRuleTest, RandomPositionsInDegreesAreBeyondAndThoseALittleBeyondAreNot) {
  Random random(11);
  for (int i = 0; i < 200; ++i) {
    const double limit = random.uniform(0.5, 3.1);
    const JointRule rule =
        turning("revolute", limitOf(std::to_string(-limit), std::to_string(limit)));
    const double degrees = random.uniform(10.0, 180.0) * (random.chance(0.5) ? 1.0 : -1.0);
    EXPECT_GT(rule.beyond(degrees), rule.limit_tolerance) << degrees << " of " << limit;
    const double sloppy = limit + random.uniform(0.0, 0.19);
    EXPECT_LE(rule.beyond(sloppy), rule.limit_tolerance) << sloppy << " of " << limit;
  }
}

TEST(JointRuleTest, AMimicsRuleIsKeptAlsoAWholeTurnOff) {
  const std::string mimic = "<mimic joint=\"roll\" multiplier=\"2\" offset=\"0.1\"/>";
  const auto mimics = mimicsOf(*modelOf(
      robotOf(linkOf("base") + ballLink("hand") + ballLink("other") +
              jointOf("roll", "continuous", "base", "hand", axisOf("1 0 0")) +
              jointOf("follows", "continuous", "base", "other", axisOf("1 0 0") + mimic))));
  ASSERT_EQ(mimics.size(), 1U);
  EXPECT_EQ(mimics.front().name, "follows");
  EXPECT_NEAR(mimics.front().deviation(2.1, 1.0), 0.0, 1e-12);
  EXPECT_NEAR(mimics.front().deviation(2.1 - 2.0 * M_PI, 1.0), 0.0, 1e-12);
  EXPECT_NEAR(mimics.front().deviation(2.6, 1.0), 0.5, 1e-12);
}

}  // namespace
}  // namespace tccm
