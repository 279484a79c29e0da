#pragma once

#include <CLI/CLI.hpp>
#include <cstddef>
#include <string>
#include <vector>

#include "experiments/sensor_choice.h"

namespace tccm::simulation {

/// A SensorChoice as asked for on a command line.
struct SensorOptions {
  std::vector<std::string> sensors = {"laser"};
  std::string camera = "side";
  std::size_t camera_width = 640;
  double camera_mixed_share = DepthCamera::Config().mixed_share;

  void declare(CLI::App& app);
  /// @throws ConfigError
  [[nodiscard]] SensorChoice choice() const;
};

}  // namespace tccm::simulation
