#pragma once

#include <vector>

#include "tccm_monitor/pose.h"
#include "tccm_monitor/time.h"

namespace tccm::simulation {

/// A robot's joints and links at one instant.
struct RobotSample {
  Time stamp;
  std::vector<double> positions;   ///< of the model's variables [rad or m]
  std::vector<double> velocities;  ///< per second
  std::vector<Pose> link_poses;    ///< T_fixed_link, of the model's links
};

}  // namespace tccm::simulation
