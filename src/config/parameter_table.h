#pragma once

#include <cstddef>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

namespace YAML {
class Node;
}

namespace tccm {

/// What a number has to be within, both included; it has to be finite.
struct Range {
  double lowest = std::numeric_limits<double>::lowest();
  double highest = std::numeric_limits<double>::max();
};

/// Whether a parameter may be changed while the robot moves (dynamic_reconfigure).
enum class Tunable { kNo, kYes };

/// All that the package knows of each parameter of one configuration, a row each: from it come
/// loading, refusals, tuning, config/default.yaml and docs/parameters.md. The default is what the
/// member was when it was described.
class ParameterTable {
 public:
  using Names = std::vector<std::string>;
  /// The member of the configuration that a row stands for.
  using Member =
      std::variant<bool*, int*, std::size_t*, double*, std::optional<double>*, std::string*, Names*,
                   std::map<std::string, double>*, std::map<std::string, Names>*>;

  struct Row {
    std::string key;  ///< with its unit, as users write it
    Member member;
    std::string unit;
    Range range;
    std::string meaning;  ///< one sentence
    Tunable tunable = Tunable::kNo;
  };

  struct List {
    std::string key;
    std::string meaning;
    std::function<std::vector<ParameterTable>(std::size_t)> resize;
    std::function<std::size_t()> size;
  };

  void add(const std::string& key, Member member, const std::string& unit, Range range,
           const std::string& meaning, Tunable tunable = Tunable::kNo) {
    rows_.push_back({key, member, unit, range, meaning, tunable});
  }
  /// A switch, a text, or a list.
  void add(const std::string& key, Member member, const std::string& meaning,
           Tunable tunable = Tunable::kNo) {
    add(key, member, "", {}, meaning, tunable);
  }
  /// A list of small configurations, each described like this one.
  template <typename Entry>
  void addList(const std::string& key, std::vector<Entry>& entries, const std::string& meaning) {
    const auto resize = [&entries](std::size_t size) {
      entries.resize(size);
      std::vector<ParameterTable> tables(size);
      for (std::size_t i = 0; i < size; ++i) entries[i].describe(tables[i]);
      return tables;
    };
    lists_.push_back({key, meaning, resize, [&entries] { return entries.size(); }});
  }

  [[nodiscard]] const std::vector<Row>& rows() const { return rows_; }
  [[nodiscard]] const std::vector<List>& lists() const { return lists_; }

  /// Takes what is set; the rest stays as it is.
  /// @param node a map of keys and values, or nothing. @param owner names it in errors.
  /// @return the keys that no row has.
  /// @throws ConfigError naming owner, key and value where one is not of the member's type.
  Names load(const YAML::Node& node, const std::string& owner);
  /// @throws ConfigError naming the first key whose value is out of its range.
  void requireRanges() const;

  /// A line for each parameter whose value is another one there, with both; each after a line end.
  /// @param other of the same type of configuration.
  [[nodiscard]] std::string differencesFrom(const ParameterTable& other) const;

  /// A section of config/default.yaml: a line for each row, as it is now.
  [[nodiscard]] std::string yaml() const;

 private:
  std::vector<Row> rows_;
  std::vector<List> lists_;
};

/// As users write it in YAML.
[[nodiscard]] std::string textOf(const ParameterTable::Member& member);

template <typename Config>
[[nodiscard]] ParameterTable tableOf(Config& config) {
  ParameterTable table;
  config.describe(table);
  return table;
}

/// What of a configuration is not as by default, a line each; empty where all is.
template <typename Config>
[[nodiscard]] std::string differencesFromDefaults(Config config) {
  Config defaults;
  return tableOf(config).differencesFrom(tableOf(defaults));
}

/// Whether a configuration's values have to fit each other, beyond their ranges.
template <typename Config, typename = void>
struct HasValidate : std::false_type {};
template <typename Config>
struct HasValidate<Config, decltype(std::declval<const Config&>().validate())> : std::true_type {};

/// The same configuration. @throws ConfigError naming a key whose value is not allowed.
template <typename Config>
const Config& validated(const Config& config) {
  Config copy = config;
  tableOf(copy).requireRanges();
  if constexpr (HasValidate<Config>::value) config.validate();
  return config;
}

}  // namespace tccm
