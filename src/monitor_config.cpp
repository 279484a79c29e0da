#include "monitor_config.h"

#include <yaml-cpp/yaml.h>

#include "base/printable.h"
#include "config/yaml_file.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

constexpr Range kMarkerRates{0.1, 100.0};  // [Hz]

void requireFrame(const std::string& frame) {
  if (frame.find_first_not_of('/') == std::string::npos) {
    throw ConfigError("fixed_frame: '" + frame + "' is no frame's name");
  }
}

}  // namespace

void PlacingConfig::describe(ParameterTable& table) {
  table.add("fixed_frame", &fixed_frame, "frame of the map, z up");
  table.add("transform_gap_max_s", &transform_gap_max_s, "s", {0.001, 10.0},
            "transforms are not interpolated across a longer gap");
  table.add("transform_sample_s", &transform_sample_s, "s", {1e-4, 1.0},
            "how often the sensor's pose is looked up within a scan or cloud");
  table.add("transform_wait_max_s", &transform_wait_max_s, "s", {0.001, 10.0},
            "what waits longer for transforms or joint states is dropped");
  table.add("marker_rate_hz", &marker_rate_hz, "Hz", kMarkerRates, "of `self_filter_markers`");
}

void PlacingConfig::validate() const { requireFrame(fixed_frame); }

void AssemblerConfig::describe(ParameterTable& table) {
  PlacingConfig::describe(table);
  scan.describe(table);
}

void AssemblerConfig::validate() const {
  PlacingConfig::validate();
  scan.validate();
}

void CloudAssemblerConfig::describe(ParameterTable& table) {
  PlacingConfig::describe(table);
  cloud.describe(table);
}

void CloudAssemblerConfig::validate() const {
  PlacingConfig::validate();
  cloud.validate();
}

void MapperConfig::describe(ParameterTable& table) {
  mapper.describe(table);
  table.add("marker_rate_hz", &marker_rate_hz, "Hz", kMarkerRates, "of `cuboid_markers`");
  table.add("static_windows", &static_windows, "windows", {1, 1000},
            "cuboids with this `dyn` or more are shown as static");
}

void StopsConfig::describe(ParameterTable& table) {
  table.add("stops_folder", &folder,
            "where the last seconds before each stop are written as a bag, for `evaluate --stop`; "
            "empty: none is, and nothing is kept");
  table.add("stops_max", &bags_max, "bags", {1.0, 1e6},
            "so many are kept there; the oldest is deleted");
  table.add("stops_memory_mb", &memory_mb, "MB", {8.0, 4096.0},
            "for what is kept until a stop; a bag has at most half as much");
}

void CheckerConfig::describe(ParameterTable& table) {
  table.add("fixed_frame", &fixed_frame, "as in `tilt_scan_assembler`");
  checker.describe(table);
  table.add("attach_forget_padding_m", &attach_forget_padding_m, "m", {0.0, 1.0},
            "what was seen this near to an object that is being attached was the object; less than "
            "`collision_padding_m` and a cell's diagonal leaves it touching itself");
  table.add("attach_forget_s", &attach_forget_s, "s", {0.0, 10.0},
            "also in scans up to so long after");
  table.add("publish_rate_hz", &publish_rate_hz, "Hz", {1.0, 1000.0},
            "of permission, flags and status, whatever comes in");
  table.add("permission_valid_periods", &permission_valid_periods, "periods", {1.0, 3.0},
            "for so long after it was given a permission is valid");
  table.add("check_time_max_periods", &check_time_max_periods, "periods", {1e-6, 100.0},
            "a check that takes longer is a fault", Tunable::kYes);
  table.add("tuning_padding_min_m", &tuning_padding_min_m, "m", {0.0, 1.0},
            "`collision_padding_m` cannot be tuned below it at run time");
  table.add("tuning_stop_time_min_s", &tuning_stop_time_min_s, "s", {0.0, 10.0},
            "nor `stop_time_s` below this");
  table.add("marker_rate_hz", &marker_rate_hz, "Hz", kMarkerRates, "of `robot_markers`");
  table.add("export_rate_hz", &export_rate_hz, "Hz", {0.1, 100.0}, "of `occupied_points`");
  stops.describe(table);
}

void CheckerConfig::validate() const {
  requireFrame(fixed_frame);
  checker.validate();
}

void TopicConfig::describe(ParameterTable& table) {
  table.add("scan", &scan, "sensor_msgs/LaserScan");
  table.add("joint_states", &joint_states, "sensor_msgs/JointState");
}

void SensorConfig::describe(ParameterTable& table) {
  table.add("topic", &topic,
            "of its scans (sensor_msgs/LaserScan), or clouds (sensor_msgs/PointCloud2)");
}

void requireOneAssembler(const std::string& sensor, bool has_scans, bool has_clouds) {
  if (!has_scans || !has_clouds) return;
  throw ConfigError(sensor +
                    ": it has tilt_scan_assembler and cloud_assembler; keep the one for what it "
                    "publishes, scans or clouds");
}

std::vector<SensorConfig> MonitorConfig::sensors() const {
  if (!named_sensors.empty()) return named_sensors;
  return {{"", topics.scan, assembler, std::nullopt, mapper}};
}

Monitor::Config MonitorConfig::monitor() const {
  Monitor::Config config;
  config.sensors.clear();
  for (const SensorConfig& sensor : sensors()) {
    Monitor::Config::Sensor& stages = config.sensors.emplace_back();
    stages.scan = sensor.assembler.scan;
    if (sensor.cloud_assembler) stages.cloud = sensor.cloud_assembler->cloud;
    stages.mapper = sensor.mapper.mapper;
  }
  config.checker = checker.checker;
  return config;
}

namespace {

/// @throws ConfigError where nothing reads one of the keys.
template <typename Config>
void loadAll(const YAML::Node& node, const std::string& owner, Config& config) {
  const ParameterTable::Names unknown = load(node, owner, config);
  if (unknown.empty()) return;
  std::string line;
  for (const auto& entry : node) {
    if (entry.first.as<std::string>() == unknown.front()) line = lineText(entry.first);
  }
  throw ConfigError(printable(line + owner + "/" + unknown.front(), kLineMax) +
                    ": there is no such parameter");
}

/// Takes one of a sensor's sections out of it.
template <typename Config>
void takeSection(YAML::Node& sensor, const std::string& owner, const std::string& name,
                 Config& config) {
  loadAll(sensor[name], owner + "/" + name, config);
  sensor.remove(name);
}

/// A named sensor's section.
SensorConfig readSensor(YAML::Node section, const std::string& name) {
  if (!section || !section.IsMap()) {
    throw ConfigError("sensors: '" + name + "' has no section of its own");
  }
  SensorConfig sensor;
  sensor.name = name;
  const bool has_clouds(section[SensorConfig::kCloudAssembler]);
  requireOneAssembler(name, bool(section[SensorConfig::kScanAssembler]), has_clouds);
  if (has_clouds) {
    takeSection(section, name, SensorConfig::kCloudAssembler, sensor.cloud_assembler.emplace());
  } else {
    takeSection(section, name, SensorConfig::kScanAssembler, sensor.assembler);
  }
  takeSection(section, name, SensorConfig::kMapper, sensor.mapper);
  loadAll(section, name, sensor);
  if (sensor.topic.empty()) throw ConfigError(name + "/topic: it is not set");
  const Mapper::Config& mapper = sensor.mapper.mapper;
  if (sensor.cloud_assembler && mapper.window_s == 0.0 && mapper.window_scans == 0) {
    throw ConfigError(name +
                      "/tccm_mapper/window_s: it is 0, but a cloud has no tilt to measure a "
                      "window by; set it to three frames or turns, such as 0.3");
  }
  return sensor;
}

bool isOfASensor(const std::string& section) {
  return section == SensorConfig::kScanAssembler || section == SensorConfig::kCloudAssembler ||
         section == SensorConfig::kMapper;
}

/// @throws ConfigError where one names another than the checker.
void requireOneFrame(const MonitorConfig& config) {
  for (const SensorConfig& sensor : config.sensors()) {
    if (sensor.placing().fixed_frame == config.checker.fixed_frame) continue;
    const std::string owner = sensor.name.empty() ? "" : sensor.name + "/";
    throw ConfigError("fixed_frame: " + owner + sensor.assemblerName() +
                      " and collision_checker name different ones");
  }
}

/// @param section a key at the top of a file. @throws ConfigError where nothing reads it.
void requireKnown(const YAML::Node& section, const ParameterTable::Names& known,
                  bool sensors_are_named) {
  const auto name = section.as<std::string>();
  if (sensors_are_named && isOfASensor(name)) {
    throw ConfigError(lineText(section) + "with `sensors` each has '" + name +
                      "' in its own section");
  }
  if (std::find(known.begin(), known.end(), name) != known.end()) return;
  throw ConfigError(lineText(section) + "'" + name +
                    "' names no nodelet and no sensor, nor is it monitored_robot or topics");
}

/// @param path for errors.
MonitorConfig configFrom(const YAML::Node& file, const std::string& path) {
  MonitorConfig config;
  if (file && !file.IsNull() && !file.IsMap()) {
    throw ConfigError(path + ": its parameters are no map of keys and values");
  }
  ParameterTable::Names sections;
  config.visitSections([&](const std::string& name, auto& section, const std::string&) {
    sections.push_back(name);
    loadAll(file.IsMap() ? file[name] : YAML::Node(), name, section);
  });
  for (const SensorInput::Config& sensor : config.checker.checker.inputs.sensors) {
    if (std::find(sections.begin(), sections.end(), sensor.name) != sections.end()) {
      throw ConfigError("sensors: '" + sensor.name + "' cannot be a sensor's name");
    }
    config.named_sensors.push_back(readSensor(file[sensor.name], sensor.name));
    sections.push_back(sensor.name);
  }
  for (const auto& entry : file) requireKnown(entry.first, sections, !config.named_sensors.empty());
  if (config.named_sensors.empty() && !differencesFromDefaults(config.cloud_assembler).empty()) {
    throw ConfigError(path +
                      ": cloud_assembler: it is no sensor's; name the camera or lidar in "
                      "collision_checker/sensors, and give it a section of that name");
  }
  requireOneFrame(config);
  double& stop_duration_s = config.checker.checker.braking.stop_duration_s;
  stop_duration_s = std::max(stop_duration_s, config.gate.stopDurationMax());
  config.checker.checker.inputs.fixed_frame = config.checker.fixed_frame;
  return config;
}

}  // namespace

MonitorConfig readMonitorConfig(const std::string& path) {
  const YAML::Node file = path.empty() ? YAML::Node() : loadYamlFile(path);
  try {
    return configFrom(file, path);
  } catch (const ConfigError& error) {
    const std::string what = printable(error.what(), kLineMax);  // names may hold anything
    throw ConfigError(what.rfind("line ", 0) == 0 ? path + ": " + what : what);
  }
}

}  // namespace tccm
