#pragma once

#include <string>

#include "tools/program.h"

namespace tccm {

/// Records for a while all scans, clouds, joint states and transforms that anybody publishes.
/// @pre ros::init() was called. @throws InputError where there is no ROS master, or Ctrl-C came.
void recordRobot(double seconds, const std::string& bag, const Progress& progress);

}  // namespace tccm
