#pragma once

#include <urdf_model/model.h>
#include <urdf_world/types.h>

#include <map>
#include <set>
#include <string>
#include <vector>

#include "tccm_monitor/robot_model.h"

namespace tccm {

/// The URDF as urdfdom reads it, and certainly a tree: one root, from which every link is reached
/// over one joint each.
struct ReadUrdf {
  urdf::ModelInterfaceSharedPtr model;
  /// By link why not all of its visual elements are in the model.
  std::map<std::string, std::string> visual_defects;
};

/// @throws ConfigError naming the element, in one line.
[[nodiscard]] ReadUrdf readUrdf(const std::string& text);

/// From the root on, parents first, children by name. @param urdf from readUrdf().
[[nodiscard]] std::vector<urdf::LinkConstSharedPtr> linksInOrder(const urdf::ModelInterface& urdf);

/// @throws ConfigError naming owner where it is not finite.
[[nodiscard]] Pose toPose(const urdf::Pose& pose, const std::string& owner);

/// What is known of a robot's joints beside its URDF.
struct JointFacts {
  std::map<std::string, double> fixed_joints;  ///< positions of joints that are not heard of
  std::set<std::string> trusted;               ///< links that transforms place better than the URDF
};

/// A trusted link that no joint moves is a root. @param monitored the links to be placed.
/// @throws ConfigError naming the joint.
[[nodiscard]] JointTree buildJointTree(const urdf::ModelInterface& urdf,
                                       const std::vector<std::string>& monitored,
                                       const JointFacts& facts);

/// All links, to compare them with transforms: every trusted link is a root. Links below a joint
/// that makes no sense are left out.
[[nodiscard]] JointTree buildFrameTree(const urdf::ModelInterface& urdf, const JointFacts& facts);

}  // namespace tccm
