#include "config/yaml_file.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <random>
#include <string>
#include <vector>

#include "monitor_config.h"
#include "support/error_of.h"

namespace tccm {
namespace {

constexpr int kMembers = 60;

std::string errorOf(const std::string& text) {
  return test::errorOf([&text] { requireUnambiguous(text, "robot.yaml"); });
}

bool names(const std::string& message, const std::string& what) {
  return message.find(what) != std::string::npos;
}

std::string lineText(std::size_t line) { return "line " + std::to_string(line + 1) + ":"; }

/// A configuration as people write them: sections with some keys, comments, lists and maps.
class SomeConfig {
 public:
  explicit SomeConfig(unsigned seed) : random_(seed) {
    MonitorConfig config;
    config.visitSections([this](const std::string& name, auto& section, const std::string&) {
      lines_.push_back(name + ":");
      const ParameterTable table = tableOf(section);
      for (const ParameterTable::Row& row : table.rows()) {
        if (pick(3) == 0) add(row);
      }
      if (lines_.back() == name + ":") add(table.rows().front());
    });
  }

  [[nodiscard]] std::size_t pick(std::size_t count) {
    return std::uniform_int_distribution<std::size_t>(0, count - 1)(random_);
  }
  /// The number of a line that has a parameter.
  [[nodiscard]] std::size_t someKey() {
    while (true) {
      const std::size_t line = pick(lines_.size());
      if (lines_[line].rfind("  ", 0) == 0 && lines_[line][2] != '#') {
        return line;
      }
    }
  }
  [[nodiscard]] std::string keyIn(std::size_t line) const {
    return lines_[line].substr(2, lines_[line].find(':') - 2);
  }
  /// The first line behind the section that a line is in.
  [[nodiscard]] std::size_t endOfSection(std::size_t line) const {
    while (line < lines_.size() && (lines_[line].empty() || lines_[line][0] == ' ')) ++line;
    return line;
  }
  std::vector<std::string>& lines() { return lines_; }
  [[nodiscard]] std::string text() const {
    std::string text;
    for (const std::string& line : lines_) text += line + "\n";
    return text;
  }

 private:
  void add(const ParameterTable::Row& row) {
    std::string line = "  " + row.key + ": " + textOf(row.member);
    if (pick(4) == 0) line += "  # \t'" + row.meaning;
    lines_.push_back(line);
    if (pick(6) == 0) lines_.emplace_back("  # horizon_s: 0.5");
  }

  std::mt19937 random_;
  std::vector<std::string> lines_;
};

TEST(YamlFileTest, WhatPeopleWriteIsTaken) {
  for (unsigned seed = 0; seed < kMembers; ++seed) {
    const std::string text = SomeConfig(seed).text();
    EXPECT_EQ(errorOf(text), "") << text;
  }
  EXPECT_EQ(errorOf(""), "");
  EXPECT_EQ(errorOf("# nothing\n"), "");
  EXPECT_EQ(errorOf("a: &x {k: 1}\nb: *x\nc: {k: 1}\nd: [{k: 1}, {k: 2}]\n"), "");
  EXPECT_EQ(errorOf("a: 'it\tis'  \t# a tab\n\t\nb: \"one\ttab\"\t\n"), "");
  EXPECT_EQ(errorOf("a: '.nan'\nb: inf.stl\n"), "");
  EXPECT_EQ(errorOf("{\"a\": {\"b\": -1}, \"c\": [1.5, null]}"), "");
}

TEST(YamlFileTest, AKeyGivenTwiceIsRefusedWithBothLines) {
  for (unsigned seed = 0; seed < kMembers; ++seed) {
    SomeConfig config(seed);
    const std::size_t first = config.someKey();
    const std::string key = config.keyIn(first);
    const std::size_t end = config.endOfSection(first);
    const std::size_t second = first + 1 + config.pick(end - first);
    config.lines().insert(config.lines().begin() + static_cast<std::ptrdiff_t>(second),
                          "  " + key + ": 1");
    const std::string error = errorOf(config.text());
    EXPECT_TRUE(names(error, "robot.yaml: " + lineText(second))) << error << config.text();
    EXPECT_TRUE(names(error, "'" + key + "' is given twice")) << error;
    EXPECT_TRUE(names(error, "first in line " + std::to_string(first + 1))) << error;
  }
}

TEST(YamlFileTest, ASectionGivenTwiceIsRefused) {
  for (unsigned seed = 0; seed < kMembers; ++seed) {
    SomeConfig config(seed);
    config.lines().emplace_back("tccm_mapper: {}");
    const std::string error = errorOf(config.text());
    EXPECT_TRUE(names(error, lineText(config.lines().size() - 1))) << error;
    EXPECT_TRUE(names(error, "'tccm_mapper' is given twice")) << error;
  }
  EXPECT_TRUE(names(errorOf("a: {b: 1, \"b\": 2}"), "a: 'b' is given twice"));
  EXPECT_TRUE(names(errorOf("a: [{b: 1}, {c: 1, c: 2}]"), "'c' is given twice"));
}

TEST(YamlFileTest, AMergeKeyIsRefused) {
  for (unsigned seed = 0; seed < kMembers; ++seed) {
    SomeConfig config(seed);
    const std::size_t line = config.someKey() + 1;
    config.lines().insert(config.lines().begin(), "topics_of_all: &all {scan: /scan}");
    config.lines().insert(config.lines().begin() + static_cast<std::ptrdiff_t>(line + 1),
                          "  <<: *all");
    const std::string error = errorOf(config.text());
    EXPECT_TRUE(names(error, lineText(line + 1)) && names(error, "merge key")) << error;
  }
}

TEST(YamlFileTest, WhatTheParserQuotesIsMadeFitForOneLine) {
  const std::string message = errorOf("checker: \"\\\b\"\n");
  EXPECT_TRUE(names(message, "it is no YAML")) << message;
  EXPECT_TRUE(std::none_of(message.begin(), message.end(), [](unsigned char c) {
    return c < 0x20U || c == 0x7fU;
  })) << message;
}

TEST(YamlFileTest, ATabIsRefused) {
  for (unsigned seed = 0; seed < kMembers; ++seed) {
    SomeConfig config(seed);
    const std::size_t line = config.someKey();
    std::string& text = config.lines()[line];
    if (config.pick(2) == 0) {
      text.replace(0, 2, "\t");
    } else {
      text.replace(text.find(": "), 2, ":\t");
    }
    const std::string error = errorOf(config.text());
    EXPECT_TRUE(names(error, lineText(line)) && names(error, "tab")) << error << text;
  }
}

TEST(YamlFileTest, NanAndInfinityAreRefused) {
  const std::vector<std::string> numbers{".nan", ".NaN", ".NAN", ".inf", "-.inf", "+.Inf", "-.INF"};
  for (unsigned seed = 0; seed < kMembers; ++seed) {
    SomeConfig config(seed);
    const std::size_t line = config.someKey();
    const std::string number = numbers[config.pick(numbers.size())];
    const bool in_list = config.pick(3) == 0;
    config.lines()[line] =
        "  " + config.keyIn(line) + ": " + (in_list ? "[1.0, " + number + "]" : number);
    const std::string error = errorOf(config.text());
    EXPECT_TRUE(names(error, lineText(line)) && names(error, number)) << error;
    EXPECT_TRUE(names(error, config.keyIn(line))) << error;
  }
}

TEST(YamlFileTest, WhatIsNoYamlOrTwoDocumentsIsRefusedWithItsLine) {
  EXPECT_TRUE(names(errorOf("a: 1\n---\nb: 2\n"), "second document"));
  EXPECT_TRUE(names(errorOf("a: 1\nb: [1, 2\n"), "line "));
  EXPECT_TRUE(names(errorOf("a: 1\n? {b: 1}\n: 2\n"), "line 2"));
}

TEST(YamlFileTest, DeepNestingIsRefusedBeforeAParserOverflowsItsStackOverIt) {
  for (const char* const nest : {"[", "{a: ", "- ", "? "}) {
    std::string deep = "a: ";
    if (nest[0] == '-' || nest[0] == '?') deep.clear();
    for (int i = 0; i < 100000; ++i) deep += nest;
    EXPECT_TRUE(names(errorOf(deep), "nested too deeply")) << nest;
  }
  EXPECT_EQ(errorOf("a: " + std::string(50, '[') + std::string(50, ']')), "");
}

TEST(YamlFileTest, WhatIsRefusedIsToldInOneLineWhateverAKeyIsCalled) {
  const std::string error = errorOf("\"a\\nb\": 1\n\"a\\nb\": 2\n");
  EXPECT_TRUE(names(error, "'a b' is given twice")) << error;
}

TEST(YamlFileTest, AFileThatCannotBeReadIsRefusedByName) {
  EXPECT_TRUE(names(test::errorOf([] { (void)loadYamlFile("/nowhere/robot.yaml"); }),
                    "/nowhere/robot.yaml"));
}

/// Somebody's configuration with a key given twice.
TEST(YamlFileTest, TheCaseThatWasBelievedIsRefused) {
  const std::string path =
      std::string(TCCM_SHARED_DATA_DIR) + "/cases/yaml-duplicate-keys/dup.yaml";
  if (!std::ifstream(path)) GTEST_SKIP() << path << " is not there";
  const std::string error = test::errorOf([&path] { (void)readMonitorConfig(path); });
  EXPECT_TRUE(names(error, "support_points") && names(error, "line 7")) << error;
}

}  // namespace
}  // namespace tccm
