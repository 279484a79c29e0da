#pragma once

#include "monitor_config.h"

namespace tccm::test {

/// Of a trial whose monitor takes the floor for nothing, as the simulated robot's shipped
/// configuration has it.
template <typename Trial>
[[nodiscard]] typename Trial::Config trialConfig() {
  typename Trial::Config config;
  config.monitor.sensors.front().mapper.map.grid.height_min_m = 0.1;
  return config;
}

/// The same, with the arms watched for occlusion.
template <typename Trial>
[[nodiscard]] typename Trial::Config watchingTrialConfig() {
  typename Trial::Config config = trialConfig<Trial>();
  config.monitor.checker.pose.occlusion_use.links = {"*_elbow_link", "*_wrist_yaw_link",
                                                     "*_palm_link"};
  return config;
}

}  // namespace tccm::test
