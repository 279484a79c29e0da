#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "map/columns.h"
#include "tccm_monitor/time.h"

namespace tccm {

/// What left the window while nobody looked at its place: where the robot's own arm hides an
/// object, nothing says that the object has gone. A layer of its own beside the live map; the two
/// never overlap.
class HeldLayer {
 public:
  struct Interval {
    CellIndex cell = 0;
    Columns::Heights heights{0, 0};
    std::uint32_t points = 1;   ///< returns that were in it
    std::uint32_t support = 1;  ///< those around it too, while it was in the window
    std::uint32_t serial = 0;   ///< of the last scan that saw it
    std::uint32_t born = 0;
    Time seen;   ///< stamp of that scan
    Time since;  ///< when it left the window
  };

  /// Allocates all that it will ever use.
  HeldLayer(CellIndex cells, std::size_t intervals_max)
      : in_cell_(cells, 0), intervals_max_(intervals_max) {
    intervals_.reserve(intervals_max);
  }

  /// @param interval meets none that is held already. @return false, with nothing changed, where
  /// there is no room.
  [[nodiscard]] bool hold(const Interval& interval) {
    std::uint16_t& in_cell = in_cell_[interval.cell];
    if (intervals_.size() >= intervals_max_) return false;
    if (in_cell == std::numeric_limits<std::uint16_t>::max()) return false;
    ++in_cell;
    intervals_.push_back(interval);
    return true;
  }
  /// These heights of a cell were seen again: they are held no longer. What is empty then goes with
  /// the next releaseIf() or sort().
  /// @return false where the room ran out over it, and less is held than should be.
  [[nodiscard]] bool seen(CellIndex cell, Columns::Heights heights);
  /// Takes out of each interval the heights that heightsOf names for it; none: bottom >= top.
  /// @return as seen().
  template <typename HeightsOf>
  [[nodiscard]] bool cut(HeightsOf&& heightsOf);
  /// Lets go of those that isOver says so of, and of those that are empty.
  template <typename IsOver>
  void releaseIf(IsOver&& isOver);
  void clear() {
    intervals_.clear();
    std::fill(in_cell_.begin(), in_cell_.end(), std::uint16_t{0});
    sorted_ = 0;
  }

  /// @param visit (Interval): is shown those of the cells from `first` to `last`.
  template <typename Visit>
  void visit(CellIndex first, CellIndex last, Visit&& visit) const;
  /// By cell, then from low to high, once sort() was called since the last change.
  [[nodiscard]] const std::vector<Interval>& intervals() const { return intervals_; }
  void sort() {
    releaseIf([](const Interval&) { return false; });
    std::sort(intervals_.begin(), intervals_.end(), [](const Interval& a, const Interval& b) {
      return a.cell != b.cell ? a.cell < b.cell : a.heights.bottom < b.heights.bottom;
    });
    sorted_ = intervals_.size();
  }
  [[nodiscard]] std::size_t memoryBytes() const { return bytesOf(in_cell_, intervals_); }

 private:
  static bool isEmpty(const Interval& i) { return i.heights.bottom >= i.heights.top; }
  /// The first in order whose cell is not below that one.
  [[nodiscard]] std::size_t firstFrom(CellIndex cell) const {
    const auto end = intervals_.begin() + static_cast<std::ptrdiff_t>(sorted_);
    return static_cast<std::size_t>(
        std::lower_bound(intervals_.begin(), end, cell,
                         [](const Interval& i, CellIndex c) { return i.cell < c; }) -
        intervals_.begin());
  }
  [[nodiscard]] bool cut(Interval& held, Columns::Heights heights);

  std::vector<std::uint16_t> in_cell_;  ///< how many each cell has
  std::vector<Interval> intervals_;
  std::size_t sorted_ = 0;  ///< so many of them are in order, from the first
  std::size_t intervals_max_;
};

/// Takes the heights out of one.
inline bool HeldLayer::cut(Interval& held, Columns::Heights heights) {
  if (heights.bottom >= heights.top || held.heights.top <= heights.bottom ||
      held.heights.bottom >= heights.top) {
    return true;
  }
  Interval above = held;
  above.heights.bottom = heights.top;
  held.heights.top = std::min(held.heights.top, heights.bottom);
  if (isEmpty(above)) return true;
  if (!isEmpty(held)) return hold(above);
  held = above;
  return true;
}

inline bool HeldLayer::seen(CellIndex cell, Columns::Heights heights) {
  if (in_cell_[cell] == 0) return true;
  if (intervals_.size() == intervals_max_) releaseIf([](const Interval&) { return false; });
  bool fits = true;
  for (std::size_t i = firstFrom(cell); i < sorted_ && intervals_[i].cell == cell; ++i) {
    fits = cut(intervals_[i], heights) && fits;
  }
  for (std::size_t i = sorted_; i < intervals_.size(); ++i) {
    if (intervals_[i].cell == cell) fits = cut(intervals_[i], heights) && fits;
  }
  return fits;
}

template <typename HeightsOf>
bool HeldLayer::cut(HeightsOf&& heightsOf) {
  bool fits = true;
  // Those that are added at the end have been cut already.
  const std::size_t count = intervals_.size();
  for (std::size_t i = 0; i < count; ++i) {
    const Columns::Heights heights = heightsOf(static_cast<const Interval&>(intervals_[i]));
    fits = cut(intervals_[i], heights) && fits;
  }
  releaseIf([](const Interval&) { return false; });
  return fits;
}

template <typename IsOver>
void HeldLayer::releaseIf(IsOver&& isOver) {
  std::size_t kept = 0, sorted = 0;
  for (std::size_t i = 0; i < intervals_.size(); ++i) {
    const Interval& interval = intervals_[i];
    if (isEmpty(interval) || isOver(interval)) {
      --in_cell_[interval.cell];
      continue;
    }
    if (i < sorted_) ++sorted;
    intervals_[kept++] = interval;
  }
  intervals_.resize(kept);
  sorted_ = sorted;
}

template <typename Visit>
void HeldLayer::visit(CellIndex first, CellIndex last, Visit&& visit) const {
  for (std::size_t i = firstFrom(first); i < sorted_ && intervals_[i].cell <= last; ++i) {
    visit(intervals_[i]);
  }
  for (std::size_t i = sorted_; i < intervals_.size(); ++i) {
    if (intervals_[i].cell >= first && intervals_[i].cell <= last) visit(intervals_[i]);
  }
}

}  // namespace tccm
