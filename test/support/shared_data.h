#pragma once

#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace tccm::test {

/// Where recordings lie that the project does not ship: the environment variable TCCM_SHARED_DATA,
/// else what was configured at build time; empty where neither is known.
inline std::string sharedDataFolder() {
  if (const char* folder = std::getenv("TCCM_SHARED_DATA")) return folder;
#ifdef TCCM_SHARED_DATA_DIR
  return TCCM_SHARED_DATA_DIR;
#else
  return {};
#endif
}

/// A sweep of a really tilting laser over a cluttered table.
struct RecordedSweep {
  double angle_min;                        ///< [rad]
  double angle_increment;                  ///< [rad]
  std::vector<double> tilts;               ///< downwards [rad], one a scan
  std::vector<std::vector<float>> ranges;  ///< [m], 1000 where nothing returned
};

inline const char* const kRecordedSweepFile = "scans/hrl_tilting_hokuyo_tabletop/sweep0.json";

/// Nothing where the recording is absent.
inline std::optional<RecordedSweep> recordedSweep() {
  std::ifstream file(sharedDataFolder() + "/" + kRecordedSweepFile);
  if (!file) return std::nullopt;
  const nlohmann::json json = nlohmann::json::parse(file);
  return RecordedSweep{json.at("angle_min"), json.at("angle_increment"), json.at("tilt_rad"),
                       json.at("ranges")};
}

}  // namespace tccm::test
