#include "experiments/simulated_settings.h"

#include "simulation/robot/dual_arm.h"

namespace tccm::simulation {

MonitorConfig simulatedSettings(const std::string& config) {
  MonitorConfig settings = readMonitorConfig(config);
  if (!config.empty()) return settings;
  settings.robot.capsule_links = dualArmCapsuleLinks();
  settings.mapper.mapper.map.grid.height_min_m = 0.1;
  settings.checker.checker.pose.occlusion_use.links = {"*_elbow_link", "*_wrist_yaw_link",
                                                       "*_palm_link"};
  return settings;
}

}  // namespace tccm::simulation
