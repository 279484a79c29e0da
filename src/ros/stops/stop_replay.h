#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "tccm_monitor/time.h"
#include "tccm_monitor/verdict.h"

namespace tccm {

/// What a stop's bag says of the stop, and what a checker finds that is told the same.
struct StopReplay {
  struct Found {
    Time stamp;
    Level level = Level::kOk;
    std::string reason, link, detail;
    bool stop = false;

    /// But for the detail, which is for people.
    [[nodiscard]] bool operator==(const Found& other) const {
      return stamp == other.stamp && level == other.level && reason == other.reason &&
             link == other.link && stop == other.stop;
    }
  };
  Found recorded, replayed;
  std::size_t checks = 0;
  std::size_t same = 0;  ///< of them in which both found the same; at the beginning few do
  double seconds = 0.0;  ///< that the bag spans
};

/// @throws InputError-like std::runtime_error where the file is none of a stop, or is damaged.
[[nodiscard]] StopReplay replayStop(const std::string& path);

}  // namespace tccm
