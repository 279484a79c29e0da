#pragma once

#include <cstdint>
#include <vector>

#include "base/bytes_of.h"
#include "tccm_monitor/cuboid_map.h"

namespace tccm {

/// Every cell's occupied heights as sorted disjoint intervals, each owned by the newest scan that
/// saw it. Adding a scan carves older intervals and inserts its own; what the oldest scan alone
/// still owns is then exactly what has to go when it leaves the window. This replaces the paper's
/// msnlist and its deformation of stored part maps (section III.C.2) with the same result.
///
/// Each scan's intervals form a list of their own, so that a scan leaves at the cost of what it
/// still owns. All intervals live in one pool that is allocated once.
class Columns {
 public:
  /// [bottom, top)
  struct Heights {
    Height bottom;
    Height top;
  };
  struct Interval {
    Height bottom;
    Height top;
    std::uint32_t serial;      ///< of the newest scan that saw it
    std::uint32_t born;        ///< serial of the scan from which on something was seen here
    std::uint32_t next;        ///< in the same cell, upwards; kNone at the end
    std::uint32_t previous;    ///< in the same cell, downwards; kNone at the end
    std::uint32_t owned_next;  ///< of the same scan, in a ring with its anchor
    std::uint32_t owned_previous;
    CellIndex cell;

    [[nodiscard]] Heights heights() const { return {bottom, top}; }
  };
  static constexpr std::uint32_t kNone = 0xFFFFFFFFU;

  /// @param scans_max serials in use lie within so many of each other, nobody's included.
  Columns(CellIndex cells, std::size_t intervals_max, std::size_t scans_max);

  /// Makes scan `serial` the owner of [bottom, top); what it overlaps hands over its birth.
  /// @return false, with nothing changed, where the pool may run out.
  [[nodiscard]] bool insert(CellIndex cell, Height bottom, Height top, std::uint32_t serial);
  /// Removes what the scan still owns. @param visit (Interval): is shown each before, in the order
  /// in which the scan came to own them.
  template <typename Visit>
  void expire(std::uint32_t serial, Visit&& visit) {
    const std::uint32_t anchor = anchorOf(serial);
    for (std::uint32_t i = pool_[anchor].owned_next; i != anchor;) {
      visit(static_cast<const Interval&>(pool_[i]));
      unlink(i);
      const std::uint32_t next = pool_[i].owned_next;
      release(i);
      i = next;
    }
    pool_[anchor].owned_next = pool_[anchor].owned_previous = anchor;
  }
  void expire(std::uint32_t serial) {
    expire(serial, [](const Interval&) {});
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
  [[nodiscard]] std::size_t used() const { return used_; }
  [[nodiscard]] std::size_t room() const { return intervals_max_ - used_; }
  [[nodiscard]] std::size_t memoryBytes() const { return bytesOf(first_, pool_); }

 private:
  /// The scan's anchor in the pool.
  [[nodiscard]] std::uint32_t anchorOf(std::uint32_t serial) const {
    return static_cast<std::uint32_t>(intervals_max_) + (serial & scans_mask_);
  }
  /// Into the list of its scan, at the end.
  void joinOwner(std::uint32_t index);
  void leaveOwner(std::uint32_t index);
  /// To another scan's list.
  void give(std::uint32_t index, std::uint32_t serial);
  /// Into the cell's list.
  void link(CellIndex cell, std::uint32_t previous, std::uint32_t index, std::uint32_t next);
  void unlink(std::uint32_t index) {
    const Interval& i = pool_[index];
    (i.previous == kNone ? first_[i.cell] : pool_[i.previous].next) = i.next;
    if (i.next != kNone) pool_[i.next].previous = i.previous;
  }
  /// In both lists.
  void take(const Interval& interval);
  void release(std::uint32_t index) {
    pool_[index].next = free_;
    free_ = index;
    --used_;
  }
  [[nodiscard]] bool split(std::uint32_t index, Height at);
  bool uniteWithNext(std::uint32_t index);

  std::vector<std::uint32_t> first_;
  std::size_t intervals_max_;
  std::uint32_t scans_mask_;
  std::vector<Interval> pool_;  ///< intervals, then the scans' anchors
  std::uint32_t free_ = kNone;
  std::size_t used_ = 0;
};

}  // namespace tccm
