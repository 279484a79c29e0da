#include "ros/parameters.h"

#include <gtest/gtest.h>

#include "support/error_of.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

using test::errorOf;

Parameters parse(const std::string& yaml) { return {YAML::Load(yaml), "a_nodelet"}; }

template <typename T>
T readOne(const std::string& yaml, T value) {
  Parameters parameters = parse(yaml);
  parameters.read("key", value);
  return value;
}

TEST(ParametersTest, EveryTypeIsRead) {
  EXPECT_TRUE(readOne("key: true", false));
  EXPECT_EQ(readOne("key: -3", 0), -3);
  EXPECT_EQ(readOne("key: 7", std::size_t{0}), 7U);
  EXPECT_EQ(readOne("key: 0.25", 0.0), 0.25);
  EXPECT_EQ(readOne("key: hand", std::string()), "hand");
  const std::vector<std::string> links{"a", "b*"};
  EXPECT_EQ(readOne("key: [a, 'b*']", std::vector<std::string>()), links);
  EXPECT_TRUE(readOne("key: []", links).empty());
}

TEST(ParametersTest, AWholeNumberDoesForANumber) { EXPECT_EQ(readOne("key: 2", 0.5), 2.0); }

TEST(ParametersTest, WhatIsNotSetKeepsItsDefault) {
  EXPECT_EQ(readOne("other: 1", 0.5), 0.5);
  EXPECT_EQ(readOne("", 42), 42);
  EXPECT_EQ(readOne("{}", std::string("default")), "default");
}

TEST(ParametersTest, AWrongTypeIsRefusedNamingNodeletKeyAndValue) {
  EXPECT_EQ(errorOf([] { readOne("key: soon", 0.5); }), "a_nodelet/key: soon is not a number");
  EXPECT_EQ(errorOf([] { readOne("key: 1.5", 0); }), "a_nodelet/key: 1.5 is not a whole number");
  EXPECT_EQ(errorOf([] { readOne("key: [1, 2]", 0.5); }), "a_nodelet/key: [1, 2] is not a number");
  EXPECT_EQ(errorOf([] { readOne("key: maybe", false); }),
            "a_nodelet/key: maybe is not true or false");
  EXPECT_EQ(errorOf([] { readOne("key: hand", std::vector<std::string>()); }),
            "a_nodelet/key: hand is not a list of texts");
  EXPECT_EQ(errorOf([] { readOne("key: {a: 1}", std::string()); }),
            "a_nodelet/key: {a: 1} is not a text");
  EXPECT_EQ(errorOf([] { readOne("key: -1", std::size_t{0}); }),
            "a_nodelet/key: -1 is not a whole number of at least 0");
}

TEST(ParametersTest, AKeyWithoutAValueIsRefused) {
  EXPECT_NE(errorOf([] { readOne("key:", 0.5); }).find("a_nodelet/key"), std::string::npos);
}

TEST(ParametersTest, KeysThatNobodyReadAreKnown) {
  Parameters parameters = parse("{horizon_s: 0.5, horizont_s: 1.0, colour: red}");
  double horizon = 0.0;
  parameters.read("horizon_s", horizon);
  const std::vector<std::string> expected{"horizont_s", "colour"};
  EXPECT_EQ(parameters.unknownKeys(), expected);
}

TEST(ParametersTest, AKeyThatWasReadButIsNotSetIsNotUnknown) {
  Parameters parameters = parse("{}");
  double value = 0.0;
  parameters.read("key", value);
  EXPECT_TRUE(parameters.unknownKeys().empty());
}

TEST(ParametersTest, ReadingAddsNoKeys) {
  Parameters parameters = parse("other: 1");
  double value = 0.0;
  parameters.read("key", value);
  EXPECT_EQ(parameters.unknownKeys(), std::vector<std::string>{"other"});
}

TEST(ParametersTest, WhatIsNoMapIsRefused) {
  EXPECT_NE(errorOf([] { parse("[1, 2]"); }).find("a_nodelet"), std::string::npos);
  EXPECT_NE(errorOf([] { parse("0.5"); }).find("a_nodelet"), std::string::npos);
}

TEST(ParametersTest, ANumberThatMayBeAbsentIsAbsentWhereItIsNotSet) {
  EXPECT_EQ(readOne("key: 0.25", std::optional<double>()), 0.25);
  EXPECT_EQ(readOne("key: 0", std::optional<double>()), 0.0);
  EXPECT_EQ(readOne("other: 1", std::optional<double>()), std::nullopt);
  EXPECT_EQ(readOne("other: 1", std::optional<double>(0.5)), 0.5);
  EXPECT_EQ(errorOf([] { readOne("key: wide", std::optional<double>()); }),
            "a_nodelet/key: wide is not a number");
}

TEST(ParametersTest, MapsOfNumbersAreRead) {
  using Numbers = std::map<std::string, double>;
  EXPECT_EQ(readOne("key: {torso: 0.1, lid: 2}", Numbers()), (Numbers{{"torso", 0.1}, {"lid", 2}}));
  EXPECT_TRUE(readOne("key: {}", Numbers{{"torso", 0.1}}).empty()) << "set, and empty";
  EXPECT_EQ(readOne("", Numbers{{"torso", 0.1}}).size(), 1U);
  EXPECT_EQ(errorOf([] { readOne("key: {torso: up}", Numbers()); }),
            "a_nodelet/key: {torso: up} is not a map of names and numbers");
  EXPECT_EQ(errorOf([] { readOne("key: [torso, 1]", Numbers()); }),
            "a_nodelet/key: [torso, 1] is not a map of names and numbers");
  EXPECT_EQ(errorOf([] { readOne("key: 1", Numbers()); }),
            "a_nodelet/key: 1 is not a map of names and numbers");
}

TEST(ParametersTest, MapsOfListsAreRead) {
  using Lists = std::map<std::string, std::vector<std::string>>;
  const Lists expected{{"arm", {"upper_*", "lower"}}, {"none", {}}};
  EXPECT_EQ(readOne("key: {arm: ['upper_*', lower], none: []}", Lists()), expected);
  EXPECT_EQ(errorOf([] { readOne("key: {arm: upper}", Lists()); }),
            "a_nodelet/key: {arm: upper} is not a map of names and lists of texts");
  EXPECT_EQ(errorOf([] { readOne("key: {arm: {a: b}}", Lists()); }),
            "a_nodelet/key: {arm: {a: b}} is not a map of names and lists of texts");
}

TEST(ParametersTest, TheEntriesOfAListOfMapsAreReadOneByOne) {
  Parameters parameters = parse("key: [{links: [a], scale: 2}, {padding_m: 0.1, colour: red}]");
  std::vector<Parameters> entries = parameters.readList("key");
  ASSERT_EQ(entries.size(), 2U);
  EXPECT_TRUE(parameters.unknownKeys().empty());
  std::vector<std::string> links;
  entries[0].read("links", links);
  EXPECT_EQ(links, std::vector<std::string>{"a"});
  std::optional<double> scale;
  entries[1].read("scale", scale);
  EXPECT_EQ(scale, std::nullopt);
  double padding = 0.0;
  entries[1].read("padding_m", padding);
  EXPECT_EQ(padding, 0.1);
  EXPECT_EQ(entries[0].unknownKeys(), std::vector<std::string>{"scale"});
  EXPECT_EQ(entries[1].unknownKeys(), std::vector<std::string>{"colour"});
}

TEST(ParametersTest, AListOfMapsThatIsNotSetOrEmptyHasNoEntries) {
  EXPECT_TRUE(parse("other: 1").readList("key").empty());
  EXPECT_TRUE(parse("").readList("key").empty());
  EXPECT_TRUE(parse("key: []").readList("key").empty());
}

TEST(ParametersTest, WhatIsNoListOfMapsIsRefusedNamingTheEntry) {
  EXPECT_EQ(errorOf([] { static_cast<void>(parse("key: 3").readList("key")); }),
            "a_nodelet/key: 3 is not a list of maps");
  EXPECT_NE(errorOf([] {
              static_cast<void>(parse("key: {links: [a]}").readList("key"));
            }).find("a_nodelet/key"),
            std::string::npos)
      << "the dash in front was forgotten";
  EXPECT_NE(errorOf([] {
              static_cast<void>(parse("key: [{a: 1}, 2]").readList("key"));
            }).find("a_nodelet/key[1]"),
            std::string::npos);
  EXPECT_EQ(errorOf([] {
              double scale = 0.0;
              parse("key: [{scale: 1}, {scale: big}]").readList("key")[1].read("scale", scale);
            }),
            "a_nodelet/key[1]/scale: big is not a number");
}

}  // namespace
}  // namespace tccm
