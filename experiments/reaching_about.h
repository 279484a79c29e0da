#pragma once

#include <cstdint>
#include <memory>

#include "simulation/arm_path.h"

namespace tccm::simulation {

constexpr char kReachingAbout[] = "reach_about";

/// The right hand goes straight from one random place ahead of the robot to the next, within the
/// laser's range. The same for the same seed. @param length_m at least so long.
/// @throws ConfigError where no such path is found.
[[nodiscard]] ArmPath reachingAbout(const std::shared_ptr<const RobotModel>& model, double length_m,
                                    std::uint64_t seed);

}  // namespace tccm::simulation
