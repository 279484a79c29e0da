#include "tccm_monitor/map/tilt_period.h"

#include <algorithm>

#include "tccm_monitor/config_error.h"

namespace tccm {

void TiltPeriod::Config::validate() const {
  requireInRange("tilt_hysteresis_rad", hysteresis_rad, 1e-4, 1.0);
}

TiltPeriod::TiltPeriod(const Config& config) : config_(config) { config_.validate(); }

void TiltPeriod::TurningPoints::add(Time stamp) {
  if (last) period = stamp - *last;
  last = stamp;
}

void TiltPeriod::reset() { *this = TiltPeriod(config_); }

void TiltPeriod::add(Time stamp, double tilt) {
  if (!highest_ || tilt >= *highest_) {
    highest_ = tilt;
    highest_stamp_ = stamp;
  }
  if (!lowest_ || tilt <= *lowest_) {
    lowest_ = tilt;
    lowest_stamp_ = stamp;
  }
  if (direction_ >= 0 && *highest_ - tilt > config_.hysteresis_rad) {
    // Where the tilt was first seen is no turning point: it may have been halfway.
    if (direction_ > 0) upper_.add(highest_stamp_);
    direction_ = -1;
    lowest_ = tilt;
    lowest_stamp_ = stamp;
  } else if (direction_ <= 0 && tilt - *lowest_ > config_.hysteresis_rad) {
    if (direction_ < 0) lower_.add(lowest_stamp_);
    direction_ = 1;
    highest_ = tilt;
    highest_stamp_ = stamp;
  }
}

std::optional<Duration> TiltPeriod::period() const {
  if (!upper_.period || !lower_.period) return upper_.period ? upper_.period : lower_.period;
  return std::max(*upper_.period, *lower_.period);
}

}  // namespace tccm
