#include "experiments/experiment.h"

#include "experiments/simulated_settings.h"
#include "simulation/robot/dual_arm.h"

namespace tccm::simulation {
namespace {

MonitorConfig trialSettings(const std::string& config, const SensorChoice& sensors) {
  MonitorConfig settings = simulatedSettings(config);
  sensors.applyTo(settings);
  settings.checker.checker.clearance_radius_m = 0.0;
  return settings;
}

}  // namespace

TrialRun::TrialRun(const TrialOptions& options, Progress progress)
    : options(options),
      progress(std::move(progress)),
      settings(trialSettings(options.config, options.sensors.choice())),
      sensors(options.sensors.choice()),
      model(std::make_shared<const RobotModel>(dualArmUrdf(), settings.robot)) {}

void TrialRun::requireLaserAlone() const {
  if (sensors.isLaserAlone()) return;
  throw InputError("--sensors: this experiment knows the laser alone");
}

std::uint64_t TrialRun::seedOf(std::size_t trial) const { return 1000003 * options.seed + trial; }

void TrialRun::forEach(std::size_t count, const std::function<void(std::size_t)>& work) const {
  inParallel(count, options.jobs, work, progress);
}

}  // namespace tccm::simulation
