#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
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
  HeldLayer(CellIndex cells, std::size_t intervals_max);

  /// @param interval meets none that is held already. @return false, with nothing changed, where
  /// there is no room.
  [[nodiscard]] bool hold(const Interval& interval);
  /// These heights of a cell were seen again: they are held no longer.
  /// @return false where the room ran out over it, and less is held than should be.
  [[nodiscard]] bool seen(CellIndex cell, Columns::Heights heights);
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
  void clear();

  [[nodiscard]] bool empty() const { return intervals_.empty(); }
  [[nodiscard]] std::size_t size() const { return intervals_.size(); }
  /// By cell, then from low to high, once sort() was called since the last change.
  [[nodiscard]] const std::vector<Interval>& intervals() const { return intervals_; }
  void sort();
  [[nodiscard]] std::size_t memoryBytes() const;

 private:
  std::vector<std::uint16_t> in_cell_;  ///< how many each cell has
  std::vector<Interval> intervals_;
  std::size_t intervals_max_;
};

}  // namespace tccm
