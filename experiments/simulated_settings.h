#pragma once

#include <string>

#include "monitor_config.h"

namespace tccm::simulation {

/// The settings of a monitor of the simulated robot at its table. @param config path of a YAML file
/// as config/simulation.yaml; empty: the defaults, and what the robot and the floor ask for.
/// @throws ConfigError
[[nodiscard]] MonitorConfig simulatedSettings(const std::string& config);

}  // namespace tccm::simulation
