#include "tccm_monitor/ros/parameters.h"

#include <gtest/gtest.h>

#include <functional>

#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

Parameters parse(const std::string& yaml) { return {YAML::Load(yaml), "a_nodelet"}; }

std::string errorOf(const std::function<void()>& action) {
  try {
    action();
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "nothing was thrown";
}

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

}  // namespace
}  // namespace tccm
