#include "simulation/scanning_head.h"

#include <algorithm>
#include <cmath>

#include "simulation/named.h"
#include "tccm_monitor/config_error.h"

namespace tccm::simulation {
namespace {

// [1/s] at which faults come and go
constexpr double kPaceRate = 10.0;
constexpr double kWidthRate = 2.0;
constexpr double kTurnRate = 2.0;

}  // namespace

TiltFault tiltFault(const std::string& name) {
  return named<TiltFault>("tilt_fault", name, {"none", "frozen", "narrowed", "turned_away"});
}

void ScanningHead::Config::validate() const {
  requireInRange("tilt_period_s", tilt.period_s, 0.1, 100.0);
  requireInRange("narrowed_share", narrowed_share, 0.0, 1.0);
  requireInRange("turned_away_rad", turned_away_rad, -1.5, 1.5);
  for (const Schedule& schedule : faults) {
    requireInRange("tilt_fault_at_s", schedule.at_s, 0.0, 1e6);
    requireInRange("tilt_fault_for_s", schedule.for_s, 0.0, 1e6);
  }
}

ScanningHead::ScanningHead(const Config& config, Time start)
    : config_((config.validate(), config)), start_(start), now_(start) {}

void ScanningHead::Slide::step(double wanted, double rate_max, double elapsed_s) {
  const double change = std::clamp(wanted - value, -rate_max * elapsed_s, rate_max * elapsed_s);
  rate = elapsed_s > 0.0 ? change / elapsed_s : 0.0;
  value += change;
}

TiltFault ScanningHead::fault() const {
  TiltFault fault = set_;
  for (const Schedule& schedule : config_.faults) {
    const Time from = start_ + fromSeconds(schedule.at_s);
    if (now_ >= from && now_ < from + fromSeconds(schedule.for_s)) fault = schedule.fault;
  }
  return fault;
}

void ScanningHead::step(Time now) {
  const Duration elapsed = now - now_;
  now_ = now;
  const TiltFault present = fault();
  const double elapsed_s = toSeconds(elapsed);
  pace_.step(present == TiltFault::kFrozen ? 0.0 : 1.0, kPaceRate, elapsed_s);
  width_.step(present == TiltFault::kNarrowed ? 0.0 : 1.0, kWidthRate, elapsed_s);
  turn_.step(present == TiltFault::kTurnedAway ? 1.0 : 0.0, kTurnRate, elapsed_s);
  phase_ += Duration(std::llround(pace_.value * static_cast<double>(elapsed.count())));
}

double ScanningHead::amplitudeShare() const {
  return config_.narrowed_share + width_.value * (1.0 - config_.narrowed_share);
}

double ScanningHead::tilt() const {
  const TiltMotion& tilt = config_.tilt;
  return tilt.mean_rad + amplitudeShare() * (tilt.position(phase_) - tilt.mean_rad);
}

double ScanningHead::tiltVelocity() const {
  const TiltMotion& tilt = config_.tilt;
  return amplitudeShare() * pace_.value * tilt.velocity(phase_) +
         width_.rate * (1.0 - config_.narrowed_share) * (tilt.position(phase_) - tilt.mean_rad);
}

double ScanningHead::yaw() const { return turn_.value * config_.turned_away_rad; }

}  // namespace tccm::simulation
