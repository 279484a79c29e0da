#pragma once

#include <tccm_monitor/CuboidFlag.h>
#include <tccm_monitor/MonitorStatus.h>
#include <tccm_monitor/MotionPermission.h>

#include "check/checker_config.h"

namespace tccm {

[[nodiscard]] tccm_monitor::CuboidFlag toFlag(const CuboidMap& map, std::uint32_t cuboid,
                                              std::uint8_t col);

/// All but the frame and the latencies. @param checker that gave the verdict.
void toMessage(const Verdict& verdict, const Checker& checker,
               tccm_monitor::MonitorStatus& message);

/// All but the header, sequence and valid_until.
void toMessage(const Verdict& verdict, tccm_monitor::MotionPermission& message);

}  // namespace tccm
