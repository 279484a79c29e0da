#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "simulation/world.h"
#include "tccm_monitor/robot/robot_model.h"

namespace tccm::simulation {

/// A pose of the robot's arms in a scene, with an obstacle that may hide some of them.
struct VisibilityScene {
  std::string scene;           ///< one of sceneNames()
  std::string obstacle;        ///< "none", "pole", "arm" or "box"
  World objects;               ///< the obstacle
  std::vector<double> joints;  ///< of the model's variables
};

/// The same for the same seed. The obstacle lies across the way from the sensor to somewhere on the
/// arms, or beside it, in the area ahead of the robot, and touches neither arms nor head.
/// @throws ConfigError where none is found.
[[nodiscard]] VisibilityScene visibilityScene(const std::shared_ptr<const RobotModel>& model,
                                              double clearance_m, std::uint64_t seed);

}  // namespace tccm::simulation
