#include "robot/link_selector.h"

#include <gtest/gtest.h>

#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

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
