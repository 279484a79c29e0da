#include "map/mapper.h"

#include <algorithm>
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
  looks.validate();
  requireInRange("hold_s", hold_s, 0.0, 600.0);
  requireInRange("hold_look_angle_rad", hold_look_angle_rad, 0.005, 0.2);
  requireInRange("hold_outline_rad", hold_outline_rad, 0.0, 0.2);
  requireInRange("hold_look_short_m", hold_look_short_m, 0.0, 1.0);
  requireInRange("held_max", static_cast<double>(held_max), 1.0, 1e7);
  if (window_scans > 0 && window_s > 0.0) {
    throw ConfigError("window_scans, window_s: at most one of them may be above 0");
  }
}

Mapper::Mapper(const Config& config)
    : config_((config.validate(), config)),
      map_(config.map),
      looks_(config.looks),
      newest_looks_(config.hold_look_angle_rad, config.hold_outline_rad),
      held_(map_.grid().cells(), config.hold_s > 0.0 ? config.held_max : 0),
      ages_(map_),
      viewpoints_(config.map.scans_max + 1, Vector3::Zero()),
      tilt_(config.tilt) {}

Mapper::Outcome Mapper::add(const ScanReturns& scan) {
  settle();
  if (!scan.viewpoint.allFinite() || !std::isfinite(scan.tilt)) return {"bad_viewpoint", {}};
  if (newest_ && *newest_ - scan.stamp > fromSeconds(config_.time_jump_back_s)) clear();
  if (newest_ && scan.stamp <= *newest_) return {"out_of_order", {}};
  if (!newest_ || scan.stamp - *newest_ > fromSeconds(config_.scan_gap_max_s)) {
    unbroken_since_ = scan.stamp;
    tilt_.reset();
  }
  newest_ = scan.stamp;
  viewpoint_ = scan.viewpoint;
  followTilt(scan.stamp, scan.tilt);
  if (map_.scans() == config_.map.scans_max) expireOldest();
  const auto added = map_.add(scan.stamp, scan.points);
  viewpointOf(map_.serial()) = scan.viewpoint;
  looks_.add(scan.stamp, scan.looks);
  if (config_.hold_s > 0.0) {
    newest_looks_.add(map_.serial(), scan.looks, static_cast<std::uint32_t>(map_.scans()));
    release(scan);
  }
  expire();
  held_.sort();
  settled_ = false;
  return {{}, added};
}

void Mapper::settle() {
  if (settled_) return;
  ages_.follow(map_, looks_.image());
  settled_ = true;
}

void Mapper::clear() {
  settled_ = true;
  map_.clear();
  looks_.clear();
  newest_looks_.clear();
  held_.clear();
  ages_.clear();
  lost_serial_.reset();
  tilt_.reset();
  last_period_.reset();
  tilt_stopped_ = false;
  newest_.reset();
  last_expired_.reset();
}

void Mapper::followTilt(Time stamp, double tilt) {
  tilt_.add(stamp, tilt);
  if (!tilt_.period()) return;
  last_period_ = tilt_.period();
  tilt_stopped_ = !tilt_.isAlive(stamp);
  if (!tilt_stopped_) return;
  // How long it stood is no period of the tilt. Whether it goes on is known after a whole one.
  tilt_.reset();
  unbroken_since_ = stamp;
}

std::optional<Duration> Mapper::window() const {
  if (config_.window_s > 0.0) return fromSeconds(config_.window_s);
  if (!last_period_) return std::nullopt;
  return fromSeconds(config_.window_tilt_periods * toSeconds(*last_period_));
}

Duration Mapper::lookPeriod() const {
  if (last_period_) return *last_period_;
  if (config_.window_s > 0.0) return fromSeconds(config_.window_s);
  // A window of so many scans that is not tilted through is as long as it is.
  return config_.window_scans > 0 && map_.scans() > 0 ? *newest_ - map_.oldestStamp()
                                                      : Duration::zero();
}

void Mapper::expire() {
  if (config_.window_scans > 0) {
    while (map_.scans() > static_cast<std::size_t>(config_.window_scans)) expireOldest();
    return;
  }
  const auto length = window();
  while (length && *newest_ - map_.oldestStamp() > *length) {
    last_expired_ = map_.oldestStamp();
    expireOldest();
  }
}

/// What the robot hides is no less there for having left the window.
void Mapper::expireOldest() {
  if (config_.hold_s <= 0.0) return map_.expireOldest();
  const Time seen = map_.oldestStamp();
  map_.expireOldest([&](const IntegrationMap::Leaving& interval) {
    const Vector3& viewpoint = viewpointOf(interval.serial);
    const Vector3 place = placeOf(interval.cell, interval.heights);
    if (newest_looks_.sawSince(interval.serial, place, viewpoint, config_.hold_look_short_m) ||
        looks_.image().inViewSince(seen, place, -config_.hold_look_short_m)) {
      return;
    }
    const std::uint32_t points = std::max(1U, map_.pointsIn(interval.cell, interval.heights));
    const std::uint32_t support =
        std::max(points, map_.pointsAround(interval.cell, interval.heights)) +
        heldAround(interval.cell, interval.heights);
    const bool fits = held_.hold({interval.cell, interval.heights, points, support, interval.serial,
                                  interval.born, seen, *newest_});
    if (!fits) lost_serial_ = map_.serial();
  });
}

/// Returns that are held near an interval.
std::uint32_t Mapper::heldAround(CellIndex cell, Columns::Heights heights) const {
  const Grid& grid = map_.grid();
  const Height reach = grid.heightOf(IntegrationMap::kSupportHeight);
  const auto column = [&grid](CellIndex c) { return static_cast<int>(c % grid.cellsX()); };
  const auto row = [&grid](CellIndex c) { return static_cast<int>(c / grid.cellsX()); };
  std::uint32_t points = 0;
  for (const HeldLayer::Interval& held : held_.intervals()) {
    const bool is_near = std::abs(column(held.cell) - column(cell)) <= 1 &&
                         std::abs(row(held.cell) - row(cell)) <= 1 &&
                         held.heights.bottom - reach <= heights.top &&
                         heights.bottom - reach <= held.heights.top;
    if (is_near) points += held.points;
  }
  return points;
}

/// Lets go of what the newest scan saw the place of, be it there or not.
void Mapper::release(const ScanReturns& scan) {
  if (held_.empty()) return;
  for (const Vector3& p_fixed : scan.points) {
    const auto place = map_.grid().place(p_fixed);
    if (!place) continue;
    const auto heights = map_.occupiedBy({place->cell, place->height});
    if (!held_.seen(place->cell, heights)) lost_serial_ = map_.serial();
  }
  const Duration longest = fromSeconds(config_.hold_s);
  held_.releaseIf([&](const HeldLayer::Interval& held) {
    const Vector3 place = placeOf(held.cell, held.heights);
    return scan.stamp - held.since > longest ||
           newest_looks_.sawLast(place, scan.viewpoint, config_.hold_look_short_m) ||
           looks_.image().inViewSince(held.seen, place, -config_.hold_look_short_m);
  });
}

Vector3 Mapper::placeOf(CellIndex cell, Columns::Heights heights) const {
  const Grid& grid = map_.grid();
  const Eigen::Vector2d centre = grid.centre(cell);
  return {centre.x(), centre.y(), grid.metres(heights.bottom + heights.top) / 2.0};
}

std::size_t Mapper::forget(const Region& region, Time until) {
  const std::size_t returns = map_.forget(region, until);
  for (const PaddedShape& shape : region) {
    // The nearest point of an interval may be nearer than its middle by so much.
    const Grid::Config& grid = config_.map.grid;
    const double growth = std::hypot(std::sqrt(0.5) * grid.cell_size_m, config_.map.thickness_m);
    const RegionPart part(shape, growth);
    held_.releaseIf([&](const HeldLayer::Interval& held) {
      return part.contains(placeOf(held.cell, held.heights));
    });
  }
  return returns;
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
    if (!tilt_.period()) return false;
    // A window that has grown lacks what left it while it was shorter.
    if (last_expired_ && *last_expired_ > *newest_ - *tilt_.period()) return false;
  }
  // Where the window needs more scans than there is memory for, its oldest part is missing.
  return map_.scans() < config_.map.scans_max;
}

void Mapper::snapshot(CuboidMap& map) const {
  map_.snapshot(map, held_);
  ages_.apply(map_, map);
  map.complete = complete();
  map.overflowed = map.overflowed || (lost_serial_ && map_.serial() - *lost_serial_ < map_.scans());
  map.tilt_stopped = tilt_stopped_;
  map.look_period = lookPeriod();
  map.looks.copyFrom(looks_.image());
  map.viewpoint = viewpoint_;
  map.window = map_.scans() > 0 ? *newest_ - map_.oldestStamp() : Duration::zero();
}

void Mapper::reserve(CuboidMap& map) const {
  map_.reserve(map);
  map.cuboids.reserve(config_.map.intervals_max + config_.held_max);
  map.looks.copyFrom(looks_.image());
}

std::size_t Mapper::memoryBytes() const {
  return map_.memoryBytes() + looks_.memoryBytes() + newest_looks_.memoryBytes() +
         held_.memoryBytes() + ages_.memoryBytes() + viewpoints_.capacity() * sizeof(Vector3);
}

}  // namespace tccm
