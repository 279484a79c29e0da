#pragma once

#include <string>
#include <vector>

namespace tccm {

/// A configuration that holds what differs from the defaults, each value with where it comes from.
class ConfigDraft {
 public:
  /// Takes the place of what the key had. @param section names with slashes between, from the top.
  /// @param value as YAML has it. @param why for people, one line; may be empty.
  void set(const std::string& section, const std::string& key, const std::string& value,
           const std::string& why);
  void set(const std::string& section, const std::string& key, double value,
           const std::string& why);
  void remove(const std::string& section, const std::string& key);
  /// A remark at the top, one line.
  void remark(const std::string& text) { remarks_.push_back(text); }

  [[nodiscard]] std::string yaml() const;

 private:
  struct Entry {
    std::string key, value, why;
  };
  struct Section {
    std::string name;  ///< with slashes
    std::vector<Entry> entries;
  };
  Section& section(const std::string& name);

  std::vector<std::string> remarks_;
  std::vector<Section> sections_;  ///< in the order of their names
};

/// What stands between the slashes, where anything does.
[[nodiscard]] std::vector<std::string> partsOf(const std::string& path);

/// `[a, b]`.
[[nodiscard]] std::string yamlList(const std::vector<std::string>& names);

}  // namespace tccm
