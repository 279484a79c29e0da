#pragma once

#include <tccm_monitor/CuboidMapChange.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace tccm {

/// A serialized message by what differs from another. Runs are of whole blocks of 32 bytes.
/// @param change reused.
void toChange(const std::vector<std::uint8_t>& before, const std::vector<std::uint8_t>& message,
              tccm_monitor::CuboidMapChange& change);
/// @return empty, or why the change is none of that message. @param message the one before, and
/// then the one that was.
[[nodiscard]] std::string applyChange(const tccm_monitor::CuboidMapChange& change,
                                      std::vector<std::uint8_t>& message);

}  // namespace tccm
