#pragma once

#include <string>

#include "tccm_monitor/time.h"

namespace tccm {

/// A length of time for people, of two or three digits: "35 ms", "2.5 s", "3.0 h", "55 years".
[[nodiscard]] std::string durationText(Duration duration);

/// What is odd about a stamp, for people: "its stamp is 0", or how far it is behind or ahead of
/// now.
[[nodiscard]] std::string stampText(Time stamp, Time now);

}  // namespace tccm
