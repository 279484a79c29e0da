#pragma once

#include <urdf_model/model.h>
#include <urdf_world/types.h>

#include <string>
#include <vector>

#include "tccm_monitor/pose.h"

namespace tccm {

/// The URDF as urdfdom reads it, and certainly a tree: one root, from which every link is reached
/// over one joint each. @throws ConfigError naming the element, in one line.
[[nodiscard]] urdf::ModelInterfaceSharedPtr readUrdf(const std::string& text);

/// From the root on, parents first, children by name. @param urdf from readUrdf().
[[nodiscard]] std::vector<urdf::LinkConstSharedPtr> linksInOrder(const urdf::ModelInterface& urdf);

/// @throws ConfigError naming owner where it is not finite.
[[nodiscard]] Pose toPose(const urdf::Pose& pose, const std::string& owner);

}  // namespace tccm
