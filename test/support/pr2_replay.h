#pragma once

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <ostream>
#include <stdexcept>
#include <string>
#include <vector>

#include "support/dumped_map.h"
#include "support/recorded_motion.h"
#include "support/shared_data.h"
#include "support/temporary_folder.h"

// Runs the programs on the recordings of a PR2 behind a really scanned table. Which ones is said by
// the definitions TCCM_EVALUATE and TCCM_FIT_PRIMITIVES.
namespace tccm::test {

inline std::string robotFolder() { return sharedDataFolder() + "/robots/pr2_moveit"; }
inline std::string urdfPath() { return robotFolder() + "/pr2.urdf"; }
inline std::string bagPath(const std::string& name) {
  return sharedDataFolder() + "/bags/pr2_at_table/" + name + ".bag";
}

struct Settings {
  std::string bag;
  double horizon_s;
  bool self_filter;  ///< the arms were not there when the table was scanned: it only takes away
  double padding_m = 0.01;
  std::string links = "*";  ///< those checked, as a pattern
};

/// For what a failed test says of itself.
inline void PrintTo(const Settings& settings, std::ostream* out) {
  *out << settings.bag << ", links " << settings.links << ", horizon " << settings.horizon_s
       << " s, padding " << settings.padding_m << " m, self filter " << settings.self_filter;
}

/// The shipped configuration, but one point is enough, and occlusion off.
inline std::string configOf(const Settings& settings) {
  YAML::Node config = YAML::LoadFile(std::string(TCCM_SOURCE_DIR) + "/config/pr2.yaml");
  config["tilt_scan_assembler"]["self_filter"] = settings.self_filter;
  YAML::Node checker = config["collision_checker"];
  checker["collision_padding_m"] = settings.padding_m;
  checker["collision_links"].push_back(settings.links);
  checker["support_points"] = 1;
  checker["check_occlusion"] = false;
  checker["horizon_s"] = settings.horizon_s;
  return YAML::Dump(config);
}

/// @return the exit status.
inline int run(const std::vector<std::string>& arguments) {
  std::string command;
  for (const std::string& argument : arguments) command += "'" + argument + "' ";
  return std::system((command + "> /dev/null").c_str());
}

/// A row of --dump-verdicts.
struct Row {
  Nanoseconds stamp;
  std::size_t scan;
  bool collision;
  std::string reason;
  std::string link;
};

inline Row rowOf(const std::vector<std::string>& cells) {
  std::string digits = cells[0];
  digits.erase(std::find(digits.begin(), digits.end(), '.'));
  return {std::stoll(digits), std::stoul(cells[1]), cells[2] == "1", cells[5], cells[6]};
}

/// What evaluate says of a recording, with all that it takes to judge it.
struct Evaluated {
  nlohmann::json summary;
  std::vector<std::vector<std::string>> points;
  std::vector<Row> rows;
  YAML::Node primitives;
};

inline Evaluated evaluate(const Settings& settings) {
  const TemporaryFolder folder;
  const auto at = [&](const char* name) { return (folder.path() / name).string(); };
  writeFile(at("config.yaml"), configOf(settings));
  const std::vector<std::string> robot{"--urdf",         urdfPath(),
                                       "--package-path", robotFolder() + "/packages",
                                       "--config",       at("config.yaml")};
  std::vector<std::string> fit{TCCM_FIT_PRIMITIVES, "--out", at("robot.yaml"), "--no-picture"};
  std::vector<std::string> replay{TCCM_EVALUATE,    "--bag",           bagPath(settings.bag),
                                  "--out",          folder.path(),     "--dump-points",
                                  at("points.csv"), "--dump-verdicts", at("verdicts.csv")};
  fit.insert(fit.end(), robot.begin(), robot.end());
  replay.insert(replay.end(), robot.begin(), robot.end());
  if (run(fit) != 0 || run(replay) != 0) throw std::runtime_error("a program failed");
  Evaluated result;
  result.summary = nlohmann::json::parse(readFile(at("summary.json")));
  result.points = readRows(at("points.csv"));
  for (const auto& cells : readRows(at("verdicts.csv"))) result.rows.push_back(rowOf(cells));
  result.primitives = YAML::LoadFile(at("robot.yaml"))["links"];
  return result;
}

}  // namespace tccm::test
