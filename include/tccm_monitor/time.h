#pragma once

#include <chrono>

namespace tccm {

/// The clock that message stamps live on: nanoseconds since its epoch, wall or simulated. It has no
/// now(): the core is handed the time, so that a recording gives the same verdicts at every replay.
struct StampClock {
  using duration = std::chrono::nanoseconds;
  using rep = duration::rep;
  using period = duration::period;
  using time_point = std::chrono::time_point<StampClock>;
};

using Time = StampClock::time_point;
using Duration = StampClock::duration;

/// Rounds to the nearest nanosecond. @param seconds finite, within +-292 years.
[[nodiscard]] Duration fromSeconds(double seconds);
[[nodiscard]] double toSeconds(Duration duration);
/// Seconds since the clock's epoch; resolves about 0.2 us for today's wall clock.
[[nodiscard]] double toSeconds(Time time);

}  // namespace tccm
