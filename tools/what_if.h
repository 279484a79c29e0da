#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "evaluation.h"
#include "monitor_config.h"
#include "recording.h"

namespace tccm {

/// What one configuration makes of a recording.
struct Trial {
  std::string name;
  MonitorConfig settings;
};

/// A stop as it is compared. Seconds from the recording's first stamp.
struct ComparedStop {
  double from_s = 0.0, to_s = 0.0;
  std::string reason, link, detail;  ///< the gravest
};

/// How a stop of one run stands to those of another.
struct StopChange {
  enum class Kind { kSame, kMoved, kOther, kGone, kCome };
  Kind kind = Kind::kSame;
  std::optional<ComparedStop> before, after;
};
/// Stops belong to each other where they overlap, each to one at most: those first that overlap
/// most, of equals the earlier. Within a millisecond they are the same.
[[nodiscard]] std::vector<StopChange> compareStops(const std::vector<ComparedStop>& before,
                                                   const std::vector<ComparedStop>& after);

/// The same configuration but for one parameter, at each value from `from` to `to`.
/// @param sweep "key=from:to:step"; the key may have its section in front: "collision_checker/key".
/// @param config path; empty: all defaults. @throws InputError, ConfigError
[[nodiscard]] std::vector<Trial> sweptTrials(const std::string& config, const std::string& sweep);

/// What the trials are made with.
struct WhatIf {
  std::function<std::unique_ptr<Recording>(const MonitorConfig&)> open;
  std::function<std::shared_ptr<const RobotModel>(const MonitorConfig&)> model;
  std::string out;  ///< folder
};
/// Which stops come, go and move from the first to the second. @return the exit status.
[[nodiscard]] int compareTrials(const WhatIf& what_if, const std::vector<Trial>& trials);
/// The stops of each against those of a reference. @return the exit status.
[[nodiscard]] int sweepTrials(const WhatIf& what_if, const Trial& reference,
                              const std::vector<Trial>& trials);

}  // namespace tccm
