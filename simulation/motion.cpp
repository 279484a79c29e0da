#include "simulation/motion.h"

#include <algorithm>
#include <cmath>

#include "tccm_monitor/config_error.h"

namespace tccm::simulation {
namespace {

constexpr double kNear = 4e-6;  // [m] from an end counts as there

}  // namespace

double TiltMotion::position(Duration elapsed) const {
  const double rate = 2.0 * M_PI / period_s;
  return mean_rad + amplitude_rad * std::sin(rate * toSeconds(elapsed) + phase_rad);
}

double TiltMotion::velocity(Duration elapsed) const {
  const double rate = 2.0 * M_PI / period_s;
  return amplitude_rad * rate * std::cos(rate * toSeconds(elapsed) + phase_rad);
}

void PathController::Config::validate() const {
  requireInRange("speed_mps", speed_mps, 0.0, 5.0);
  requireInRange("acceleration_mps2", acceleration_mps2, 1e-3, 100.0);
  requireInRange("resume_mps2", resume_mps2, 1e-3, 100.0);
  requireInRange("latency_s", latency_s, 0.0, 10.0);
  requireInRange("release_delay_s", release_delay_s, 0.0, 100.0);
  requireInRange("dwell_s", dwell_s, 0.0, 100.0);
  double reached_m = 0.0;
  for (const Stage& stage : stages) {
    requireInRange("stage end_m", stage.end_m, reached_m, 1e3);
    requireInRange("stage speed_mps", stage.speed_mps, 1e-3, 5.0);
    requireInRange("stage dwell_s", stage.dwell_s, 0.0, 1e4);
    reached_m = stage.end_m;
  }
}

PathController::PathController(const Config& config, double path_length_m)
    : config_(config), length_(path_length_m) {
  config_.validate();
}

void PathController::step(Time now, bool stop) {
  const double elapsed = last_ ? toSeconds(now - *last_) : 0.0;
  last_ = now;
  obey(now, stop);
  obeyScale(now);
  if (inStages()) {
    finishStage(now);
  } else {
    turnAtEnd(now);
  }
  const double wanted = speedWanted(now, elapsed);
  const double gentle = resuming_ ? config_.resume_mps2 : config_.acceleration_mps2;
  const bool faster = std::abs(wanted) > std::abs(speed_);
  const double change_max = elapsed * (faster ? gentle : config_.acceleration_mps2);
  const double before = speed_;
  speed_ += std::clamp(wanted - speed_, -change_max, change_max);
  if (!braking_ && wanted != 0.0 && std::abs(speed_) >= speedMax()) resuming_ = false;
  distance_ = std::clamp(distance_ + 0.5 * (before + speed_) * elapsed, 0.0, end());
}

void PathController::obey(Time now, bool stop) {
  if (stop) {
    if (!stop_since_) stop_since_ = now;
    free_since_.reset();
    if (now - *stop_since_ >= fromSeconds(config_.latency_s)) braking_ = resuming_ = true;
    return;
  }
  stop_since_.reset();
  if (!free_since_) free_since_ = now;
  if (now - *free_since_ >= fromSeconds(config_.release_delay_s)) braking_ = false;
}

void PathController::obeyScale(Time now) {
  scales_.emplace_back(now, scale_heard_);
  while (!scales_.empty() && now - scales_.front().first >= fromSeconds(config_.latency_s)) {
    scale_ = scales_.front().second;
    scales_.pop_front();
  }
}

double PathController::end() const {
  if (!inStages()) return length_;
  const std::size_t stage = std::min(stage_, config_.stages.size() - 1);
  return std::min(length_, config_.stages[stage].end_m);
}

double PathController::speedMax() const {
  if (!inStages()) return scale_ * config_.speed_mps;
  return stage_ < config_.stages.size() ? scale_ * config_.stages[stage_].speed_mps : 0.0;
}

void PathController::finishStage(Time now) {
  if (stage_ == config_.stages.size() || end() - distance_ > kNear || braking_) return;
  if (!dwell_until_) {
    speed_ = 0.0;
    dwell_until_ = now + fromSeconds(config_.stages[stage_].dwell_s);
  }
  if (now < *dwell_until_) return;
  dwell_until_.reset();
  ++stage_;
}

/// The way back begins after a dwell at the end of the path.
void PathController::turnAtEnd(Time now) {
  const double left = outbound() ? length_ - distance_ : distance_;
  if (left > kNear || braking_) return;
  speed_ = 0.0;
  direction_ = -direction_;
  dwell_until_ = now + fromSeconds(config_.dwell_s);
}

double PathController::speedWanted(Time now, double elapsed) const {
  if (braking_ || (dwell_until_ && now < *dwell_until_)) return 0.0;
  const double to_end = outbound() ? end() - distance_ : distance_;
  const double left = std::max(0.0, to_end - std::abs(speed_) * elapsed);  // after this step
  // Never quite zero before the end, so that the last fraction of a millimetre is covered too.
  constexpr double kCreep = 2e-3;  // [m/s]
  const double can_stop =
      std::max(kCreep, std::sqrt(2.0 * config_.acceleration_mps2 * left) * 0.98);
  return direction_ * std::min(speedMax(), can_stop);
}

}  // namespace tccm::simulation
