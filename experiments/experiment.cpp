#include "experiments/experiment.h"

#include "experiments/simulated_settings.h"

namespace tccm::simulation {

std::uint64_t seedOf(const TrialOptions& options, std::size_t trial) {
  return 1000003 * options.seed + trial;
}

MonitorConfig trialSettings(const TrialOptions& options) {
  MonitorConfig settings = simulatedSettings(options.config);
  settings.checker.checker.clearance_radius_m = 0.0;
  return settings;
}

}  // namespace tccm::simulation
