#pragma once

#include <urdf_model/model.h>

#include <map>
#include <string>
#include <vector>

#include "tccm_monitor/robot_model.h"

namespace tccm {

/// @param monitored the links to be placed. @param fixed_joints positions of joints that are not
/// heard of. @throws ConfigError naming the joint.
[[nodiscard]] JointTree buildJointTree(const urdf::ModelInterface& urdf,
                                       const std::vector<std::string>& monitored,
                                       const std::map<std::string, double>& fixed_joints);

}  // namespace tccm
