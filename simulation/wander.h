#pragma once

#include <cstdint>
#include <memory>
#include <random>
#include <vector>

#include "simulation/arm_path.h"
#include "simulation/world.h"

namespace tccm::simulation {

constexpr char kWander[] = "wander";

struct WanderConfig {
  std::uint64_t seed = 1;
  double length_m = 60.0;     ///< at least so long, by the faster palm
  double speed_mps = 0.25;    ///< of the faster palm: what the arms may run ahead by in horizon_s
  double clearance_m = 0.12;  ///< between the arms and the scene, the floor apart
  double horizon_s = 0.5;     ///< the arms keep clear also where they would be so much later
};

/// Both arms of the dual-arm robot go from one random posture to the next, smoothly, over the
/// space before and beside the body. They keep clear of the scene, of each other and of the body,
/// also where a constant velocity at up to speed_mps, either way along the path, would take them.
/// @param world its objects where they finally are.
/// @throws ConfigError where no such path is found.
[[nodiscard]] ArmPath wanderPath(const std::shared_ptr<const RobotModel>& model, const World& world,
                                 const WanderConfig& config);

/// A posture of both arms as the path goes between: clear of the scene, the floor apart, of each
/// other and of the body. @throws ConfigError where none is found.
[[nodiscard]] std::vector<double> freePosture(const std::shared_ptr<const RobotModel>& model,
                                              const World& world, double clearance_m,
                                              std::mt19937_64& random);

}  // namespace tccm::simulation
