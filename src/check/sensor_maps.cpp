#include "check/sensor_maps.h"

#include <algorithm>
#include <tuple>

namespace tccm {
namespace {

/// [m] beyond a cuboid that a look has to reach to show that nothing is there any more.
constexpr double kThrough = 0.05;

bool isSame(const SensorMaps::Source& one, const SensorMaps::Source& other) {
  return one.map == other.map && one.is_out == other.is_out && one.seen == other.seen;
}

}  // namespace

void SensorMaps::clear() {
  sources_.clear();
  counted_.clear();
  kept_.clear();
  each_.clear();
  all_ = nullptr;
}

void SensorMaps::unite(Time now, const std::vector<Source>& sources, bool maps_changed) {
  if (sources.size() == 1) {
    each_.clear();
    all_ = sources.front().map.get();
    if (all_) each_.push_back({all_});
    sources_ = sources;
    return;
  }
  select(now, sources);
  if (!maps_changed &&
      std::equal(counted_.begin(), counted_.end(), sources_.begin(), sources_.end(), isSame)) {
    return;
  }
  sources_ = counted_;
  each_.clear();
  kept_.clear();
  for (const Source& source : sources) {
    // Where its cuboids have no place any more, its looks prove nothing.
    if (!source.seen || (!sources_.empty() && !fit(*sources_.front().map, *source.seen))) continue;
    kept_.push_back(source.seen);
    each_.push_back({source.seen.get(), source.is_out});
  }
  all_ = nullptr;
  if (!sources_.empty()) fill();
}

/// A map that began anew lacks what the sensor saw before: that is held as well.
void SensorMaps::select(Time now, const std::vector<Source>& sources) {
  counted_.clear();
  const auto count = [&](const std::shared_ptr<const CuboidMap>& map, const Source& source) {
    if (!map || (source.is_out && now - map->stamp > map->hold)) return;
    if (!counted_.empty() && !fit(*counted_.front().map, *map)) return;
    counted_.push_back({map, source.is_out, source.seen});
  };
  for (const Source& source : sources) count(source.map, source);
  for (const Source& source : sources) {
    if (source.is_out && source.seen != source.map) count(source.seen, source);
  }
}

void SensorMaps::fill() {
  const CuboidMap& first = *sources_.front().map;
  if (!(united_.grid == first.grid)) united_.grid = first.grid;
  united_.thickness = first.thickness;
  united_.viewpoint = first.viewpoint;
  united_.stamp = Time();
  united_.window = united_.look_period = Duration::zero();
  united_.window_scans = united_.appeared = 0;
  united_.complete = true;
  ++united_.serial;
  std::size_t most = 0;
  for (const Source& source : sources_) most += source.map->cuboids.capacity();
  united_.cuboids.reserve(most);
  united_.cuboids.clear();
  for (const Source& source : sources_) {
    united_.stamp = std::max(united_.stamp, source.map->stamp);
    united_.window = std::max(united_.window, source.map->window);
    united_.look_period = std::max(united_.look_period, source.map->look_period);
    united_.window_scans += source.map->window_scans;
  }
  united_.cell_begin.resize(united_.grid.cells() + 1);
  for (CellIndex cell = 0; cell < united_.grid.cells(); ++cell) {
    const auto begin = static_cast<std::ptrdiff_t>(united_.cuboids.size());
    united_.cell_begin[cell] = static_cast<std::uint32_t>(begin);
    for (const Source& source : sources_) append(cell, source);
    std::sort(united_.cuboids.begin() + begin, united_.cuboids.end(),
              [](const Cuboid& a, const Cuboid& b) {
                return std::tie(a.bottom, a.top) < std::tie(b.bottom, b.top);
              });
  }
  united_.cell_begin[united_.grid.cells()] = static_cast<std::uint32_t>(united_.cuboids.size());
  all_ = &united_;
}

void SensorMaps::append(CellIndex cell, const Source& source) {
  const CuboidMap& map = *source.map;
  for (std::uint32_t k = map.cell_begin[cell]; k < map.cell_begin[cell + 1]; ++k) {
    if (isOverruled(map.cuboids[k], source)) continue;
    united_.cuboids.push_back(map.cuboids[k]);
    Cuboid& cuboid = united_.cuboids.back();
    cuboid.held = cuboid.held || source.is_out;
    cuboid.appeared = cuboid.appeared && !source.is_out;
    united_.appeared += cuboid.appeared ? 1 : 0;
  }
}

bool SensorMaps::isOverruled(const Cuboid& cuboid, const Source& by_source) const {
  const Time seen = by_source.map->stamp - std::chrono::milliseconds(cuboid.unseen_ms);
  const UprightBox box = by_source.map->box(cuboid);
  const Vector3 middle = box.center();
  return std::any_of(sources_.begin(), sources_.end(), [&](const Source& other) {
    if (other.map == by_source.map || other.is_out || other.map->stamp <= seen) return false;
    const LookImage& looks = other.map->looks;
    const auto isThrough = [&](double z) {
      return looks.inViewSince(seen, {middle.x(), middle.y(), z}, -kThrough);
    };
    return isThrough(middle.z()) && isThrough(box.min().z()) && isThrough(box.max().z());
  });
}

}  // namespace tccm
