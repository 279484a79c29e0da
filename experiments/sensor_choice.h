#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "monitor_config.h"
#include "simulation/simulator.h"

namespace tccm::simulation {

/// Which sensors the simulated robot has in a trial.
struct SensorChoice {
  std::vector<SensorKind> kinds = {SensorKind::kLaser};
  CloudSensors::Config clouds;

  [[nodiscard]] bool isLaserAlone() const;
  /// Index of a sensor of that kind; nothing where there is none.
  [[nodiscard]] std::optional<std::size_t> indexOf(SensorKind kind) const;
  void applyTo(Simulator::Config& simulator) const;
  /// What the monitor needs to know of them, with the mapper of the settings' one sensor: a laser
  /// alone changes nothing. A configuration that names sensors is kept.
  /// @throws ConfigError where it names others, or in another order.
  void applyTo(MonitorConfig& settings) const;
};

}  // namespace tccm::simulation
