#include "map/tilt_period.h"

#include <algorithm>

#include "tccm_monitor/config_error.h"

namespace tccm {

void TiltPeriod::Config::describe(ParameterTable& table) {
  table.add("tilt_hysteresis_rad", &hysteresis_rad, "rad", {1e-4, 1.0},
            "the tilt has turned once it has come back by this");
}

TiltPeriod::TiltPeriod(const Config& config) : config_(validated(config)) {}

void TiltPeriod::Longest::add(Duration duration) {
  last_[count_ % last_.size()] = duration;
  ++count_;
}

std::optional<Duration> TiltPeriod::Longest::get() const {
  if (count_ == 0) return std::nullopt;
  const std::size_t filled = std::min(count_, last_.size());
  return *std::max_element(last_.begin(), last_.begin() + static_cast<std::ptrdiff_t>(filled));
}

void TiltPeriod::turn(Time stamp, TurningPoints& points) {
  if (points.last) points.period.add(stamp - *points.last);
  if (last_turn_) stroke_.add(stamp - *last_turn_);
  points.last = last_turn_ = stamp;
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
    if (direction_ > 0) turn(highest_stamp_, upper_);
    direction_ = -1;
    lowest_ = tilt;
    lowest_stamp_ = stamp;
  } else if (direction_ <= 0 && tilt - *lowest_ > config_.hysteresis_rad) {
    if (direction_ < 0) turn(lowest_stamp_, lower_);
    direction_ = 1;
    highest_ = tilt;
    highest_stamp_ = stamp;
  }
}

std::optional<Duration> TiltPeriod::period() const {
  const auto upper = upper_.period.get(), lower = lower_.period.get();
  if (!upper || !lower) return upper ? upper : lower;
  return std::max(*upper, *lower);
}

bool TiltPeriod::isAlive(Time now) const {
  const auto whole = period(), stroke = stroke_.get();
  return whole && stroke && now - *last_turn_ <= *stroke + *whole / 4;
}

}  // namespace tccm
