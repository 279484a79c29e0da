#include "map/hold.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace tccm {
namespace {

/// The middle of an interval.
Vector3 placeOf(const Grid& grid, CellIndex cell, Columns::Heights heights) {
  const Eigen::Vector2d centre = grid.centre(cell);
  return {centre.x(), centre.y(), grid.metres(heights.bottom + heights.top) / 2.0};
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
  table.add("held_max", &intervals_max, "", {1.0, 1e7},
            "intervals that are held at most; where more should be: MAP_OVERFLOW");
}

Hold::Hold(const Config& config, const IntegrationMap& map)
    : config_(validated(config)),
      newest_looks_(config.look_angle_rad, config.outline_rad),
      held_(map.grid().cells(), active() ? config.intervals_max : 0),
      viewpoints_(map.scansMax() + 1, Vector3::Zero()) {}

void Hold::clear() {
  newest_looks_.clear();
  held_.clear();
  lost_serial_.reset();
}

std::size_t Hold::memoryBytes() const {
  return newest_looks_.memoryBytes() + held_.memoryBytes() +
         viewpoints_.capacity() * sizeof(Vector3);
}

void Hold::follow(const ScanReturns& scan, const IntegrationMap& map, const LookImage& looks) {
  if (!active()) return;
  viewpointOf(map.serial()) = scan.viewpoint;
  newest_looks_.add(map.serial(), scan.looks, static_cast<std::uint32_t>(map.scans()));
  if (held_.empty()) return;
  for (const Vector3& p_fixed : scan.points) {
    const auto place = map.grid().place(p_fixed);
    if (!place) continue;
    const auto heights = map.occupiedBy({place->cell, place->height});
    if (!held_.seen(place->cell, heights)) lost_serial_ = map.serial();
  }
  const Duration longest = fromSeconds(config_.longest_s);
  held_.releaseIf([&](const HeldLayer::Interval& held) {
    const Vector3 place = placeOf(map.grid(), held.cell, held.heights);
    return scan.stamp - held.since > longest ||
           newest_looks_.sawLast(place, scan.viewpoint, config_.look_short_m) ||
           looks.inViewSince(held.seen, place, -config_.look_short_m);
  });
}

void Hold::expireOldest(IntegrationMap& map, const LookImage& looks, Time now) {
  if (!active()) return map.expireOldest();
  const Time seen = map.oldestStamp();
  map.expireOldest([&](const IntegrationMap::Leaving& interval) {
    const Vector3& viewpoint = viewpointOf(interval.serial);
    const Vector3 place = placeOf(map.grid(), interval.cell, interval.heights);
    if (newest_looks_.sawSince(interval.serial, place, viewpoint, config_.look_short_m) ||
        looks.inViewSince(seen, place, -config_.look_short_m)) {
      return;
    }
    const std::uint32_t points = std::max(1U, map.pointsIn(interval.cell, interval.heights));
    const std::uint32_t support =
        std::max(points, map.pointsAround(interval.cell, interval.heights)) +
        heldAround(map.grid(), interval.cell, interval.heights);
    const bool fits = held_.hold({interval.cell, interval.heights, points, support, interval.serial,
                                  interval.born, seen, now});
    if (!fits) lost_serial_ = map.serial();
  });
}

/// Returns that are held near an interval.
std::uint32_t Hold::heldAround(const Grid& grid, CellIndex cell, Columns::Heights heights) const {
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

void Hold::forget(const Region& region, const IntegrationMap& map) {
  const Grid& grid = map.grid();
  for (const PaddedShape& shape : region) {
    // The nearest point of an interval may be nearer than its middle by so much.
    const double growth =
        std::hypot(std::sqrt(0.5) * grid.config().cell_size_m, map.config().thickness_m);
    const RegionPart part(shape, growth);
    held_.releaseIf([&](const HeldLayer::Interval& held) {
      return part.contains(placeOf(grid, held.cell, held.heights));
    });
  }
}

}  // namespace tccm
