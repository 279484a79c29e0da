#pragma once

#include <tccm_monitor/CuboidFlag.h>
#include <tccm_monitor/Exemption.h>
#include <tccm_monitor/MonitorStatus.h>

#include <vector>

#include "check/checker_config.h"

namespace tccm {

/// "OK", "SLOW", "STOP" or "FAULT".
[[nodiscard]] const char* name(Level level);

/// A cuboid, and why: col as in Cuboid.msg.
struct Flagged {
  std::uint32_t cuboid;
  std::uint8_t col;
};
/// What links touch, or hide behind, at the present pose and at the end of the way ahead.
[[nodiscard]] std::vector<Flagged> flaggedBy(const Verdict& verdict);

[[nodiscard]] tccm_monitor::CuboidFlag toFlag(const CuboidMap& map, std::uint32_t cuboid,
                                              std::uint8_t col);

/// As the last check or question found them.
[[nodiscard]] std::vector<tccm_monitor::Exemption> exemptionsOf(const Checker& checker);

/// All but the frame and the latencies. @param checker that gave the verdict.
[[nodiscard]] tccm_monitor::MonitorStatus statusOf(const Verdict& verdict, const Checker& checker);

}  // namespace tccm
