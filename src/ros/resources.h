#pragma once

#include <string>

#include "tccm_monitor/robot_model.h"

namespace tccm {

/// Reads what URDFs refer to: package://P/x from package_path/P where that folder is there, else
/// from the ROS package P; file:///x and plain absolute paths as they are. Percent-encoded
/// characters are understood. A network is never asked, and x stays inside its package. Needs no
/// roscore; safe to call from several threads.
/// @param package_path a folder of packages, or empty.
[[nodiscard]] ReadResource resourceReader(const std::string& package_path);

/// Where fits of meshes are remembered: in $ROS_HOME, else in ~/.ros; empty where neither is known.
[[nodiscard]] std::string fitCacheFolder();

}  // namespace tccm
