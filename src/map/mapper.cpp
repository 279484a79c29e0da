#include "tccm_monitor/map/mapper.h"

#include <cmath>

#include "tccm_monitor/config_error.h"

namespace tccm {

void Mapper::Config::validate() const {
  map.validate();
  tilt.validate();
  requireInRange("window_scans", window_scans, 0, static_cast<double>(map.scans_max));
  requireInRange("window_s", window_s, 0.0, 600.0);
  requireInRange("window_tilt_periods", window_tilt_periods, 1.0, 10.0);
  requireInRange("scan_gap_max_s", scan_gap_max_s, 0.001, 600.0);
  requireInRange("time_jump_back_s", time_jump_back_s, 0.0, 600.0);
  if (window_scans > 0 && window_s > 0.0) {
    throw ConfigError("window_scans, window_s: at most one of them may be above 0");
  }
}

Mapper::Mapper(const Config& config)
    : config_((config.validate(), config)), map_(config.map), tilt_(config.tilt) {}

Mapper::Outcome Mapper::add(const ScanReturns& scan) {
  if (!scan.viewpoint.allFinite() || !std::isfinite(scan.tilt)) return {"bad_viewpoint", {}};
  if (newest_ && *newest_ - scan.stamp > fromSeconds(config_.time_jump_back_s)) clear();
  if (newest_ && scan.stamp <= *newest_) return {"out_of_order", {}};
  if (!newest_ || scan.stamp - *newest_ > fromSeconds(config_.scan_gap_max_s)) {
    unbroken_since_ = scan.stamp;
    tilt_.reset();
  }
  newest_ = scan.stamp;
  viewpoint_ = scan.viewpoint;
  tilt_.add(scan.stamp, scan.tilt);
  const auto added = map_.add(scan.stamp, scan.points);
  expire();
  return {{}, added};
}

void Mapper::clear() {
  map_.clear();
  tilt_.reset();
  newest_.reset();
  last_expired_.reset();
}

std::optional<Duration> Mapper::window() const {
  if (config_.window_s > 0.0) return fromSeconds(config_.window_s);
  if (!tilt_.period()) return std::nullopt;
  return fromSeconds(config_.window_tilt_periods * toSeconds(*tilt_.period()));
}

void Mapper::expire() {
  if (config_.window_scans > 0) {
    while (map_.scans() > static_cast<std::size_t>(config_.window_scans)) map_.expireOldest();
    return;
  }
  const auto length = window();
  while (length && *newest_ - map_.oldestStamp() > *length) {
    last_expired_ = map_.oldestStamp();
    map_.expireOldest();
  }
}

bool Mapper::complete() const {
  if (!newest_) return false;
  const Time oldest = map_.oldestStamp();
  if (oldest < unbroken_since_) return false;
  if (config_.window_scans > 0) {
    return map_.scans() == static_cast<std::size_t>(config_.window_scans);
  }
  const auto length = window();
  if (!length || *newest_ - unbroken_since_ < *length) return false;
  if (config_.window_s == 0.0) {
    if (!tilt_.isAlive(*newest_)) return false;
    // A window that has grown lacks what left it while it was shorter.
    if (last_expired_ && *last_expired_ > *newest_ - *tilt_.period()) return false;
  }
  // Where the window needs more scans than there is memory for, its oldest part is missing.
  return map_.scans() < config_.map.scans_max;
}

void Mapper::snapshot(CuboidMap& map) const {
  map_.snapshot(map);
  map.complete = complete();
  map.viewpoint = viewpoint_;
  map.window = map_.scans() > 0 ? *newest_ - map_.oldestStamp() : Duration::zero();
}

}  // namespace tccm
