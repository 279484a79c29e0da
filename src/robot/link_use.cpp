#include "robot/link_use.h"

#include <fnmatch.h>

#include <algorithm>

#include "base/printable.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

constexpr Range kScales{1.0, 3.0};
constexpr Range kPaddings{0.0, 1.0};  // [m]

}  // namespace

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
    throw ConfigError(key + ": '" + printable(entry, kLineMax) + "' matches no " +
                      (isIn(links_) ? "monitored link" : "link of robot_description"));
  }
}

const LinkUse::Keys kSelfFilterKeys{
    "self_filter_links",
    "self_filter_ignored_links",
    "self_filter_scale",
    "self_filter_padding_m",
    "self_filter_exceptions",
    "of the monitored links those to filter out; empty: all",
    "points this near to the body are its own, and beams that pass it this near have met it: the "
    "error of model and calibration"};
const LinkUse::Keys kCollisionKeys{
    "collision_links",
    "collision_ignored_links",
    "primitive_scale",
    "collision_padding_m",
    "collision_exceptions",
    "of the monitored links those checked for collision; empty: all",
    "and then grow by this on every side; not tuned below `tuning_padding_min_m`"};
const LinkUse::Keys kOcclusionKeys{"occlusion_links",
                                   "occlusion_ignored_links",
                                   "occlusion_scale",
                                   "occlusion_padding_m",
                                   "occlusion_exceptions",
                                   "of the monitored links those that must be seen; empty: all",
                                   "and then grow by this on every side"};

void LinkUse::Exception::describe(ParameterTable& table) {
  table.add("links", &links, "whose growth is another");
  table.add("scale", &scale, "", kScales, "in place of that of the rest");
  table.add("padding_m", &padding_m, "m", kPaddings, "in place of that of the rest");
}

void LinkUse::describe(ParameterTable& table, const Keys& keys, Tunable growth) {
  table.add(keys.links, &links, keys.links_meaning);
  table.add(keys.ignored, &ignored, "taken out again");
  table.add(keys.scale, &expansion.scale, "", kScales, "primitives' sizes are multiplied by this",
            growth);
  table.add(keys.padding, &expansion.padding_m, "m", kPaddings, keys.padding_meaning, growth);
  table.addList(keys.exceptions, exceptions,
                "for some links another growth, as `[{links: [hands], scale: 1.1, padding_m: "
                "0.03}]`; the last that fits counts");
}

void LinkUse::validate(const Keys& keys) const {
  LinkUse copy = *this;
  ParameterTable table;
  copy.describe(table, keys);
  table.requireRanges();
  for (Exception exception : exceptions) {
    if (exception.links.empty()) throw ConfigError(keys.exceptions + ": links is missing or empty");
    if (!exception.scale && !exception.padding_m) {
      throw ConfigError(keys.exceptions + ": '" + exception.links.front() +
                        "' has neither scale nor padding_m");
    }
    try {
      tableOf(exception).requireRanges();
    } catch (const ConfigError& error) {
      throw ConfigError(keys.exceptions + "/" + error.what());
    }
  }
}

}  // namespace tccm
