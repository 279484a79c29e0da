#include "config/parameter_table.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cstdio>
#include <sstream>

#include "base/printable.h"
#include "config/yaml_file.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

std::string flowText(const YAML::Node& node) {
  YAML::Emitter emitter;
  emitter << YAML::Flow << node;
  return emitter.c_str();
}

/// What a member takes, for errors; in the order of the types of Member.
constexpr const char* kTypeNames[] = {"true or false",
                                      "a whole number",
                                      "a whole number of at least 0",
                                      "a number",
                                      "a number",
                                      "a text",
                                      "a list of texts",
                                      "a map of names and numbers",
                                      "a map of names and lists of texts"};
static_assert(std::size(kTypeNames) == std::variant_size_v<ParameterTable::Member>);

struct Take {
  const YAML::Node& node;
  template <typename T>
  void operator()(T* member) const {
    *member = node.as<T>();
  }
  void operator()(std::optional<double>* member) const { *member = node.as<double>(); }
};

struct RequireRange {
  const ParameterTable::Row& row;
  void operator()(const std::optional<double>* member) const {
    if (*member) (*this)(&**member);
  }
  template <typename T>
  void operator()(const T* member) const {
    if constexpr (std::is_arithmetic_v<T>) {
      requireInRange(row.key, static_cast<double>(*member), row.range.lowest, row.range.highest);
    }
    if constexpr (std::is_same_v<T, std::map<std::string, double>>) {
      for (const auto& [name, value] : *member) {
        requireInRange(row.key + "/" + name, value, row.range.lowest, row.range.highest);
      }
    }
  }
};

struct Text {
  template <typename T>
  std::string operator()(const T* value) const {
    return flowText(YAML::Node(*value));
  }
  std::string operator()(const double* value) const {
    char number[32];
    std::snprintf(number, sizeof number, "%.15g", *value);
    const std::string text = number;
    return text.find_first_of(".en") == std::string::npos ? text + ".0" : text;
  }
  std::string operator()(const std::optional<double>* value) const {
    return *value ? (*this)(&**value) : "~";
  }
  /// In quotes where it would be something else without.
  std::string operator()(const std::string* value) const {
    YAML::Emitter emitter;
    emitter << *value;
    return emitter.c_str();
  }
};

}  // namespace

void requireInRange(const std::string& key, double value, double lowest, double highest) {
  if (value >= lowest && value <= highest) return;  // false for NaN
  std::ostringstream message;
  message << key << ": " << value << " is outside the allowed range [" << lowest << ", " << highest
          << "]";
  throw ConfigError(message.str());
}

std::string textOf(const ParameterTable::Member& member) { return std::visit(Text(), member); }

ParameterTable::Names ParameterTable::load(const YAML::Node& node, const std::string& owner) {
  Names unknown;
  if (!node || node.IsNull()) return unknown;
  if (!node.IsMap()) throw ConfigError(owner + ": its parameters are no map of keys and values");
  const auto refuse = [&](const std::string& key, const YAML::Node& value, const char* type) {
    throw ConfigError(
        printable(lineText(value) + owner + "/" + key + ": " + flowText(value), kLineMax) +
        " is not " + type);
  };
  for (const Row& row : rows_) {
    const YAML::Node value = node[row.key];
    if (!value) continue;
    try {
      std::visit(Take{value}, row.member);
    } catch (const YAML::Exception&) {
      refuse(row.key, value, kTypeNames[row.member.index()]);
    }
    try {
      std::visit(RequireRange{row}, row.member);
    } catch (const ConfigError& error) {
      throw ConfigError(printable(lineText(value) + owner + "/" + error.what(), kLineMax));
    }
  }
  for (const List& list : lists_) {
    const YAML::Node value = node[list.key];
    if (!value) continue;
    if (!value.IsSequence()) refuse(list.key, value, "a list of maps");
    std::vector<ParameterTable> tables = list.resize(value.size());
    for (std::size_t i = 0; i < tables.size(); ++i) {
      const std::string entry = owner + "/" + list.key + "[" + std::to_string(i) + "]";
      const Names slips = tables[i].load(value[i], entry);
      if (!slips.empty()) {
        throw ConfigError(printable(lineText(value[i]) + entry + "/" + slips.front(), kLineMax) +
                          ": there is no such parameter");
      }
    }
  }
  for (const auto& entry : node) {
    const auto key = entry.first.as<std::string>();
    const auto is_it = [&key](const auto& row) { return row.key == key; };
    if (std::none_of(rows_.begin(), rows_.end(), is_it) &&
        std::none_of(lists_.begin(), lists_.end(), is_it)) {
      unknown.push_back(key);
    }
  }
  return unknown;
}

std::string ParameterTable::differencesFrom(const ParameterTable& other) const {
  std::string text;
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    const std::string now = textOf(rows_[i].member), then = textOf(other.rows_[i].member);
    if (now == then) continue;
    for (const char* const part :
         {"\n  ", rows_[i].key.c_str(), ": ", now.c_str(), "  # ", then.c_str()}) {
      text += part;
    }
  }
  for (const List& list : lists_) {
    if (list.size() == 0) continue;
    text += "\n  " + list.key + ": " + std::to_string(list.size()) + " entries  # none";
  }
  return text;
}

void ParameterTable::requireRanges() const {
  for (const Row& row : rows_) std::visit(RequireRange{row}, row.member);
}

std::string ParameterTable::yaml() const {
  std::string text;
  for (const Row& row : rows_) {
    text += "  " + row.key + ": " + textOf(row.member) + "  # " + row.meaning + "\n";
  }
  for (const List& list : lists_) text += "  " + list.key + ": []  # " + list.meaning + "\n";
  return text;
}

}  // namespace tccm
