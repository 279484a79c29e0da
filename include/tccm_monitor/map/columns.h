#pragma once

#include <cstdint>
#include <vector>

#include "tccm_monitor/map/grid.h"

namespace tccm {

/// Every cell's occupied heights as sorted disjoint intervals, each owned by the newest scan that
/// saw it. Adding a scan carves older intervals and inserts its own; what the oldest scan alone
/// still owns is then exactly what has to go when it leaves the window. This replaces the paper's
/// msnlist and its deformation of stored part maps (section III.C.2) with the same result.
///
/// All intervals live in one pool that is allocated once.
class Columns {
 public:
  struct Interval {
    Height bottom;
    Height top;
    std::uint32_t serial;  ///< of the newest scan that saw it
    std::uint32_t born;    ///< serial of the scan from which on something was seen here
    std::uint32_t next;    ///< in the same cell, upwards; kNone at the end
  };
  /// [bottom, top)
  struct Heights {
    Height bottom;
    Height top;
  };
  static constexpr std::uint32_t kNone = 0xFFFFFFFFU;

  Columns(CellIndex cells, std::size_t intervals_max);

  /// Makes scan `serial` the owner of [bottom, top); what it overlaps hands over its birth.
  /// @return false, with nothing changed, where the pool may run out.
  [[nodiscard]] bool insert(CellIndex cell, Height bottom, Height top, std::uint32_t serial);
  /// Removes what the scan still owns in the cell. @param visit (Interval): is shown each before.
  template <typename Visit>
  void expire(CellIndex cell, std::uint32_t serial, Visit&& visit);
  void expire(CellIndex cell, std::uint32_t serial) {
    expire(cell, serial, [](const Interval&) {});
  }
  /// Makes `nobody`, a serial that no scan of the window has, the owner of the intervals that meet
  /// the heights. What remaining scans saw there is then to be claimed, newest scan first; the rest
  /// expires as nobody's.
  /// @return the heights from the lowest of these intervals to the highest, both included.
  [[nodiscard]] Heights disown(CellIndex cell, Heights heights, std::uint32_t nobody);
  /// Gives scan `serial` what `nobody` owns of the heights. Births stay as they are.
  /// @return false where the pool ran out, and more than these heights had to be given.
  [[nodiscard]] bool claim(CellIndex cell, Heights heights, std::uint32_t serial,
                           std::uint32_t nobody);
  void clear();

  /// The cell's lowest interval, or kNone.
  [[nodiscard]] std::uint32_t first(CellIndex cell) const { return first_[cell]; }
  [[nodiscard]] const Interval& interval(std::uint32_t index) const { return pool_[index]; }
  [[nodiscard]] CellIndex cells() const { return static_cast<CellIndex>(first_.size()); }
  [[nodiscard]] std::size_t used() const { return used_; }
  [[nodiscard]] std::size_t room() const { return pool_.size() - used_; }
  [[nodiscard]] std::size_t memoryBytes() const;

 private:
  std::uint32_t take(const Interval& interval);
  void release(std::uint32_t index);
  [[nodiscard]] bool split(std::uint32_t index, Height at);
  bool uniteWithNext(std::uint32_t index);

  std::vector<std::uint32_t> first_;
  std::vector<Interval> pool_;
  std::uint32_t free_ = kNone;
  std::size_t used_ = 0;
};

inline void Columns::release(std::uint32_t index) {
  pool_[index].next = free_;
  free_ = index;
  --used_;
}

template <typename Visit>
void Columns::expire(CellIndex cell, std::uint32_t serial, Visit&& visit) {
  std::uint32_t* link = &first_[cell];
  while (*link != kNone) {
    const std::uint32_t index = *link;
    Interval& interval = pool_[index];
    if (interval.serial != serial) {
      link = &interval.next;
      continue;
    }
    visit(static_cast<const Interval&>(interval));
    *link = interval.next;
    release(index);
  }
}

}  // namespace tccm
