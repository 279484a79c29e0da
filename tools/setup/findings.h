#pragma once

#include <string>
#include <vector>

#include "tools/evaluation.h"

namespace tccm {

/// What would stop the robot, or blind the monitor, though nothing is near: a line each, with what
/// to do. What was found near the robot is none of it.
/// @param evaluation of what was heard, finished.
[[nodiscard]] std::vector<std::string> findingsOf(const Evaluation& evaluation,
                                                  const MonitorConfig& settings);

}  // namespace tccm
