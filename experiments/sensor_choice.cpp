#include "experiments/sensor_choice.h"

#include <algorithm>

#include "tccm_monitor/config_error.h"

namespace tccm::simulation {
namespace {

/// As docs/sensors.md has it.
void setUp(SensorKind kind, const CloudSensors::Config& clouds, SensorConfig& sensor) {
  constexpr double kCameraWindow = 0.3, kLidarWindow = 0.5;  // [s]
  constexpr double kLidarBlock = 0.035;                      // [rad]
  constexpr std::size_t kCameraSupport = 4;                  // returns around what is held
  if (kind == SensorKind::kLaser) return;
  CloudStage::Config& cloud = sensor.cloud_assembler.emplace().cloud;
  Mapper::Config& mapper = sensor.mapper.mapper;
  mapper.window_s = kind == SensorKind::kCamera ? kCameraWindow : kLidarWindow;
  if (kind == SensorKind::kCamera) {
    mapper.hold.support_points = kCameraSupport;
    return;
  }
  cloud.noise = {clouds.lidar.noise_m, 0.0};
  cloud.looks.block_rad = kLidarBlock;
}

}  // namespace

bool SensorChoice::isLaserAlone() const {
  return kinds == std::vector<SensorKind>{SensorKind::kLaser};
}

std::optional<std::size_t> SensorChoice::indexOf(SensorKind kind) const {
  const auto found = std::find(kinds.begin(), kinds.end(), kind);
  if (found == kinds.end()) return std::nullopt;
  return static_cast<std::size_t>(found - kinds.begin());
}

void SensorChoice::applyTo(Simulator::Config& simulator) const {
  simulator.sensors = kinds;
  simulator.clouds = clouds;
}

void SensorChoice::applyTo(MonitorConfig& settings) const {
  std::vector<std::string> names, named;
  for (const SensorKind kind : kinds) names.push_back(name(kind));
  for (const SensorConfig& sensor : settings.named_sensors) named.push_back(sensor.name);
  if (isLaserAlone() && named.empty()) return;
  if (!named.empty()) {
    if (named == names) return;
    throw ConfigError(
        "sensors: the configuration names others than --sensors, or in another order");
  }
  for (const SensorKind kind : kinds) {
    SensorConfig sensor{name(kind), "", settings.assembler, std::nullopt, settings.mapper};
    setUp(kind, clouds, sensor);
    settings.named_sensors.push_back(sensor);
    settings.checker.checker.inputs.sensors.push_back({sensor.name, true});
  }
}

}  // namespace tccm::simulation
