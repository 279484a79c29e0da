#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "config/parameter_table.h"
#include "tccm_monitor/shape.h"

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

/// How the parameters of one use of the body are called, and what they mean for it.
struct LinkUseKeys {
  std::string links, ignored, scale, padding, exceptions;
  std::string links_meaning = {}, padding_meaning = {};
};

/// Which of the monitored links one use of the body takes (self filter, collision, occlusion), and
/// how their primitives grow for it. Links are named as LinkSelector takes them.
struct LinkUse {
  /// For some links another growth than for the rest.
  struct Exception {
    std::vector<std::string> links;
    std::optional<double> scale;
    std::optional<double> padding_m;

    void describe(ParameterTable& table);
  };

  std::vector<std::string> links;    ///< empty: all
  std::vector<std::string> ignored;  ///< taken out again
  Expansion expansion;
  std::vector<Exception> exceptions;  ///< of several for one link the last counts
  /// Grasped objects are taken whichever links are; otherwise as their link is.
  bool all_objects = true;

  LinkUse() = default;
  explicit LinkUse(const Expansion& all) : expansion(all) {}

  using Keys = LinkUseKeys;
  void describe(ParameterTable& table, const Keys& keys, Tunable growth = Tunable::kNo);
  /// @throws ConfigError
  void validate(const Keys& keys) const;
};

extern const LinkUse::Keys kSelfFilterKeys;
extern const LinkUse::Keys kCollisionKeys;
extern const LinkUse::Keys kOcclusionKeys;

/// The model's shapes that a use takes, with the growth of each.
struct UsedShapes {
  std::vector<std::size_t> shapes;  ///< indices into RobotModel::shapes()
  std::vector<Expansion> expansions;
};

}  // namespace tccm
