#pragma once

#include <map>
#include <string>
#include <vector>

namespace tccm {

/// Finds the links that a configuration means: by name, by a pattern with * and ?, or by the name
/// of a group of such.
class LinkSelector {
 public:
  using Groups = std::map<std::string, std::vector<std::string>>;

  /// @param links all that the robot has.
  /// @throws ConfigError where a group has a link's name, is empty, or matches nothing.
  LinkSelector(const Groups& groups, std::vector<std::string> links);

  /// Whether one of `wanted` means the link.
  [[nodiscard]] bool matches(const std::vector<std::string>& wanted, const std::string& link) const;
  /// Every entry has to mean one of `links`: a slip in a name must not leave a link unwatched.
  /// @throws ConfigError naming key and entry.
  void requireMatches(const std::vector<std::string>& wanted, const std::vector<std::string>& links,
                      const std::string& key) const;
  /// The same over all links of the robot.
  void requireMatches(const std::vector<std::string>& wanted, const std::string& key) const {
    requireMatches(wanted, links_, key);
  }

 private:
  Groups groups_;
  std::vector<std::string> links_;
};

}  // namespace tccm
