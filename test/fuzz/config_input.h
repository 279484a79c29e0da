#pragma once

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <string>

#include "fuzz/promises.h"
#include "monitor_config.h"

/// What the fuzz target of configuration files and the test of its corpus do with an input: a file.
namespace tccm::test {

/// Is read as a configuration; gone afterwards.
inline MonitorConfig readConfigText(const std::string& text) {
  struct File {
    ~File() { std::filesystem::remove(path); }
    std::string path =
        std::filesystem::temp_directory_path() / ("config_" + std::to_string(getpid()) + ".yaml");
  };
  static const File file;
  std::ofstream(file.path, std::ios::binary | std::ios::trunc) << text;
  return readMonitorConfig(file.path);
}

/// By section and key, as users write it.
inline std::map<std::string, std::string> valuesOf(MonitorConfig config) {
  std::map<std::string, std::string> values;
  config.visitSections([&values](const std::string& name, auto& section, const std::string&) {
    const ParameterTable table = tableOf(section);
    for (const auto& row : table.rows()) {
      values[name + "/" + row.key] = textOf(row.member);
    }
  });
  return values;
}

/// As config/default.yaml is written; lists of small configurations are left out.
inline std::string writtenAs(MonitorConfig config) {
  std::string text;
  config.visitSections([&text](const std::string& name, auto& section, const std::string&) {
    text += name + ":\n" + tableOf(section).yaml();
  });
  return text;
}

/// What reading a configuration broke of its promises, or nothing.
inline std::string configDefect(const std::string& input) {
  return brokenPromise([&] {
    const MonitorConfig config = readConfigText(input);
    for (const SensorConfig& sensor : config.sensors()) {
      promise(!sensor.placing().fixed_frame.empty(), "a sensor has no fixed frame");
      promise(sensor.placing().fixed_frame == config.checker.fixed_frame, "fixed frames differ");
    }
    promise(config.monitor().sensors.size() == config.sensors().size(), "a sensor gets lost");
    // Lists are not written, and sensors that are named are one.
    if (!config.named_sensors.empty()) return;
    const std::string written = writtenAs(config);
    std::map<std::string, std::string> again;
    try {
      again = valuesOf(readConfigText(written));
    } catch (const ConfigError& error) {
      throw BrokenPromise(std::string("what was taken is refused as it is written: ") +
                          error.what());
    }
    for (const auto& [key, value] : valuesOf(config)) {
      promise(again.at(key) == value, key + " is read back as " + again.at(key) + ", not " + value);
    }
  });
}

}  // namespace tccm::test
