#include "map/integration_map.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

constexpr std::size_t kScanMost = 4096;   // returns of a laser's scan, as a rule
constexpr std::size_t kChunk = 1024;      // returns between two looks at what room there is
constexpr double kPlaceRounding = 1e-6;   // [m]; returns are rounded to the micrometre
constexpr double kHeightRounding = 1e-9;  // [m]

}  // namespace

/// Puts together what a scan's returns occupy before it goes into the columns. Beams side by side
/// fall into a few cells in turn, and mostly see the same surface: most of them only widen what is
/// gathered already. The columns become what they would return by return.
class IntegrationMap::ScanBatch {
 public:
  /// @pre the columns have room for what needs() says. @param serial of the scan, the newest.
  /// @param changed is told the cells.
  ScanBatch(Columns& columns, std::uint32_t serial, IndexSet& changed)
      : columns_(columns), serial_(serial), changed_(changed) {}

  void add(CellIndex cell, Columns::Heights heights) {
    if (widens(gathered_[recent_], cell, heights)) return;
    for (std::size_t i = 0; i < kGathered; ++i) {
      if (!widens(gathered_[i], cell, heights)) continue;
      recent_ = i;
      return;
    }
    insert(gathered_[next_]);
    gathered_[next_] = {cell, heights};
    recent_ = next_;
    next_ = (next_ + 1) % kGathered;
  }
  /// What is gathered still. To be called at the end.
  void finish() {
    for (const Gathered& gathered : gathered_) insert(gathered);
    gathered_ = {};
  }
  /// How many intervals there has to be room for before so many returns are added.
  [[nodiscard]] static constexpr std::size_t needs(std::size_t returns) {
    return 2 * (returns + kGathered);
  }

 private:
  static constexpr std::size_t kGathered = 4;
  struct Gathered {
    CellIndex cell = std::numeric_limits<CellIndex>::max();  ///< none
    Columns::Heights heights = {0, 0};
  };
  /// Whether the heights touch what is gathered, which then has them too.
  static bool widens(Gathered& gathered, CellIndex cell, Columns::Heights heights) {
    if (gathered.cell != cell || heights.bottom > gathered.heights.top ||
        heights.top < gathered.heights.bottom) {
      return false;
    }
    if (heights.bottom < gathered.heights.bottom) gathered.heights.bottom = heights.bottom;
    if (heights.top > gathered.heights.top) gathered.heights.top = heights.top;
    return true;
  }
  void insert(const Gathered& gathered) {
    const auto [bottom, top] = gathered.heights;
    if (bottom >= top) return;
    static_cast<void>(columns_.insert(gathered.cell, bottom, top, serial_));
    changed_.insert(gathered.cell);
  }

  Columns& columns_;
  std::uint32_t serial_;
  IndexSet& changed_;
  std::array<Gathered, kGathered> gathered_ = {};
  std::size_t recent_ = 0;
  std::size_t next_ = 0;
};

/// The same for a cloud, which comes back to a cell row by row: what is gathered lies at the cells.
class IntegrationMap::CloudBatch {
 public:
  /// @pre, @param as ScanBatch's.
  CloudBatch(Columns& columns, std::uint32_t serial, IndexSet& changed, CloudCells& cells)
      : columns_(columns), serial_(serial), changed_(changed), cells_(cells) {}

  void add(CellIndex cell, Columns::Heights heights) {
    Columns::Heights& gathered = cells_.gathered[cell];
    if (gathered.bottom >= gathered.top) {
      cells_.touched.push_back(cell);
    } else if (heights.bottom <= gathered.top && heights.top >= gathered.bottom) {
      heights.bottom = std::min(heights.bottom, gathered.bottom);
      heights.top = std::max(heights.top, gathered.top);
    } else {
      insert(cell, gathered);
    }
    gathered = heights;
  }
  void finish() {
    for (const CellIndex cell : cells_.touched) {
      insert(cell, cells_.gathered[cell]);
      changed_.insert(cell);
      cells_.gathered[cell] = {0, 0};
    }
    cells_.touched.clear();
  }
  [[nodiscard]] std::size_t needs(std::size_t returns) const {
    return 2 * (returns + cells_.touched.size());
  }

 private:
  void insert(CellIndex cell, Columns::Heights heights) {
    static_cast<void>(columns_.insert(cell, heights.bottom, heights.top, serial_));
  }

  Columns& columns_;
  std::uint32_t serial_;
  IndexSet& changed_;
  CloudCells& cells_;
};

void IntegrationMap::Config::describe(ParameterTable& table) {
  grid.describe(table);
  table.add("thickness_m", &thickness_m, "m",
            {grid.height_quantum_m, 2000.0 * grid.height_quantum_m},
            "a point at height z occupies (z - thickness, z], nothing below `height_min_m`");
  table.add("window_scans_max", &scans_max, "scans", {1.0, 100000.0},
            "the longest window there is memory for");
  table.add("window_returns_max", &returns_max, "points", {1.0, 1e8},
            "in the window, 8 bytes each: enough for 0.4 s of a camera's 640 x 480 at 30 Hz");
  table.add("intervals_max", &intervals_max, "", {2.0, 1e8}, "occupied intervals in all cells");
}

IntegrationMap::IntegrationMap(const Config& config, std::size_t held_max)
    : config_(validated(config)),
      grid_(config.grid),
      thickness_(grid_.heightOf(config.thickness_m)),
      // 0.029 / 0.001 is a hair above 29.
      lowest_(grid_.heightCeil(config.grid.height_min_m - kHeightRounding)),
      columns_(grid_.cells(), config.intervals_max, config.scans_max + 2),
      // Layers as thick as a return: returns of two cuboids never share one.
      counts_(grid_, thickness_),
      ring_(config.scans_max, config.returns_max),
      list_(grid_.cells(), config.intervals_max + held_max),
      losses_(grid_.cells()) {
  cloud_cells_.gathered.resize(grid_.cells(), {0, 0});
  cloud_cells_.touched.reserve(grid_.cells());
}

IntegrationMap::Added IntegrationMap::add(Time stamp, const std::vector<Vector3>& returns) {
  if (ring_.full()) expireOldest();
  ++serial_;
  newest_stamp_ = stamp;
  ring_.begin(serial_, stamp);
  const bool may_forget = forgotten_.begin(stamp);
  // A laser's scan has at most scan_beams_max.
  return returns.size() <= kScanMost
             ? addAll(returns, may_forget, ScanBatch(columns_, serial_, list_.changed()))
             : addAll(returns, may_forget,
                      CloudBatch(columns_, serial_, list_.changed(), cloud_cells_));
}

template <typename Batch>
IntegrationMap::Added IntegrationMap::addAll(const std::vector<Vector3>& returns, bool may_forget,
                                             Batch batch) {
  Added added;
  // A camera's frame has more returns than there may ever be intervals, and needs few of these.
  for (std::size_t i = 0; i < returns.size(); i += kChunk) {
    const Vector3* begin = returns.data() + i;
    const std::size_t count = std::min(kChunk, returns.size() - i);
    if (columns_.room() >= batch.needs(count) && ring_.room() >= count) {
      addChunk(begin, begin + count, may_forget, batch, added);
    } else {
      batch.finish();
      addEach(begin, begin + count, may_forget, added);
    }
  }
  batch.finish();
  return added;
}

/// What there is room for, in steps that each have little to ask.
template <typename Batch>
void IntegrationMap::addChunk(const Vector3* begin, const Vector3* end, bool may_forget,
                              Batch& batch, Added& added) {
  std::array<MappedReturn, kChunk> places;
  std::size_t count = 0, forgotten = 0;
  for (const Vector3* p_fixed = begin; p_fixed != end; ++p_fixed) {
    const auto place = grid_.place(*p_fixed);
    if (!place) continue;
    if (may_forget && forgotten_.contains(*p_fixed)) {
      ++forgotten;
      continue;
    }
    places[count].cell = place->cell;  // one by one: copied as a whole they would wait
    places[count++].height = place->height;
  }
  for (std::size_t i = 0; i < count; ++i) batch.add(places[i].cell, occupiedBy(places[i]));
  for (std::size_t i = 0; i < count; ++i) counts_.add(places[i].cell, places[i].height);
  ring_.add(places.data(), count);
  added.mapped += count;
  added.forgotten += forgotten;
  added.out_of_area += static_cast<std::size_t>(end - begin) - count - forgotten;
}

void IntegrationMap::addEach(const Vector3* begin, const Vector3* end, bool may_forget,
                             Added& added) {
  for (const Vector3* p_fixed = begin; p_fixed != end; ++p_fixed) {
    const auto place = grid_.place(*p_fixed);
    if (!place) {
      ++added.out_of_area;
      continue;
    }
    if (may_forget && forgotten_.contains(*p_fixed)) {
      ++added.forgotten;
      continue;
    }
    const auto [bottom, top] = occupiedBy(*place);
    if (ring_.room() == 0 || !columns_.insert(place->cell, bottom, top, serial_)) {
      overflow_serial_ = serial_;
      continue;
    }
    note(*place);
    ++added.mapped;
  }
}

std::size_t IntegrationMap::forget(const Region& region, Time until) {
  validate(region);
  forgotten_.add(region, until);
  std::vector<RegionPart> parts;
  parts.reserve(region.size());
  for (const PaddedShape& shape : region) {
    markCellsNear(parts.emplace_back(shape, placeDoubt()));
  }
  const std::size_t removed = removeReturns(parts);
  if (removed > 0) restoreColumns();
  std::fill(losses_.begin(), losses_.end(), Loss());
  return removed;
}

double IntegrationMap::placeDoubt() const {
  const Grid::Config& grid = config_.grid;
  return std::hypot(std::sqrt(0.5) * grid.cell_size_m, 0.5 * grid.height_quantum_m) +
         kPlaceRounding;
}

void IntegrationMap::markCellsNear(const RegionPart& part) {
  const Grid::Footprint cells = grid_.footprint(part.bounds());
  for (CellIndex iy = cells.y_begin; iy < cells.y_end; ++iy) {
    for (CellIndex ix = cells.x_begin; ix < cells.x_end; ++ix) {
      losses_[iy * grid_.cellsX() + ix].near = true;
    }
  }
}

std::size_t IntegrationMap::removeReturns(const std::vector<RegionPart>& parts) {
  const std::size_t before = ring_.returns();
  CellIndex last = grid_.cells();
  Vector3 place = Vector3::Zero();
  ring_.keepIf([&](const MappedReturn& entry) {
    Loss& loss = losses_[entry.cell];
    if (!loss.near) return true;
    if (entry.cell != last) place.head<2>() = grid_.centre(entry.cell);
    last = entry.cell;
    place.z() = grid_.metres(entry.height);
    const auto has = [&place](const RegionPart& part) { return part.contains(place); };
    if (std::none_of(parts.begin(), parts.end(), has)) return true;
    counts_.remove(entry.cell, entry.height);
    list_.changed().insert(entry.cell);
    const Columns::Heights lost = occupiedBy(entry);
    loss.heights.bottom = std::min(loss.heights.bottom, lost.bottom);
    loss.heights.top = std::max(loss.heights.top, lost.top);
    return false;
  });
  return before - ring_.returns();
}

/// Only what lies at the heights of lost returns can have a new owner, or none.
void IntegrationMap::restoreColumns() {
  const std::uint32_t nobody = serial_ + 1;
  for (CellIndex cell = 0; cell < grid_.cells(); ++cell) {
    Columns::Heights& lost = losses_[cell].heights;
    if (lost.bottom < lost.top) lost = columns_.disown(cell, lost, nobody);
  }
  ring_.visitNewestFirst([&](const MappedReturn& entry, std::uint32_t serial) {
    const Columns::Heights& lost = losses_[entry.cell].heights;
    const Columns::Heights seen = occupiedBy(entry);
    if (seen.top <= lost.bottom || seen.bottom >= lost.top) return;
    if (!columns_.claim(entry.cell, seen, serial, nobody)) overflow_serial_ = serial_;
  });
  columns_.expire(nobody);
}

void IntegrationMap::clear() {
  columns_.clear();
  counts_.clear();
  ring_.clear();
  forgotten_.clear();
  list_.changed().insertAll();
  overflow_serial_ = 0;
  ++beginnings_;
}

std::uint32_t IntegrationMap::pointsIn(CellIndex cell, Columns::Heights heights) const {
  const Height lowest = lowestReturn(heights.bottom);
  return lowest <= heights.top ? counts_.sum(cell, lowest, heights.top) : 0;
}

std::uint32_t IntegrationMap::pointsAround(CellIndex cell, Columns::Heights heights) const {
  const Height low = grid_.heightFloor(
      std::max(config_.grid.height_min_m, grid_.metres(heights.bottom) - kSupportHeight));
  const Height high = grid_.heightCeil(
      std::min(config_.grid.height_max_m, grid_.metres(heights.top) + kSupportHeight));
  std::uint32_t points = 0;
  grid_.visitAround(cell, [&](CellIndex other) { points += counts_.sum(other, low, high); });
  return points;
}

void IntegrationMap::listLive(CellIndex cell, std::vector<CuboidList::Entry>& entries) const {
  std::uint32_t i = columns_.first(cell);
  while (i != Columns::kNone) {
    const Height bottom = columns_.interval(i).bottom;
    Height top = bottom;
    std::uint32_t age_scans = 0, scans_ago = serial_ - columns_.interval(i).serial;
    // Touching intervals are one cuboid, or the list would depend on how it came about.
    for (; i != Columns::kNone && columns_.interval(i).bottom == top;
         i = columns_.interval(i).next) {
      top = columns_.interval(i).top;
      age_scans = std::max(age_scans, serial_ - columns_.interval(i).born);
      scans_ago = std::min(scans_ago, serial_ - columns_.interval(i).serial);
    }
    entries.emplace_back(cell, false, Columns::Heights{bottom, top}, pointsIn(cell, {bottom, top}),
                         serial_ - age_scans, ring_.stampOf(serial_ - scans_ago));
  }
}

void IntegrationMap::snapshot(CuboidMap& map, HeldLayer* held) {
  map.grid = grid_;
  map.stamp = newest_stamp_;
  map.serial = serial_;
  map.window_scans = static_cast<std::uint32_t>(scans());
  map.overflowed = overflowed();
  map.thickness = thickness_;
  if (held != nullptr) held->takeChanged(list_.changed());
  list_.update([&](CellIndex cell, std::vector<CuboidList::Entry>& entries) {
    const auto begin = static_cast<std::ptrdiff_t>(entries.size());
    listLive(cell, entries);
    if (held == nullptr) return;
    held->visit(cell, cell, [&](const HeldLayer::Interval& i) {
      entries.emplace_back(cell, true, i.heights, i.support, i.born, i.seen);
    });
    std::sort(entries.begin() + begin, entries.end(),
              [](const auto& a, const auto& b) { return a.bottom < b.bottom; });
  });
  list_.write(map, serial_, newest_stamp_);
}

void IntegrationMap::reserve(CuboidMap& map) const {
  map.cuboids.reserve(config_.intervals_max);
  map.cell_begin.reserve(grid_.cells() + 1);
}

}  // namespace tccm
