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
  /// These heights of a cell were seen again: they are held no longer.
  /// @return false where the room ran out over it, and less is held than should be.
  [[nodiscard]] bool seen(CellIndex cell, Columns::Heights heights) {
    if (in_cell_[cell] == 0) return true;
    return cut([&](const Interval& i) {
      return i.cell == cell ? heights : Columns::Heights{0, 0};
    });
  }
  /// Takes out of each interval the heights that heightsOf names for it; none: bottom >= top.
  /// @return as seen().
  template <typename HeightsOf>
  [[nodiscard]] bool cut(HeightsOf&& heightsOf);
  /// Lets go of those that isOver says so of.
  template <typename IsOver>
  void releaseIf(IsOver&& isOver) {
    const auto kept = std::remove_if(intervals_.begin(), intervals_.end(), [&](const Interval& i) {
      if (!isOver(i)) return false;
      --in_cell_[i.cell];
      return true;
    });
    intervals_.erase(kept, intervals_.end());
  }
  void clear() {
    intervals_.clear();
    std::fill(in_cell_.begin(), in_cell_.end(), std::uint16_t{0});
  }

  /// By cell, then from low to high, once sort() was called since the last change.
  [[nodiscard]] const std::vector<Interval>& intervals() const { return intervals_; }
  void sort() {
    std::sort(intervals_.begin(), intervals_.end(), [](const Interval& a, const Interval& b) {
      return a.cell != b.cell ? a.cell < b.cell : a.heights.bottom < b.heights.bottom;
    });
  }
  [[nodiscard]] std::size_t memoryBytes() const { return bytesOf(in_cell_, intervals_); }

 private:
  std::vector<std::uint16_t> in_cell_;  ///< how many each cell has
  std::vector<Interval> intervals_;
  std::size_t intervals_max_;
};

template <typename HeightsOf>
bool HeldLayer::cut(HeightsOf&& heightsOf) {
  bool fits = true;
  // Those that are added at the end have been cut already.
  const std::size_t count = intervals_.size();
  for (std::size_t i = 0; i < count; ++i) {
    Interval& held = intervals_[i];
    const Columns::Heights heights = heightsOf(static_cast<const Interval&>(held));
    if (heights.bottom >= heights.top || held.heights.top <= heights.bottom ||
        held.heights.bottom >= heights.top) {
      continue;
    }
    Interval above = held;
    above.heights.bottom = heights.top;
    held.heights.top = std::min(held.heights.top, heights.bottom);
    if (above.heights.bottom >= above.heights.top) continue;
    if (held.heights.bottom >= held.heights.top) {
      held = above;
    } else {
      fits = hold(above) && fits;
    }
  }
  releaseIf([](const Interval& i) { return i.heights.bottom >= i.heights.top; });
  return fits;
}

}  // namespace tccm
