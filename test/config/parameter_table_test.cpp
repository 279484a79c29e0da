#include "config/parameter_table.h"

#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <cctype>
#include <functional>
#include <limits>

#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

using Names = ParameterTable::Names;

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
  ParameterTable table;
  table.add("key", &value, "a value");
  table.load(YAML::Load(yaml), "a_nodelet");
  return value;
}

TEST(ParameterTableTest, EveryTypeIsRead) {
  EXPECT_TRUE(readOne("key: true", false));
  EXPECT_EQ(readOne("key: -3", 0), -3);
  EXPECT_EQ(readOne("key: 7", std::size_t{0}), 7U);
  EXPECT_EQ(readOne("key: 0.25", 0.0), 0.25);
  EXPECT_EQ(readOne("key: hand", std::string()), "hand");
  const Names links{"a", "b*"};
  EXPECT_EQ(readOne("key: [a, 'b*']", Names()), links);
  EXPECT_TRUE(readOne("key: []", links).empty());
}

TEST(ParameterTableTest, AWholeNumberDoesForANumber) { EXPECT_EQ(readOne("key: 2", 0.5), 2.0); }

TEST(ParameterTableTest, WhatIsNotSetKeepsItsDefault) {
  EXPECT_EQ(readOne("other: 1", 0.5), 0.5);
  EXPECT_EQ(readOne("", 42), 42);
  EXPECT_EQ(readOne("{}", std::string("default")), "default");
}

TEST(ParameterTableTest, AWrongTypeIsRefusedNamingNodeletKeyAndValue) {
  EXPECT_EQ(errorOf([] { readOne("key: soon", 0.5); }),
            "line 1: a_nodelet/key: soon is not a number");
  EXPECT_EQ(errorOf([] { readOne("key: 1.5", 0); }),
            "line 1: a_nodelet/key: 1.5 is not a whole number");
  EXPECT_EQ(errorOf([] { readOne("key: [1, 2]", 0.5); }),
            "line 1: a_nodelet/key: [1, 2] is not a number");
  EXPECT_EQ(errorOf([] { readOne("key: maybe", false); }),
            "line 1: a_nodelet/key: maybe is not true or false");
  EXPECT_EQ(errorOf([] { readOne("key: hand", Names()); }),
            "line 1: a_nodelet/key: hand is not a list of texts");
  EXPECT_EQ(errorOf([] { readOne("key: {a: 1}", std::string()); }),
            "line 1: a_nodelet/key: {a: 1} is not a text");
  EXPECT_EQ(errorOf([] { readOne("key: -1", std::size_t{0}); }),
            "line 1: a_nodelet/key: -1 is not a whole number of at least 0");
}

TEST(ParameterTableTest, AValueOutOfItsRangeIsRefusedWithItsLine) {
  double value = 0.5;
  ParameterTable table;
  table.add("key", &value, "m", {0.0, 1.0}, "what it means");
  const std::string what = "a_nodelet/key: 7 is outside the allowed range [0, 1]";
  EXPECT_EQ(
      errorOf([&] { static_cast<void>(table.load(YAML::Load("other: 1\nkey: 7"), "a_nodelet")); }),
      "line 2: " + what);
  YAML::Node of_server;
  of_server["key"] = 7.0;
  EXPECT_EQ(errorOf([&] { static_cast<void>(table.load(of_server, "a_nodelet")); }), what);
}

TEST(ParameterTableTest, AKeyWithoutAValueIsRefused) {
  EXPECT_NE(errorOf([] { readOne("key:", 0.5); }).find("a_nodelet/key"), std::string::npos);
}

TEST(ParameterTableTest, KeysThatNoRowHasAreReturned) {
  double horizon = 0.0;
  ParameterTable table;
  table.add("horizon_s", &horizon, "how far");
  table.add("not_set", &horizon, "nothing");
  EXPECT_EQ(table.load(YAML::Load("{horizon_s: 0.5, horizont_s: 1.0, colour: red}"), "a_nodelet"),
            (Names{"horizont_s", "colour"}));
  EXPECT_TRUE(table.load(YAML::Load("{}"), "a_nodelet").empty());
}

TEST(ParameterTableTest, WhatIsNoMapIsRefused) {
  EXPECT_NE(errorOf([] { readOne("[1, 2]", 0); }).find("a_nodelet"), std::string::npos);
  EXPECT_NE(errorOf([] { readOne("0.5", 0); }).find("a_nodelet"), std::string::npos);
}

TEST(ParameterTableTest, ANumberThatMayBeAbsentIsAbsentWhereItIsNotSet) {
  EXPECT_EQ(readOne("key: 0.25", std::optional<double>()), 0.25);
  EXPECT_EQ(readOne("key: 0", std::optional<double>()), 0.0);
  EXPECT_EQ(readOne("other: 1", std::optional<double>()), std::nullopt);
  EXPECT_EQ(errorOf([] { readOne("key: wide", std::optional<double>()); }),
            "line 1: a_nodelet/key: wide is not a number");
}

TEST(ParameterTableTest, MapsAreRead) {
  using Numbers = std::map<std::string, double>;
  using Lists = std::map<std::string, Names>;
  EXPECT_EQ(readOne("key: {torso: 0.1, lid: 2}", Numbers()), (Numbers{{"torso", 0.1}, {"lid", 2}}));
  EXPECT_TRUE(readOne("key: {}", Numbers{{"torso", 0.1}}).empty()) << "set, and empty";
  EXPECT_EQ(errorOf([] { readOne("key: {torso: up}", Numbers()); }),
            "line 1: a_nodelet/key: {torso: up} is not a map of names and numbers");
  EXPECT_EQ(errorOf([] { readOne("key: [torso, 1]", Numbers()); }),
            "line 1: a_nodelet/key: [torso, 1] is not a map of names and numbers");
  EXPECT_EQ(readOne("key: {arm: ['upper_*', lower], none: []}", Lists()),
            (Lists{{"arm", {"upper_*", "lower"}}, {"none", {}}}));
  EXPECT_EQ(errorOf([] { readOne("key: {arm: upper}", Lists()); }),
            "line 1: a_nodelet/key: {arm: upper} is not a map of names and lists of texts");
}

struct Entry {
  Names links;
  double padding_m = 0.5;
  void describe(ParameterTable& table) {
    table.add("links", &links, "which");
    table.add("padding_m", &padding_m, "m", {0.0, 1.0}, "how much");
  }
};

std::vector<Entry> entriesOf(const std::string& yaml) {
  std::vector<Entry> entries{{{"old"}, 0.1}};
  ParameterTable table;
  table.addList("key", entries, "some");
  table.load(YAML::Load(yaml), "a_nodelet");
  return entries;
}

TEST(ParameterTableTest, TheEntriesOfAListAreDescribedOneByOne) {
  const auto entries = entriesOf("key: [{links: [a]}, {padding_m: 0.2}]");
  ASSERT_EQ(entries.size(), 2U);
  EXPECT_EQ(entries[0].links, Names{"a"});
  EXPECT_EQ(entries[1].padding_m, 0.2);
  EXPECT_EQ(entriesOf("other: 1").size(), 1U) << "not set";
  EXPECT_TRUE(entriesOf("key: []").empty());
}

TEST(ParameterTableTest, WhatIsNoListOfEntriesIsRefusedNamingTheEntry) {
  EXPECT_EQ(errorOf([] { entriesOf("key: 3"); }), "line 1: a_nodelet/key: 3 is not a list of maps");
  EXPECT_EQ(errorOf([] { entriesOf("key: {links: [a]}"); }),
            "line 1: a_nodelet/key: {links: [a]} is not a list of maps");
  EXPECT_NE(errorOf([] { entriesOf("key: [{padding_m: 0.1}, 2]"); }).find("a_nodelet/key[1]"),
            std::string::npos);
  EXPECT_EQ(errorOf([] { entriesOf("key: [{}, {padding_m: big}]"); }),
            "line 1: a_nodelet/key[1]/padding_m: big is not a number");
  EXPECT_EQ(errorOf([] { entriesOf("key: [{colour: red}]"); }),
            "line 1: a_nodelet/key[0]/colour: there is no such parameter");
}

TEST(ParameterTableTest, AValueOutOfItsRangeIsRefusedNamingKeyValueAndRange) {
  for (const double bad : {-0.1, 1.1, std::numeric_limits<double>::quiet_NaN(),
                           std::numeric_limits<double>::infinity()}) {
    Entry entry{{}, bad};
    const std::string error = errorOf([&] { static_cast<void>(validated(entry)); });
    EXPECT_NE(error.find("padding_m: "), std::string::npos) << error;
    EXPECT_NE(error.find("[0, 1]"), std::string::npos) << error;
  }
  EXPECT_NO_THROW(static_cast<void>(validated(Entry{{}, 1.0})));
}

TEST(ParameterTableTest, EachRowIsALineOfYaml) {
  Entry entry;
  bool stops = true;
  ParameterTable table = tableOf(entry);
  table.add("stops", &stops, "whether it stops", Tunable::kYes);
  EXPECT_EQ(table.yaml(),
            "  links: []  # which\n  padding_m: 0.5  # how much\n"
            "  stops: true  # whether it stops\n");
}

TEST(ParameterTableTest, DefaultsReadBackAreTheSame) {
  double tiny = 2e-4;
  std::size_t large = 400000;
  double whole = 2.0;
  ParameterTable table;
  table.add("tiny", &tiny, "");
  table.add("large", &large, "");
  table.add("whole", &whole, "");
  const YAML::Node node = YAML::Load("a:\n" + table.yaml())["a"];
  EXPECT_EQ(node["tiny"].as<double>(), tiny);
  EXPECT_EQ(node["large"].as<std::size_t>(), large);
  EXPECT_EQ(node["whole"].as<std::string>(), "2.0");
}

TEST(ParameterTableTest, ATextReadBackIsTheSame) {
  for (const char* const text : {"base_link", "", "a: b", "run #3", "- a", "[a", "*a", "'", "\"",
                                 " a ", "a\nb", "~", "/data/stops", "!a", "%a", "@a", "{}"}) {
    std::string value = text, read;
    ParameterTable table, reader;
    table.add("key", &value, "a text");
    reader.add("key", &read, "a text");
    reader.load(YAML::Load("a:\n" + table.yaml())["a"], "a_nodelet");
    EXPECT_EQ(read, value) << table.yaml();
    reader.load(YAML::Load("key: " + textOf(&value) + "\n"), "a_nodelet");
    EXPECT_EQ(read, value) << "as a stop's parameters are written";
  }
}

TEST(ParameterTableTest, WhatIsRefusedIsToldInOneLineWhateverItSays) {
  for (const std::string& value : {std::string("\"a\\nb\\tc\\x7f\""), std::string(5000, 'a')}) {
    const std::string error = errorOf([&] { readOne("key: " + value, 0.5); });
    EXPECT_NE(error.find("is not a number"), std::string::npos) << error;
    EXPECT_LT(error.size(), 1100U);
    for (const char c : error) EXPECT_FALSE(std::iscntrl(static_cast<unsigned char>(c))) << error;
  }
}

TEST(ParameterTableTest, ANumberInAMapHasToBeFinite) {
  for (const char* const bad : {".nan", ".inf", "-.inf"}) {
    std::map<std::string, double> values;
    ParameterTable table;
    table.add("fixed_joints", &values, "positions");
    const std::string error = errorOf([&] {
      table.load(YAML::Load(std::string("fixed_joints: {elbow: ") + bad + ", wrist: 0.5}"),
                 "robot");
    });
    EXPECT_NE(error.find("fixed_joints/elbow"), std::string::npos) << error;
  }
}

TEST(ParameterTableTest, WhatDiffersFromTheDefaultsIsALineEach) {
  struct SomeConfig {
    double speed_mps = 0.25;
    std::string frame = "base_link";
    void describe(ParameterTable& table) {
      table.add("speed_mps", &speed_mps, "m/s", {0.0, 1.0}, "how fast");
      table.add("frame", &frame, "where");
    }
  };
  SomeConfig config;
  EXPECT_EQ(differencesFromDefaults(config), "");
  config.speed_mps = 0.5;
  EXPECT_EQ(differencesFromDefaults(config), "\n  speed_mps: 0.5  # 0.25");
  config.frame = "torso";
  EXPECT_EQ(differencesFromDefaults(config),
            "\n  speed_mps: 0.5  # 0.25\n  frame: torso  # base_link");
}

}  // namespace
}  // namespace tccm
