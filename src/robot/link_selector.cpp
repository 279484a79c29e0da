#include "robot/link_selector.h"

#include <fnmatch.h>

#include <algorithm>

#include "tccm_monitor/config_error.h"

namespace tccm {
LinkSelector::LinkSelector(const Groups& groups, std::vector<std::string> links)
    : links_(std::move(links)) {
  for (const auto& [group, members] : groups) {
    const std::string key = "link_groups/" + group;
    if (std::find(links_.begin(), links_.end(), group) != links_.end()) {
      throw ConfigError(key + ": a link of robot_description has that name");
    }
    if (members.empty()) throw ConfigError(key + ": it is empty");
    requireMatches(members, key);
  }
  groups_ = groups;  // only now: a group has no groups in it
}

bool LinkSelector::matches(const std::vector<std::string>& wanted, const std::string& link) const {
  const auto fits = [&](const std::string& pattern) {
    return fnmatch(pattern.c_str(), link.c_str(), 0) == 0;
  };
  return std::any_of(wanted.begin(), wanted.end(), [&](const std::string& entry) {
    const auto group = groups_.find(entry);
    if (group == groups_.end()) return fits(entry);
    return std::any_of(group->second.begin(), group->second.end(), fits);
  });
}

void LinkSelector::requireMatches(const std::vector<std::string>& wanted,
                                  const std::vector<std::string>& links,
                                  const std::string& key) const {
  for (const std::string& entry : wanted) {
    const auto isIn = [&](const std::vector<std::string>& list) {
      return std::any_of(list.begin(), list.end(),
                         [&](const std::string& link) { return matches({entry}, link); });
    };
    if (isIn(links)) continue;
    throw ConfigError(key + ": '" + entry + "' matches no " +
                      (isIn(links_) ? "monitored link" : "link of robot_description"));
  }
}

}  // namespace tccm
