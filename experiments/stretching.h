#pragma once

#include <cstdint>
#include <memory>

#include "simulation/arm_path.h"
#include "simulation/world.h"

namespace tccm::simulation {

constexpr char kStretching[] = "stretch";

struct StretchConfig {
  std::uint64_t seed = 1;
  double speed_mps = 0.25;    ///< of the palm: what the arm may run ahead by in horizon_s
  double clearance_m = 0.08;  ///< between the arm and the scene, the floor apart
  double horizon_s = 0.5;     ///< the arm keeps clear also where it would be so much later
};

/// The right hand stretches straight ahead or slantwise over what is before the robot, from a
/// random place to another, as low as its clearance and its reach allow. The same for the same
/// seed.
/// @param world its objects where they finally are.
/// @throws ConfigError where no such path is found.
[[nodiscard]] ArmPath stretchOver(const std::shared_ptr<const RobotModel>& model,
                                  const World& world, const StretchConfig& config);

}  // namespace tccm::simulation
