#include "robot/link_use.h"

#include <gtest/gtest.h>

#include <limits>

#include "support/tiny_robot.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

using test::ballLink;
using test::jointOf;
using test::robotOf;

/// base -> l_hand, r_hand, each a ball; "hands" is a group.
RobotModel hands() {
  RobotModel::Config config;
  config.link_groups["hands"] = {"?_hand"};
  return {
      robotOf(ballLink("base") + ballLink("l_hand") + ballLink("r_hand") +
              jointOf("l", "fixed", "base", "l_hand") + jointOf("r", "fixed", "base", "r_hand")),
      config};
}

LinkUse::Exception exception(const std::vector<std::string>& links, std::optional<double> scale,
                             std::optional<double> padding_m) {
  return {links, scale, padding_m};
}

/// Scale and padding by link.
std::map<std::string, std::pair<double, double>> growths(const LinkUse& use) {
  const RobotModel model = hands();
  const UsedShapes used = model.shapesFor(use, kCollisionKeys);
  std::map<std::string, std::pair<double, double>> growths;
  for (std::size_t i = 0; i < used.shapes.size(); ++i) {
    growths[model.linkOf(used.shapes[i])] = {used.expansions[i].scale,
                                             used.expansions[i].padding_m};
  }
  return growths;
}

using Growths = std::map<std::string, std::pair<double, double>>;

TEST(LinkUseTest, AllMonitoredLinksAreTakenWhereNoneIsNamed) {
  EXPECT_EQ(growths(LinkUse{Expansion{1.1, 0.02}}),
            (Growths{{"base", {1.1, 0.02}}, {"l_hand", {1.1, 0.02}}, {"r_hand", {1.1, 0.02}}}));
}

TEST(LinkUseTest, NamedLinksAreTakenAndIgnoredOnesTakenOutAgain) {
  LinkUse use;
  use.links = {"hands"};
  EXPECT_EQ(growths(use), (Growths{{"l_hand", {1.0, 0.0}}, {"r_hand", {1.0, 0.0}}}));
  use.ignored = {"r_*"};
  EXPECT_EQ(growths(use), (Growths{{"l_hand", {1.0, 0.0}}}));
  use.ignored = {"hands"};
  EXPECT_THROW(growths(use), ConfigError) << "nothing is left";
}

TEST(LinkUseTest, OfSeveralExceptionsTheLastCountsAndKeepsWhatItDoesNotName) {
  LinkUse use{Expansion{1.1, 0.02}};
  use.exceptions = {exception({"hands"}, 1.5, std::nullopt),
                    exception({"r_hand"}, std::nullopt, 0.1)};
  EXPECT_EQ(growths(use),
            (Growths{{"base", {1.1, 0.02}}, {"l_hand", {1.5, 0.02}}, {"r_hand", {1.1, 0.1}}}));
}

TEST(LinkUseTest, AnExceptionForNoMonitoredLinkIsRefused) {
  LinkUse use;
  use.exceptions = {exception({"foot"}, 1.5, std::nullopt)};
  EXPECT_THROW(growths(use), ConfigError);
}

TEST(LinkUseTest, GrowthsOutOfRangeAreRefused) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const Expansion& bad : {Expansion{0.9, 0.0}, Expansion{4.0, 0.0}, Expansion{nan, 0.0},
                               Expansion{1.0, -0.1}, Expansion{1.0, 1.1}, Expansion{1.0, nan}}) {
    EXPECT_THROW(LinkUse{bad}.validate(kCollisionKeys), ConfigError);
    LinkUse use;
    use.exceptions = {exception({"base"}, bad.scale, bad.padding_m)};
    EXPECT_THROW(use.validate(kCollisionKeys), ConfigError);
  }
  LinkUse use;
  use.exceptions = {exception({}, 1.1, 0.1)};
  EXPECT_THROW(use.validate(kCollisionKeys), ConfigError);
  use.exceptions = {exception({"base"}, std::nullopt, std::nullopt)};
  EXPECT_THROW(use.validate(kCollisionKeys), ConfigError);
}

const std::vector<std::string> kLinks{"base", "l_arm", "l_hand", "r_arm", "r_hand"};

/// What it is refused with; empty where it is taken.
std::string refusal(const LinkSelector::Groups& groups) {
  try {
    const LinkSelector selector(groups, kLinks);
  } catch (const ConfigError& error) {
    return error.what();
  }
  return {};
}

TEST(LinkSelectorTest, NamesPatternsAndGroupsMeanLinks) {
  const LinkSelector selector({{"hands", {"l_hand", "r_h*"}}}, kLinks);
  EXPECT_TRUE(selector.matches({"base"}, "base"));
  EXPECT_FALSE(selector.matches({"base"}, "base_2"));
  EXPECT_TRUE(selector.matches({"none", "?_arm"}, "r_arm"));
  EXPECT_FALSE(selector.matches({"?_arm"}, "r_hand"));
  EXPECT_TRUE(selector.matches({"hands"}, "l_hand"));
  EXPECT_TRUE(selector.matches({"hands"}, "r_hand"));
  EXPECT_FALSE(selector.matches({"hands"}, "l_arm"));
  EXPECT_FALSE(selector.matches({}, "base"));
}

TEST(LinkSelectorTest, AGroupThatIsEmptyOrMatchesNothingIsRefusedNamingIt) {
  EXPECT_NE(refusal({{"legs", {}}}).find("link_groups/legs"), std::string::npos);
  EXPECT_NE(refusal({{"legs", {"*_leg"}}}).find("'*_leg'"), std::string::npos);
  EXPECT_NE(refusal({{"base", {"l_arm"}}}).find("link_groups/base"), std::string::npos);
  EXPECT_EQ(refusal({{"arms", {"*_arm"}}}), "");
}

TEST(LinkSelectorTest, AGroupHasNoGroupsInIt) {
  EXPECT_NE(refusal({{"arms", {"*_arm"}}, {"upper", {"arms"}}}).find("link_groups/upper"),
            std::string::npos);
}

TEST(LinkSelectorTest, GroupsNamedAsPatternsDoNotLookEachOtherUp) {
  const LinkSelector selector({{"l_*", {"r_*"}}, {"r_*", {"l_*"}}, {"b*", {"b*"}}}, kLinks);
  EXPECT_TRUE(selector.matches({"l_*"}, "r_arm"));
  EXPECT_FALSE(selector.matches({"l_*"}, "l_arm"));
  EXPECT_TRUE(selector.matches({"b*"}, "base"));
}

TEST(LinkSelectorTest, EveryEntryHasToMeanALink) {
  const LinkSelector selector({{"hands", {"*_hand"}}}, kLinks);
  EXPECT_NO_THROW(selector.requireMatches({"hands", "base"}, "collision_links"));
  EXPECT_NO_THROW(selector.requireMatches({}, "collision_links"));
  EXPECT_THROW(selector.requireMatches({"base", "feet"}, "collision_links"), ConfigError);
  try {
    selector.requireMatches({"hands"}, {"base"}, "collision_links");
    FAIL() << "it was taken";
  } catch (const ConfigError& error) {
    EXPECT_STREQ(error.what(), "collision_links: 'hands' matches no monitored link");
  }
}

}  // namespace
}  // namespace tccm
