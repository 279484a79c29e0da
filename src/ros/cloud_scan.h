#pragma once

#include <tccm_monitor/CloudScan.h>

#include <string>

#include "sight/look.h"

namespace tccm {

/// Reuses the message's memory. @param frame the fixed frame.
void toMessage(const ScanReturns& returns, const std::string& frame,
               tccm_monitor::CloudScan& message);

/// @return empty, or why the message is none. @param returns reused.
[[nodiscard]] std::string fromMessage(const tccm_monitor::CloudScan& message, ScanReturns& returns);

}  // namespace tccm
