#include "map/mapper.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

constexpr double kRounding = 1e-3;  // [m] of single precision; plenty

/// The middle of an interval.
Vector3 placeOf(const Grid& grid, CellIndex cell, Columns::Heights heights) {
  const Eigen::Vector2d centre = grid.centre(cell);
  return {centre.x(), centre.y(), grid.metres(heights.bottom + heights.top) / 2.0};
}

/// Of an interval, what may lie in a part of a region: one run, as parts are convex.
Columns::Heights heightsIn(const RegionPart& part, const Grid& grid,
                           const HeldLayer::Interval& held) {
  const double quantum = grid.config().height_quantum_m;
  Vector3 place;
  place.head<2>() = grid.centre(held.cell);
  // Up to so many quanta away from this one nothing lies in the part; 0: this one does.
  const auto outside = [&](int height) {
    place.z() = grid.metres(height) + 0.5 * quantum;
    const double beyond = part.beyond(place);
    return beyond > 0.0 ? std::max(1, static_cast<int>(std::min(beyond / quantum, 1e6))) : 0;
  };
  int bottom = held.heights.bottom, top = held.heights.top;
  for (int step = 1; bottom < top && step > 0; bottom += step) step = outside(bottom);
  for (int step = 1; bottom < top && step > 0; top -= step) step = outside(top - 1);
  if (bottom >= top) return {0, 0};
  return {static_cast<Height>(bottom), static_cast<Height>(top)};
}

}  // namespace

void Hold::Config::describe(ParameterTable& table) {
  table.add("hold_s", &longest_s, "s", {0.0, 600.0},
            "what leaves the window is held so long at most, unless its place is looked at; 0: it "
            "is gone");
  table.add("hold_look_angle_rad", &look_angle_rad, "rad", {0.005, 0.2},
            "a look within it of a place looks at the place");
  table.add("hold_outline_rad", &outline_rad, "rad", {0.0, 0.2},
            "but not within it of where the robot stands before the place: at least what scans are "
            "apart");
  table.add("hold_look_short_m", &look_short_m, "m", {0.0, 1.0},
            "a look that ends this much before a place saw it all the same");
  table.add("hold_support_points", &support_points, "points", {1.0, 1000.0},
            "what leaves the window is held where so many returns lie around; a camera's flying "
            "pixels, which are fewer, must not gather");
  table.add("held_max", &intervals_max, "", {1.0, 1e7},
            "intervals that are held at most; where more should be: MAP_OVERFLOW");
}

Hold::Hold(const Config& config, const IntegrationMap& map, const LookMap& looks)
    : config_(validated(config)),
      newest_looks_(config.look_angle_rad, config.outline_rad),
      held_(map.grid().cells(), active() ? config.intervals_max : 0),
      viewpoints_(map.config().scans_max + 1, Vector3::Zero()),
      asked_(looks.image().grid().pixels()) {}

void Hold::clear() {
  newest_looks_.clear();
  held_.clear();
  lost_serial_.reset();
}

void Hold::noteLoss(const IntegrationMap& map) {
  lost_serial_ = map.serial();
  lost_at_ = map.newestStamp();
}

void Hold::follow(const ScanReturns& scan, const IntegrationMap& map, const LookMap& looks) {
  if (!active()) return;
  viewpointOf(map.serial()) = scan.viewpoint;
  newest_looks_.add(map.serial(), scan.looks, static_cast<std::uint32_t>(map.scans()));
  if (held_.intervals().empty()) return;
  for (const Vector3& p_fixed : scan.points) {
    const auto place = map.grid().place(p_fixed);
    if (!place) continue;
    const auto heights = map.occupiedBy(*place);
    if (!held_.seen(place->cell, heights)) noteLoss(map);
  }
  askWhereChanged(looks);
  releaseSeen(scan, map, looks.image());
}

/// Whether a place is in view depends on its own direction and those beside, above and below.
void Hold::askWhereChanged(const LookMap& looks) {
  const DirectionGrid& grid = looks.image().grid();
  asked_.clear();
  looks.changed().visit([&](std::size_t pixel) {
    const int row = grid.rowOfPixel(pixel), column = grid.columnOfPixel(pixel, row);
    asked_.insert(pixel);
    asked_.insert(grid.index(row, grid.wrapped(column - 1)));
    asked_.insert(grid.index(row, grid.wrapped(column + 1)));
    if (row > 0) asked_.insert(grid.index(row - 1, column));
    if (row + 1 < grid.rows()) asked_.insert(grid.index(row + 1, column));
  });
}

/// Lets go of what is held for long enough, and of what looks tell of. Of most that is held none
/// has come to tell: where no look of the scan came near and the image is as it was, the answer is
/// what it was, no.
void Hold::releaseSeen(const ScanReturns& scan, const IntegrationMap& map, const LookImage& looks) {
  const Duration longest = fromSeconds(config_.longest_s);
  const auto milliseconds = [](auto duration) {  // from 0 on again after 49 days
    return static_cast<std::uint32_t>(duration / std::chrono::milliseconds(1));
  };
  const std::uint32_t now_ms = milliseconds(scan.stamp.time_since_epoch());
  const std::uint32_t longest_ms = milliseconds(longest);
  const bool is_elsewhere = asked_from_ != looks.viewpoint();
  asked_from_ = looks.viewpoint();
  const auto mayBeOver = [&](const Glances& all, std::size_t begin, std::size_t end) {
    if (is_elsewhere) return ~std::uint64_t{0};
    std::array<std::uint32_t, HeldLayer::kBlock> asks;
    newest_looks_.maySeeLast(all.x() + begin, all.y() + begin, all.z() + begin, end - begin,
                             asks.data());
    const std::uint32_t* since_ms = all.sinceMs() + begin;
    for (std::size_t i = 0; i < end - begin; ++i) {
      asks[i] |= now_ms - since_ms[i] >= longest_ms ? 1U : 0U;
    }
    const std::uint32_t* directions = all.directions() + begin;
    std::uint64_t bits = 0;
    for (std::size_t i = end - begin; i-- > 0;) {
      bits = bits << 1U | asks[i] | static_cast<std::uint64_t>(asked_.has(directions[i]));
    }
    return bits;
  };
  held_.releaseIf(mayBeOver, [&](const HeldLayer::Interval& held, Glance& glance) {
    const bool is_known = !is_elsewhere && glance.isKnown();
    if (is_known && now_ms - glance.since_ms < longest_ms &&
        !newest_looks_.maySeeLast(glance.place) && !mayBeInView(held, glance, looks)) {
      return false;
    }
    const Vector3 place = placeOf(map.grid(), held.cell, held.heights);
    if (!is_known) {
      const Vector3 sight = place - looks.viewpoint();
      glance = {place.cast<float>(), static_cast<float>(sight.norm()),
                static_cast<std::uint32_t>(looks.grid().pixelOf(sight)),
                milliseconds(held.since.time_since_epoch())};
    }
    return scan.stamp - held.since > longest ||
           newest_looks_.sawLast(place, scan.viewpoint, config_.look_short_m) ||
           looks.inViewSince(held.seen, place, -config_.look_short_m);
  });
}

/// Whether a pass in its own direction reached it: less than what is asked of the image then.
bool Hold::mayBeInView(const HeldLayer::Interval& held, const Glance& glance,
                       const LookImage& looks) const {
  const double least = static_cast<double>(glance.range) + config_.look_short_m - kRounding;
  const LookImage::Passes& passes = looks.passes(glance.direction);
  return std::any_of(passes.begin(), passes.end(), [&](const LookImage::Pass& pass) {
    return pass.range() >= least && looks.timeOf(pass.first) > held.seen;
  });
}

void Hold::expireOldest(IntegrationMap& map, const LookImage& looks, Time now) {
  if (!active()) return map.expireOldest();
  const Time seen = map.oldestStamp();
  map.expireOldest([&](const Columns::Interval& interval) {
    const Columns::Heights heights = interval.heights();
    const Vector3& viewpoint = viewpointOf(interval.serial);
    const Vector3 place = placeOf(map.grid(), interval.cell, heights);
    if (newest_looks_.sawSince(interval.serial, place, viewpoint, config_.look_short_m) ||
        looks.inViewSince(seen, place, -config_.look_short_m)) {
      return;
    }
    const std::uint32_t points = std::max(1U, map.pointsIn(interval.cell, heights));
    const std::uint32_t around = std::max(points, map.pointsAround(interval.cell, heights));
    if (around < config_.support_points) return;
    const std::uint32_t support = around + heldAround(map.grid(), interval.cell, heights);
    const bool fits = held_.hold(
        {interval.cell, heights, points, support, interval.serial, interval.born, seen, now});
    if (!fits) noteLoss(map);
  });
}

/// Returns that are held near an interval.
std::uint32_t Hold::heldAround(const Grid& grid, CellIndex cell, Columns::Heights heights) const {
  const Height reach = grid.heightOf(IntegrationMap::kSupportHeight);
  std::uint32_t points = 0;
  grid.visitRowsAround(cell, [&](CellIndex first, CellIndex last) {
    held_.visit(first, last, [&](const HeldLayer::Interval& held) {
      const bool is_near =
          held.heights.bottom - reach <= heights.top && heights.bottom - reach <= held.heights.top;
      if (is_near) points += held.points;
    });
  });
  return points;
}

void Hold::forget(const Region& region, const IntegrationMap& map) {
  for (const PaddedShape& shape : region) {
    const RegionPart part(shape, map.placeDoubt());
    const bool fits = held_.cut(
        [&](const HeldLayer::Interval& held) { return heightsIn(part, map.grid(), held); });
    if (!fits) noteLoss(map);
  }
}

void Mapper::Config::describe(ParameterTable& table) {
  map.describe(table);
  table.add("window_scans", &window_scans, "scans", {0.0, static_cast<double>(map.scans_max)},
            "above 0: the window's length; at most `window_scans_max`");
  table.add("window_s", &window_s, "s", {0.0, 600.0}, "above 0: the window's length");
  table.add("window_tilt_periods", &window_tilt_periods, "periods", {1.0, 10.0},
            "the window's length where neither is set; the period is measured");
  tilt.describe(table);
  table.add("tilt_period_min_s", &tilt_period_min_s, "s", {0.0, 60.0},
            "no tilt turns to and fro in less: where it seems to, the map is not complete");
  table.add("scan_gap_max_s", &scan_gap_max_s, "s", {0.001, 600.0},
            "after a longer gap the window has to fill again");
  table.add("time_jump_back_s", &time_jump_back_s, "s", {0.0, 600.0},
            "a scan older than the last by more starts the map over");
  looks.describe(table);
  hold.describe(table);
  appearances.describe(table);
}

void Mapper::Config::validate() const {
  map.grid.validate();
  if (window_scans > 0 && window_s > 0.0) {
    throw ConfigError("window_scans, window_s: at most one of them may be above 0");
  }
}

Mapper::Mapper(const Config& config)
    : config_(validated(config)),
      map_(config.map, config.hold.intervals_max),
      looks_(config.looks),
      hold_(config.hold, map_, looks_),
      self_share_(config.map.scans_max),
      appearances_(config.appearances, map_, config.looks.resolution_rad),
      tilt_(config.tilt) {}

Mapper::Outcome Mapper::add(const ScanReturns& scan) {
  if (!scan.viewpoint.allFinite() || !std::isfinite(scan.tilt)) return {"bad_viewpoint", {}};
  if (newest_ && *newest_ - scan.stamp > fromSeconds(config_.time_jump_back_s)) clear();
  if (newest_ && scan.stamp <= *newest_) return {"out_of_order", {}};
  if (!newest_ || scan.stamp - *newest_ > fromSeconds(config_.scan_gap_max_s)) {
    unbroken_since_ = scan.stamp;
    tilt_.restart();
  }
  newest_ = scan.stamp;
  viewpoint_ = scan.viewpoint;
  followTilt(scan.stamp, scan.tilt);
  if (map_.scans() == config_.map.scans_max) expireOldest();
  const auto added = map_.add(scan.stamp, scan.points);
  if (scan.is_whole) appearances_.follow(map_, looks_.image());
  looks_.add(scan.stamp, scan.looks, scan.is_whole);
  countSelf(scan);
  hold_.follow(scan, map_, looks_);
  expire();
  return {{}, added};
}

void Mapper::clear() {
  map_.clear();
  looks_.clear();
  hold_.clear();
  self_share_.clear();
  appearances_.clear();
  tilt_.restart();
  last_period_.reset();
  newest_.reset();
  last_expired_.reset();
}

void Mapper::followTilt(Time stamp, double tilt) {
  tilt_.add(stamp, tilt);
  if (tilt_.standsStill(stamp)) {
    // How long it stood is no period of the tilt. Whether it goes on is known after a whole one.
    tilt_stopped_ = true;
    tilt_.reset();
    unbroken_since_ = stamp;
  } else if (tilt_.period()) {
    last_period_ = tilt_.period();
    tilt_stopped_ = false;
  }
}

/// By looks alone: a scan has one for each return, a cloud one for each block of directions. The
/// floor below the area counts: an arm alone before it does not hide that the sensor sees.
void Mapper::countSelf(const ScanReturns& scan) {
  std::size_t self = 0, others = 0;
  const double lowest = config_.map.grid.height_min_m;
  for (const Look& look : scan.looks) {
    if (look.what != Seen::kRobot && look.what != Seen::kSurface) continue;
    const Vector3 end(look.end.x(), look.end.y(), std::max(look.end.z(), lowest));
    if (!map_.grid().place(end)) continue;
    ++(look.what == Seen::kRobot ? self : others);
  }
  self_share_.add(scan.stamp, self, others, lookPeriod());
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

std::size_t Mapper::forget(const Region& region, Time until) {
  const std::size_t returns = map_.forget(region, until);
  hold_.forget(region, map_);
  return returns;
}

bool Mapper::complete() const {
  if (!newest_ || tiltTooFast()) return false;
  const Time oldest = map_.oldestStamp();
  if (oldest < unbroken_since_) return false;
  // However short the window is.
  if (tilt_stopped_ || tilt_.awaitsSweep()) return false;
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

void Mapper::snapshot(CuboidMap& map) {
  map_.snapshot(map, &hold_.held());
  appearances_.apply(map_, map);
  map.complete = complete();
  map.overflowed = map.overflowed || hold_.overflowed(map_);
  map.tilt_stopped = tilt_stopped_;
  map.look_period = lookPeriod();
  map.hold = fromSeconds(config_.hold.longest_s);
  map.self_share = self_share_.share();
  map.looks.copyFrom(looks_.image());
  map.viewpoint = viewpoint_;
  map.window = map_.scans() > 0 ? *newest_ - map_.oldestStamp() : Duration::zero();
}

void Mapper::reserve(CuboidMap& map) const {
  map_.reserve(map);
  map.cuboids.reserve(config_.map.intervals_max + config_.hold.intervals_max);
  map.looks.copyFrom(looks_.image());
}

}  // namespace tccm
