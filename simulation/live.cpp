#include "simulation/live.h"

#include "tccm_monitor/config_error.h"

namespace tccm::simulation {

std::uint64_t seedOf(const ros::NodeHandle& node) {
  const int seed = node.param("seed", 1);
  requireInRange("seed", seed, 0.0, 2147483647.0);
  return static_cast<std::uint64_t>(seed);
}

Pinhole pinholeOf(const ros::NodeHandle& node, int width) {
  node.param("camera_width", width, width);
  requireInRange("camera_width", width, 64.0, 1280.0);
  return Pinhole::ofWidth(static_cast<std::size_t>(width));
}

Time wallNow() { return Time(Duration(static_cast<Duration::rep>(ros::WallTime::now().toNSec()))); }

}  // namespace tccm::simulation
