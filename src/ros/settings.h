#pragma once

#include <string>

#include "monitor.h"
#include "ros/parameters.h"

namespace tccm {

/// All that a nodelet is configured with: the core's configurations and what only the adapter
/// needs. The defaults are the parameters' defaults; README.md lists them with their units.
struct AssemblerSettings {
  std::string fixed_frame = "base_link";
  bool self_filter = true;  ///< false: no robot is filtered out, and none is needed
  ScanAssembler::Config assembler;
  BodySampler::Config body;
  double transform_gap_max_s = 0.1;
  double transform_sample_s = 0.004;  ///< the sensor's pose is looked up this often in a scan
  double transform_wait_max_s = 0.5;  ///< a scan that waits longer is dropped
  double future_max_s = 0.1;  ///< a scan or joint state whose stamp leads by more is dropped
  double marker_rate_hz = 10.0;
};

struct MapperSettings {
  Mapper::Config mapper;
  double marker_rate_hz = 5.0;
  int static_windows = 3;  ///< cuboids from this dyn on are shown as static
};

struct CheckerSettings {
  std::string fixed_frame = "base_link";
  Checker::Config checker;
  double publish_rate_hz = 50.0;  ///< of permission, flags and status, also where nothing comes in
  double permission_valid_periods = 2.5;  ///< for so many publishing periods a permission is valid
  double check_time_max_periods = 2.0;    ///< a check that takes longer is a fault
  /// While the checker runs, these cannot be tuned to less.
  double tuning_padding_min_m = 0.01;
  double tuning_stop_time_min_s = 0.1;
  double marker_rate_hz = 10.0;
  /// What was seen this near to an object that is being attached was the object.
  double attach_forget_padding_m = 0.08;
  double attach_forget_s = 0.2;  ///< also in scans that are on their way
};

/// Name of the section, and of the namespace, with what all nodelets have to know of the robot.
inline constexpr const char* kRobotSection = "monitored_robot";

/// Each reads its keys and validates. @throws ConfigError naming the key.
[[nodiscard]] RobotModel::Config readRobotSettings(Parameters& parameters);
[[nodiscard]] AssemblerSettings readAssemblerSettings(Parameters& parameters);
[[nodiscard]] MapperSettings readMapperSettings(Parameters& parameters);
[[nodiscard]] CheckerSettings readCheckerSettings(Parameters& parameters);

/// A whole YAML file as the offline programs take it: the nodelets' parameters under their names
/// (tilt_scan_assembler, tccm_mapper, collision_checker), `monitored_robot` and `topics`.
struct MonitorSettings {
  RobotModel::Config robot;
  AssemblerSettings assembler;
  MapperSettings mapper;
  CheckerSettings checker;
  std::string scan_topic = "/scan";
  std::string joint_states_topic = "/joint_states";

  [[nodiscard]] Monitor::Config monitorConfig() const;
};
/// @throws ConfigError, also for a key that nothing reads. @param path empty: all defaults.
[[nodiscard]] MonitorSettings readMonitorSettings(const std::string& path);

}  // namespace tccm
