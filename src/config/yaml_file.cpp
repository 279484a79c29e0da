#include "config/yaml_file.h"

#include <yaml-cpp/eventhandler.h>

#include <fstream>
#include <iterator>
#include <map>
#include <sstream>
#include <string_view>
#include <vector>

#include "base/printable.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

[[noreturn]] void refuse(const std::string& name, int line, const std::string& why) {
  throw ConfigError(printable(name + ": line " + std::to_string(line + 1) + ": " + why, kLineMax));
}

/// Whether yaml-cpp and PyYAML both take a plain word for NaN or infinity.
bool isNotFinite(std::string word) {
  if (!word.empty() && (word[0] == '-' || word[0] == '+')) word.erase(0, 1);
  for (const char* const text : {".nan", ".NaN", ".NAN", ".inf", ".Inf", ".INF"}) {
    if (word == text) return true;
  }
  return false;
}

/// Follows a text's structure, and refuses what is not read alike by all.
class Auditor : public YAML::EventHandler {
  using Mark = YAML::Mark;
  using Text = const std::string&;
  using Style = YAML::EmitterStyle::value;

 public:
  explicit Auditor(const std::string& name) : name_(name) {}

  void OnDocumentStart(const Mark& mark) override {
    if (++documents_ > 1) refuse(name_, mark.line, "a second document begins; only one is read");
  }
  void OnDocumentEnd() override {}
  void OnNull(const Mark& mark, YAML::anchor_t /*anchor*/) override { takeWord(mark, "~"); }
  void OnAlias(const Mark& mark, YAML::anchor_t /*anchor*/) override { takeWord(mark, ""); }
  void OnScalar(const Mark& mark, Text tag, YAML::anchor_t /*anchor*/, Text value) override {
    const bool is_value = levels_.empty() || !levels_.back().awaits_key;
    if (tag == "?" && is_value && isNotFinite(value)) {
      refuse(name_, mark.line, here() + value + " is no finite number");
    }
    takeWord(mark, value);
  }
  void OnSequenceStart(const Mark& mark, Text /*tag*/, YAML::anchor_t /*anchor*/,
                       Style /*style*/) override {
    begin(mark, false);
  }
  void OnMapStart(const Mark& mark, Text /*tag*/, YAML::anchor_t /*anchor*/,
                  Style /*style*/) override {
    begin(mark, true);
  }
  void OnSequenceEnd() override { end(); }
  void OnMapEnd() override { end(); }

 private:
  struct Level {
    bool is_map;
    bool awaits_key;
    std::map<std::string, int> lines;  ///< of its keys
    std::string key;                   ///< the last
  };

  /// The keys that lead to where the reader is, for people.
  [[nodiscard]] std::string here() const {
    std::string path;
    for (const Level& level : levels_) {
      if (level.is_map && !level.key.empty()) path += (path.empty() ? "" : "/") + level.key;
    }
    return path.empty() ? path : path + ": ";
  }

  void takeWord(const Mark& mark, const std::string& word) {
    if (levels_.empty()) return;
    Level& level = levels_.back();
    if (level.awaits_key) {
      level.key.clear();
      if (word == "<<") {
        refuse(name_, mark.line, here() + "the merge key << is not read; write the keys out");
      }
      const auto [first, is_new] = level.lines.emplace(word, mark.line);
      if (!is_new) {
        refuse(name_, mark.line,
               here() + "'" + word + "' is given twice, first in line " +
                   std::to_string(first->second + 1) + "; remove one");
      }
      level.key = word;
    }
    if (level.is_map) level.awaits_key = !level.awaits_key;
  }

  void begin(const Mark& mark, bool is_map) {
    if (!levels_.empty() && levels_.back().awaits_key) {
      refuse(name_, mark.line, here() + "a key has to be a word");
    }
    levels_.push_back({is_map, is_map, {}, ""});
  }
  void end() {
    levels_.pop_back();
    if (!levels_.empty() && levels_.back().is_map) levels_.back().awaits_key = true;
  }

  const std::string& name_;
  std::vector<Level> levels_;
  int documents_ = 0;
};

/// A tab that is neither in a comment nor quoted: PyYAML refuses it, yaml-cpp often does not.
bool hasTab(const std::string& line) {
  char quote = 0;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (quote != 0) {
      if (c == quote) quote = 0;
    } else if (c == '"' || c == '\'') {
      quote = c;
    } else if (c == '#' && (i == 0 || line[i - 1] == ' ' || line[i - 1] == '\t')) {
      return false;
    } else if (c == '\t') {
      // Blanks before a comment, or at a line's end, say nothing.
      const std::size_t next = line.find_first_not_of(" \t\r", i);
      if (next != std::string::npos && line[next] != '#') return true;
    }
  }
  return false;
}

void requireNoTab(const std::string& text, const std::string& name) {
  std::istringstream lines(text);
  std::string line;
  for (int i = 0; std::getline(lines, line); ++i) {
    if (hasTab(line)) refuse(name, i, "it has a tab; indent with spaces");
  }
}

}  // namespace

// Nested blocks on one line begin with its indicators, on several lines each is indented by one
// column at least; flow style nests by brackets.
bool isNestedDeeply(const std::string& text) {
  constexpr int kNestingMax = 100;
  constexpr int kIndentationMax = 1000;
  int brackets = 0;
  int indicators = 0;
  int column = 0;
  bool line_begins = true;
  for (const char c : text) {
    if (c == '\n') column = indicators = 0;
    line_begins =
        c == '\n' || (line_begins && std::string_view(" \t-?:").find(c) != std::string_view::npos);
    if (line_begins && c != '\n') ++column;
    if (line_begins && (c == '-' || c == '?' || c == ':')) ++indicators;
    if (c == '[' || c == '{') ++brackets;
    if ((c == ']' || c == '}') && brackets > 0) --brackets;
    if (brackets > kNestingMax || indicators > kNestingMax || column > kIndentationMax) return true;
  }
  return false;
}

void requireUnambiguous(const std::string& text, const std::string& name) {
  if (isNestedDeeply(text)) throw ConfigError(name + ": its lists are nested too deeply");
  requireNoTab(text, name);
  try {
    std::istringstream stream(text);
    YAML::Parser parser(stream);
    Auditor auditor(name);
    while (parser.HandleNextDocument(auditor)) {
    }
  } catch (const YAML::Exception& error) {
    throw ConfigError(name + ": line " + std::to_string(error.mark.line + 1) +
                      ": it is no YAML: " + printable(error.msg));
  }
}

YAML::Node loadYamlFile(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  if (!file) throw ConfigError(path + ": it cannot be read");
  requireUnambiguous(text, path);
  return YAML::Load(text);
}

std::string lineText(const YAML::Node& node) {
  const YAML::Mark mark = node.Mark();
  return mark.is_null() ? "" : "line " + std::to_string(mark.line + 1) + ": ";
}

}  // namespace tccm
