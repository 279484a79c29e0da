#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "geometry/shape.h"

namespace tccm {

/// Which of the monitored links one use of the body takes (self filter, collision, occlusion), and
/// how their primitives grow for it. Links are named as LinkSelector takes them.
struct LinkUse {
  /// For some links another growth than for the rest.
  struct Exception {
    std::vector<std::string> links;
    std::optional<double> scale;
    std::optional<double> padding_m;
  };

  std::vector<std::string> links;    ///< empty: all
  std::vector<std::string> ignored;  ///< taken out again
  Expansion expansion;
  std::vector<Exception> exceptions;  ///< of several for one link the last counts
  /// Grasped objects are taken whichever links are; otherwise as their link is.
  bool all_objects = true;

  LinkUse() = default;
  explicit LinkUse(const Expansion& all) : expansion(all) {}

  /// Names of the parameters, for messages.
  struct Keys {
    std::string links, ignored, scale, padding, exceptions;
  };
  /// @throws ConfigError
  void validate(const Keys& keys) const;
};

inline const LinkUse::Keys kSelfFilterKeys{"self_filter_links", "self_filter_ignored_links",
                                           "self_filter_scale", "self_filter_padding_m",
                                           "self_filter_exceptions"};
inline const LinkUse::Keys kCollisionKeys{"collision_links", "collision_ignored_links",
                                          "primitive_scale", "collision_padding_m",
                                          "collision_exceptions"};
inline const LinkUse::Keys kOcclusionKeys{"occlusion_links", "occlusion_ignored_links",
                                          "occlusion_scale", "occlusion_padding_m",
                                          "occlusion_exceptions"};

/// The model's shapes that a use takes, with the growth of each.
struct UsedShapes {
  std::vector<std::size_t> shapes;  ///< indices into RobotModel::shapes()
  std::vector<Expansion> expansions;
};

}  // namespace tccm
