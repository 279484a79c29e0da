#pragma once

#include <sensor_msgs/PointCloud2.h>
#include <tccm_monitor/CloudScan.h>

#include <string>

#include "sight/look.h"

namespace tccm {

/// Reuses the message's memory. @param frame the fixed frame.
void toMessage(const ScanReturns& returns, const std::string& frame,
               tccm_monitor::CloudScan& message);

/// @return empty, or why the message is none. @param returns reused.
[[nodiscard]] std::string fromMessage(const tccm_monitor::CloudScan& message, ScanReturns& returns);

/// What is left after the filters, for whoever wants it: x, y and z. Reuses the message's memory.
void toPoints(const ScanReturns& returns, const std::string& frame,
              sensor_msgs::PointCloud2& message);

}  // namespace tccm
