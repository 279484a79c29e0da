#pragma once

#include <tccm_monitor/CuboidFlag.h>
#include <tccm_monitor/Exemption.h>
#include <tccm_monitor/MonitorStatus.h>

#include <vector>

#include "check/checker_config.h"
#include "ros/stop_cause.h"

namespace tccm {

[[nodiscard]] tccm_monitor::CuboidFlag toFlag(const CuboidMap& map, std::uint32_t cuboid,
                                              std::uint8_t col);

/// As the last check or question found them.
[[nodiscard]] std::vector<tccm_monitor::Exemption> exemptionsOf(const Checker& checker);

/// All but the frame and the latencies. @param checker that gave the verdict.
[[nodiscard]] tccm_monitor::MonitorStatus statusOf(const Verdict& verdict, const Checker& checker);

}  // namespace tccm
