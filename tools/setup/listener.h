#pragma once

#include <string>
#include <vector>

#include "tools/program.h"

namespace tccm {

/// Records for a while all scans, clouds, joint states and transforms that anybody publishes.
/// @pre ros::init() was called. @throws InputError where there is no ROS master, or Ctrl-C came.
void recordRobot(double seconds, const std::string& bag, const Progress& progress);

/// A controller that has the action follow_joint_trajectory.
struct ArmController {
  std::string name;  ///< its namespace
  double stop_duration_s = 0.0;
};

/// Those that run now and whose joints the parameter server has.
[[nodiscard]] std::vector<ArmController> runningControllers();

}  // namespace tccm
