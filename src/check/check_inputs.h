#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "check/model_agreement.h"
#include "check/sensor_input.h"
#include "check/sensor_maps.h"
#include "check/surroundings.h"
#include "config/parameter_table.h"
#include "robot/joint_states.h"
#include "tccm_monitor/cuboid_map.h"
#include "tccm_monitor/verdict.h"

namespace tccm {

/// The newest of all that a check rests on, and what of it is missing, late or unknown.
class CheckInputs {
 public:
  struct Config : SensorInput::Limits {
    std::string fixed_frame = "?";             ///< for what is told to people
    std::vector<SensorInput::Config> sensors;  ///< none: one without a name
    JointStates::Config joints;
    ModelAgreement::Config agreement;
    double joint_timeout_s = 0.1;
    double transform_timeout_s = 0.5;
    double transform_future_max_s = 0.5;

    void describe(ParameterTable& table);
    /// @throws ConfigError
    void validate() const;
  };

  /// @throws ConfigError
  CheckInputs(std::shared_ptr<const RobotModel> model, const Config& config);
  /// Other limits from now on; how joint states are gathered stays. @throws ConfigError
  void reconfigure(const Config& config);

  // As Checker takes them.

  JointStates::Added addJoints(Time now, Time stamp, const std::vector<std::string>& names,
                               const std::vector<double>& positions,
                               const std::vector<double>& velocities,
                               const std::string& publisher = {});
  void setRootPose(std::size_t root, Time stamp, const Pose& T_fixed_root, bool is_static);
  void addScanReport(Time now, const ScanReport& report, std::size_t sensor = 0);
  void setMap(Time now, std::shared_ptr<const CuboidMap> map, std::size_t sensor = 0);
  void setOutsideCause(const Cause& cause) { outside_ = cause; }

  /// Whether the clock that gives `now` stands still, as a player's or simulation's may.
  void setClockStalls(bool stalls) { clock_stalls_ = stalls; }
  [[nodiscard]] bool clockStalls() const { return clock_stalls_; }
  /// As at the start; what the caller says of itself and of the clock stays.
  void reset();

  /// Appends what is missing, late or unknown; nothing where all is there.
  void appendCauses(Time now, std::vector<Cause>& causes);
  /// Of several sensors, puts their maps together: for the check that follows.
  void unite(Time now);
  /// The worst of them; kClear where there is none.
  [[nodiscard]] Cause worst(Time now);
  /// Whether the robot can be placed: joints and roots are known and fresh.
  [[nodiscard]] bool placesRobot(Time now);

  /// The result is valid until the next call; nothing while a joint is missing.
  [[nodiscard]] const JointSnapshot* joints() { return joints_.latest(); }
  [[nodiscard]] const JointStates& jointStates() const { return joints_; }
  [[nodiscard]] ModelAgreement& agreement() { return agreement_; }
  [[nodiscard]] const ModelAgreement& agreement() const { return agreement_; }
  [[nodiscard]] const std::vector<Pose>& rootPoses() const { return T_fixed_roots_; }
  [[nodiscard]] bool rootsKnown() const;
  /// Whether a root moves against the fixed frame, as a mobile base does.
  [[nodiscard]] bool rootsMove() const;
  /// Of all sensors, as the last unite() found them; nothing where none has one.
  [[nodiscard]] const CuboidMap* map() const { return maps_.all(); }
  /// @param keep_out regions, or null. @pre there is a map
  [[nodiscard]] Surroundings around(const KeepOut* keep_out) const {
    return {*maps_.all(), maps_.each(), keep_out};
  }
  [[nodiscard]] const std::vector<SensorInput>& sensors() const { return sensors_; }
  /// What is wrong with a sensor that can be done without; empty where nothing is.
  [[nodiscard]] const std::string& outText(std::size_t sensor) const { return outs_[sensor]; }
  /// Messages dropped because they were stamped in the future.
  [[nodiscard]] std::size_t futureJoints() const { return future_joints_; }

 private:
  struct RootPose {
    Time stamp;
    bool is_static;
  };
  /// What of it keeps the robot from being placed.
  void appendRobotCauses(Time now, std::vector<Cause>& causes);
  [[nodiscard]] Cause jointsCause(Time now);
  [[nodiscard]] std::string silentJointText(Time now, const JointSnapshot& joints) const;
  [[nodiscard]] Cause rootCause(Time now, std::size_t root) const;
  void appendSensorCauses(Time now, std::vector<Cause>& causes);
  /// Whether its map covers what those of the others do.
  [[nodiscard]] bool fits(std::size_t sensor) const;
  [[nodiscard]] bool within(Time now, double seconds) const;

  std::shared_ptr<const RobotModel> model_;
  Config config_;
  JointStates joints_;
  ModelAgreement agreement_;
  std::vector<std::optional<RootPose>> roots_;  ///< by the model's roots
  std::vector<Pose> T_fixed_roots_;
  std::vector<SensorInput> sensors_;
  std::vector<std::string> outs_;            ///< by sensor
  std::vector<SensorMaps::Source> sources_;  ///< by sensor
  SensorMaps maps_;
  bool maps_changed_ = false;
  std::vector<Cause> sensor_causes_;  ///< of one, reused
  std::optional<Time> started_;       ///< the first check
  std::size_t future_joints_ = 0;
  std::optional<Time> future_joint_;  ///< when the last of them came
  Duration future_lead_{0};
  bool clock_stalls_ = false;
  Cause outside_;
};

}  // namespace tccm
