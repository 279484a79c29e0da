#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "base/bytes_of.h"
#include "base/index_set.h"
#include "map/columns.h"
#include "tccm_monitor/cuboid_map.h"
#include "tccm_monitor/time.h"

namespace tccm {

/// A map's cuboids as its snapshots list them. It is kept from one snapshot to the next: cells that
/// have not changed since are not gone through again, and of their cuboids only the ages are new.
class CuboidList {
 public:
  /// As in Cuboid, in its order: they are copied together.
  struct Entry {
    Entry(CellIndex the_cell, bool is_held, Columns::Heights heights, std::uint32_t the_points,
          std::uint32_t born_at, Time seen_at)
        : cell(the_cell),
          bottom(heights.bottom),
          top(heights.top),
          points(the_points),
          born(born_at),
          held(is_held),
          seen(seen_at) {}
    CellIndex cell;
    Height bottom;
    Height top;
    std::uint32_t points;
    std::uint32_t born;     ///< serial of the scan from which on something was seen here
    std::uint32_t dyn = 0;  ///< as it was told last
    bool held;
    Time seen;  ///< last
  };

  /// Allocates all that it will ever use.
  CuboidList(CellIndex cells, std::size_t entries_max)
      : begin_(cells + 1, 0), changed_(cells), untold_(cells) {
    entries_.reserve(entries_max);
    next_.reserve(entries_max);
  }

  /// The cells that have changed since update().
  [[nodiscard]] IndexSet& changed() { return changed_; }
  /// @param list (CellIndex, std::vector<Entry>&): adds a cell's entries, from low to high.
  template <typename List>
  void update(List&& list);
  /// Writes the map's cuboids, but for what others tell of them, and their index.
  /// @param serial, @param now of the newest scan.
  void write(CuboidMap& map, std::uint32_t serial, Time now) const;
  /// Of the cuboids in cells that were listed anew since this was last called, and in others, dyn
  /// becomes what dynOf (Cuboid) says; all others keep theirs. @param map as written last.
  template <typename DynOf>
  void tellDyn(const IndexSet& others, CuboidMap& map, DynOf&& dynOf);
  [[nodiscard]] std::size_t memoryBytes() const {
    return bytesOf(entries_, next_) + bytesOf(begin_) + changed_.memoryBytes() +
           untold_.memoryBytes();
  }

 private:
  void carryOver(CellIndex from, CellIndex to);

  std::vector<Entry> entries_;        ///< by cell, then from low to high
  std::vector<Entry> next_;           ///< those after an update
  std::vector<std::uint32_t> begin_;  ///< as CuboidMap::cell_begin
  IndexSet changed_;
  IndexSet untold_;  ///< cells that were listed since tellDyn()
};

template <typename List>
void CuboidList::update(List&& list) {
  if (changed_.empty()) return;
  next_.clear();
  CellIndex from = 0;
  changed_.visit([&](std::size_t changed) {
    const auto cell = static_cast<CellIndex>(changed);
    carryOver(from, cell);
    begin_[cell] = static_cast<std::uint32_t>(next_.size());
    list(cell, next_);
    from = cell + 1;
  });
  const auto cells = static_cast<CellIndex>(begin_.size() - 1);
  carryOver(from, cells);
  begin_[cells] = static_cast<std::uint32_t>(next_.size());
  std::swap(entries_, next_);
  untold_.insert(changed_);
  changed_.clear();
}

template <typename DynOf>
void CuboidList::tellDyn(const IndexSet& others, CuboidMap& map, DynOf&& dynOf) {
  untold_.insert(others);
  untold_.visit([&](std::size_t cell) {
    for (std::uint32_t i = begin_[cell]; i < begin_[cell + 1]; ++i) {
      Cuboid& cuboid = map.cuboids[i];
      entries_[i].dyn = cuboid.dyn = dynOf(static_cast<const Cuboid&>(cuboid));
    }
  });
  untold_.clear();
}

/// The cells from one up to, but not including, another.
inline void CuboidList::carryOver(CellIndex from, CellIndex to) {
  const std::uint32_t begin = begin_[from], end = begin_[to];
  const auto shift = static_cast<std::uint32_t>(next_.size()) - begin;  // may wrap
  next_.insert(next_.end(), entries_.begin() + begin, entries_.begin() + end);
  if (shift == 0) return;
  for (CellIndex cell = from; cell < to; ++cell) begin_[cell] += shift;
}

inline void CuboidList::write(CuboidMap& map, std::uint32_t serial, Time now) const {
  constexpr std::int64_t kMost = std::numeric_limits<std::uint32_t>::max();
  map.cuboids.resize(entries_.size());
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    const Entry& entry = entries_[i];
    const std::int64_t unseen_ms = (now - entry.seen) / std::chrono::milliseconds(1);
    Cuboid& cuboid = map.cuboids[i];
    cuboid.cell = entry.cell;
    cuboid.bottom = entry.bottom;
    cuboid.top = entry.top;
    cuboid.points = entry.points;
    cuboid.dyn = entry.dyn;
    cuboid.held = entry.held;
    cuboid.appeared = false;
    cuboid.age_scans = serial - entry.born;
    cuboid.unseen_ms = static_cast<std::uint32_t>(std::clamp<std::int64_t>(unseen_ms, 0, kMost));
  }
  map.cell_begin = begin_;
}

}  // namespace tccm
