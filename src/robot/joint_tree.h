#pragma once

#include <urdf_model/model.h>

#include <map>
#include <string>
#include <vector>

#include "robot/robot_model.h"

namespace tccm {

/// Whether joint states say where the joint's child is; not so for floating and planar joints.
[[nodiscard]] bool isPlacedByJointStates(const urdf::Joint& joint);

/// The links that are monitored, and those on the way to them from the next link that transforms
/// place.
struct JointTree {
  std::vector<std::string> links;  ///< parents first
  std::vector<std::size_t> roots;
  std::vector<RobotJoint> joints;  ///< in the order of their child links
  std::vector<JointVariable> variables;
};

/// @param monitored the links to be placed. @param fixed_joints positions of joints that are not
/// heard of. @throws ConfigError naming the joint.
[[nodiscard]] JointTree buildJointTree(const urdf::ModelInterface& urdf,
                                       const std::vector<std::string>& monitored,
                                       const std::map<std::string, double>& fixed_joints);

}  // namespace tccm
