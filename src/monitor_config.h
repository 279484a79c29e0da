#pragma once

#include <optional>
#include <string>
#include <vector>

#include "check/checker_config.h"
#include "gate/gate_config.h"
#include "map/mapper.h"
#include "scan/cloud_stage.h"
#include "scan/scan_stage.h"
#include "tccm_monitor/monitor.h"

namespace tccm {

struct Monitor::Config {
  /// The stages of one sensor.
  struct Sensor {
    ScanStage::Config scan;
    std::optional<CloudStage::Config> cloud{};  ///< of a camera or lidar, which `scan` is not of
    Mapper::Config mapper;
  };
  std::vector<Sensor> sensors{Sensor()};  ///< in the order of the checker's; one at least
  Checker::Config checker;
};

// What each nodelet is configured with, and what all have to know of the robot: a section of a YAML
// file, or a private namespace of the parameter server.

/// Where and when an assembler asks for the sensor's pose.
struct PlacingConfig {
  std::string fixed_frame = "base_link";
  double transform_gap_max_s = 0.1;
  double transform_sample_s = 0.004;
  double transform_wait_max_s = 0.5;
  double marker_rate_hz = 10.0;

  void describe(ParameterTable& table);
  /// @throws ConfigError
  void validate() const;
};

struct AssemblerConfig : PlacingConfig {
  ScanStage::Config scan;

  void describe(ParameterTable& table);
  /// @throws ConfigError
  void validate() const;
};

struct CloudAssemblerConfig : PlacingConfig {
  CloudStage::Config cloud;

  void describe(ParameterTable& table);
  /// @throws ConfigError
  void validate() const;
};

struct MapperConfig {
  Mapper::Config mapper;
  double marker_rate_hz = 5.0;
  int static_windows = 3;

  void describe(ParameterTable& table);
  /// @throws ConfigError
  void validate() const { mapper.validate(); }
};

/// What is kept of stops.
struct StopsConfig {
  std::string folder;
  int bags_max = 20;
  double memory_mb = 64.0;

  void describe(ParameterTable& table);
};

struct CheckerConfig {
  std::string fixed_frame = "base_link";
  Checker::Config checker;
  double publish_rate_hz = 50.0;
  double permission_valid_periods = 2.5;
  double check_time_max_periods = 2.0;
  double tuning_padding_min_m = 0.01;
  double tuning_stop_time_min_s = 0.1;
  double marker_rate_hz = 10.0;
  double export_rate_hz = 5.0;
  double attach_forget_padding_m = 0.08;
  double attach_forget_s = 0.2;
  StopsConfig stops;

  void describe(ParameterTable& table);
  /// @throws ConfigError
  void validate() const;
};

/// Where the offline programs find messages in a bag; nodelets are remapped instead.
struct TopicConfig {
  std::string scan = "/scan";
  std::string joint_states = "/joint_states";

  void describe(ParameterTable& table);
};

/// What belongs to one sensor: a section of the file that has its name, and a namespace.
struct SensorConfig {
  std::string name;   ///< empty: it is the only one, and its sections stand at the top
  std::string topic;  ///< of its scans or clouds
  AssemblerConfig assembler;
  std::optional<CloudAssemblerConfig> cloud_assembler{};  ///< in place of it: a camera or lidar
  MapperConfig mapper;

  static constexpr const char* kScanAssembler = "tilt_scan_assembler";
  static constexpr const char* kCloudAssembler = "cloud_assembler";
  static constexpr const char* kMapper = "tccm_mapper";

  /// Of the assembler that it has.
  [[nodiscard]] const PlacingConfig& placing() const {
    if (cloud_assembler) return *cloud_assembler;
    return assembler;
  }
  [[nodiscard]] const char* assemblerName() const {
    return cloud_assembler ? kCloudAssembler : kScanAssembler;
  }
  void describe(ParameterTable& table);
};

/// All of it.
struct MonitorConfig {
  RobotModel::Config robot;
  AssemblerConfig assembler;
  CloudAssemblerConfig cloud_assembler;
  MapperConfig mapper;
  CheckerConfig checker;
  GateConfig gate;
  TopicConfig topics;

  std::vector<SensorConfig> named_sensors;  ///< none: there is one, `assembler` and `mapper`

  /// One at least.
  [[nodiscard]] std::vector<SensorConfig> sensors() const;
  /// What the core takes of it.
  [[nodiscard]] Monitor::Config monitor() const;
  /// Calls visit(name, config, meaning) for each section.
  template <typename Visit>
  void visitSections(Visit&& visit) {
    visit("topics", topics,
          "where the offline programs find these in a bag; nodelets are remapped instead");
    visit(kRobotSection, robot, "what all nodelets have to know of the robot");
    visit(SensorConfig::kScanAssembler, assembler,
          "private parameters of the nodelet TiltScanAssembler");
    visit(SensorConfig::kCloudAssembler, cloud_assembler,
          "private parameters of the nodelet CloudAssembler");
    visit(SensorConfig::kMapper, mapper, "private parameters of the nodelet TccmMapper");
    visit("collision_checker", checker, "private parameters of the nodelet CollisionChecker");
    visit(kGateSection, gate, "private parameters of the nodelet TrajectoryGate");
  }
  static constexpr const char* kGateSection = "trajectory_gate";
  /// Name of the section, and of the namespace, that all nodelets share.
  static constexpr const char* kRobotSection = "monitored_robot";
};

/// @param sensor for people. @throws ConfigError where it has an assembler for scans and one for
/// clouds.
void requireOneAssembler(const std::string& sensor, bool has_scans, bool has_clouds);

/// Takes what a section or namespace sets.
/// @return the keys that nothing reads: slips, most likely. @throws ConfigError naming the key.
template <typename Config>
ParameterTable::Names load(const YAML::Node& node, const std::string& owner, Config& config) {
  ParameterTable::Names unknown = tableOf(config).load(node, owner);
  static_cast<void>(validated(config));
  return unknown;
}

/// A whole YAML file. @param path empty: all defaults.
/// @throws ConfigError, also for a key that nothing reads.
[[nodiscard]] MonitorConfig readMonitorConfig(const std::string& path);

}  // namespace tccm
