#include "tccm_monitor/time.h"

#include <cmath>

namespace tccm {

Duration fromSeconds(double seconds) { return Duration(std::llround(seconds * 1e9)); }

double toSeconds(Duration duration) { return static_cast<double>(duration.count()) * 1e-9; }

double toSeconds(Time time) { return toSeconds(time.time_since_epoch()); }

}  // namespace tccm
