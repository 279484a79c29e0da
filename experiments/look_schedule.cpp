#include "experiments/look_schedule.h"

#include <algorithm>
#include <cmath>

#include "tccm_monitor/config_error.h"

namespace tccm::simulation {

void LookSchedule::Config::validate() const {
  scanner.validate();
  requireInRange("angle_rad", angle_rad, 1e-4, 0.5);
  requireInRange("duration_s", duration_s, 3.0 * tilt.period_s, 1e5);
}

LookSchedule::LookSchedule(const Config& config, double tilt_rad) {
  config.validate();
  const double middle_s = 0.5 * toSeconds(config.scanner.scanDuration());
  bool looked = false;
  for (double stamp_s = 0.0; stamp_s < config.duration_s; stamp_s += config.scanner.period_s) {
    const double tilt = config.tilt.position(fromSeconds(stamp_s + middle_s));
    const bool looks = std::abs(tilt - tilt_rad) <= config.angle_rad;
    if (looks && !looked) looks_s_.push_back(stamp_s + middle_s);
    // A look that lasts over many scans ends with the last of them.
    if (looks && looked) looks_s_.back() = stamp_s + middle_s;
    looked = looks;
  }
  if (looks_s_.size() < 2) {
    throw ConfigError("tilt_rad: the laser never looks where it is tilted by " +
                      std::to_string(tilt_rad));
  }
}

double LookSchedule::longestGap() const {
  double longest = 0.0;
  for (std::size_t i = 1; i < looks_s_.size(); ++i) {
    longest = std::max(longest, looks_s_[i] - looks_s_[i - 1]);
  }
  return longest;
}

/// v (gap + delay) + v^2 / 2a = d
double safeSpeed(double distance_m, double gap_s, const Braking& braking) {
  const double wait_s = gap_s + braking.delay_s;
  const double a = braking.deceleration_mps2;
  return a * (std::sqrt(wait_s * wait_s + 2.0 * distance_m / a) - wait_s);
}

}  // namespace tccm::simulation
