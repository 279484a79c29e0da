#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "monitor_config.h"
#include "simulation/guardian.h"
#include "simulation/simulator.h"

namespace tccm::simulation {

/// A cloud as it came into the map.
struct MappedCloud {
  const SimulatedCloud& cloud;
  std::size_t sensor;                  ///< index into the monitor's
  std::vector<Vector3> p_fixed;        ///< where each point was placed; not finite where none was
  const std::vector<BeamKind>& kinds;  ///< what became of each; the map takes the returns
};

/// A monitor that watches the simulated robot, in simulated time: it hears of the joints at 100 Hz,
/// maps each scan or cloud as soon as the robot is known at its end, and checks after either.
class MonitoredSimulation {
 public:
  /// @param monitor with the simulator's sensors, in their order.
  /// @param model what the monitor takes the robot for. @throws ConfigError
  MonitoredSimulation(const Simulator::Config& simulator, const Monitor::Config& monitor,
                      std::shared_ptr<const RobotModel> model);

  /// Called with each scan once it is in the map, before the check of it.
  void onScan(std::function<void(const SimulatedScan&)> handle) { on_scan_ = std::move(handle); }
  /// The same of each cloud.
  void onCloud(std::function<void(const MappedCloud&)> handle) { on_cloud_ = std::move(handle); }
  /// Called with each verdict; there are none before the first map.
  void onVerdict(std::function<void(const Verdict&)> handle) { on_verdict_ = std::move(handle); }
  enum class Obedience { kStopAndScale, kStopAlone };
  /// From now on the arms do what the verdicts say: they stop, and scale their speed. Until the
  /// first verdict they stand.
  void obey(Obedience obedience = Obedience::kStopAndScale);
  /// The same of what somebody else says, who hears all that comes up; has to outlive this.
  void obey(Guardian& guardian, Obedience obedience);
  /// Called with what the arms hear, after each verdict or, where they obey a guardian, each robot
  /// sample. @param reason the gravest, also where it does not stop them.
  void onPermission(std::function<void(bool permitted, const std::string& reason)> handle) {
    on_permission_ = std::move(handle);
  }
  /// From now on the monitor takes the joints to be where they were so long before [s]: their
  /// states are stamped too late. The sensor's pose stays exact. @param late_s 0 to 0.1, to 10 ms.
  void stampJointsLate(double late_s);

  /// Moves on by 1 ms. @return whether the robot's joints were heard of.
  /// @throws std::runtime_error where the monitor drops a scan or a cloud: all that it needs is
  /// there.
  bool step();

  /// As the monitor heard of it last; nothing before it did.
  [[nodiscard]] const RobotSample* robot() const {
    return recent_.empty() ? nullptr : &recent_.back();
  }
  /// How long the monitor took over its last scan or cloud, from beams to verdict [us].
  [[nodiscard]] double processingMicroseconds() const { return processing_us_; }
  [[nodiscard]] Simulator& simulator() { return simulator_; }
  [[nodiscard]] const Simulator& simulator() const { return simulator_; }
  [[nodiscard]] Monitor& monitor() { return monitor_; }
  [[nodiscard]] const Monitor& monitor() const { return monitor_; }

 private:
  /// A sensor of the simulator, as the monitor has it.
  struct Sensor {
    SensorKind kind;
    std::size_t link;
    Pose T_link_sensor;
  };
  /// For a robot sample after its end.
  struct Waiting {
    std::size_t sensor;
    std::variant<SimulatedScan, SimulatedCloud> measured;

    [[nodiscard]] Time first() const;
    [[nodiscard]] Time last() const;
  };
  [[nodiscard]] static std::vector<Sensor> sensorsOf(const Simulator::Config& config,
                                                     const RobotModel& model);
  void wait(StepOutput& output);
  void addRobot(const RobotSample& sample);
  void mapReady();
  void map(const Waiting& waiting);
  void tellOf(const SimulatedCloud& cloud, std::size_t sensor,
              const PosePath& T_fixed_sensor) const;
  void check();
  void tell(const Guardian::Word& word);

  Simulator simulator_;
  Monitor monitor_;
  std::vector<Sensor> sensors_;
  std::vector<std::string> joints_;
  std::function<void(const SimulatedScan&)> on_scan_;
  std::function<void(const MappedCloud&)> on_cloud_;
  std::function<void(const Verdict&)> on_verdict_;
  std::optional<Obedience> obedience_;  ///< nothing: the arms do as they like
  Guardian* guardian_ = nullptr;        ///< whom they obey; nobody: this monitor
  std::function<void(bool, const std::string&)> on_permission_;
  std::size_t joints_late_ = 0;  ///< samples
  double processing_us_ = 0.0;
  std::vector<RobotSample> recent_;
  std::vector<Waiting> waiting_;
};

}  // namespace tccm::simulation
