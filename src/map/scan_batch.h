#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "map/columns.h"

namespace tccm {

/// Puts together what a scan's returns occupy before it goes into the columns. Beams side by side
/// fall into a few cells in turn, and mostly see the same surface: most of them only widen what is
/// gathered already. The columns become what they would return by return.
class ScanBatch {
 public:
  /// @pre the columns have room for two intervals a return. @param serial of the scan, the newest.
  ScanBatch(Columns& columns, std::uint32_t serial) : columns_(columns), serial_(serial) {}

  void add(CellIndex cell, Columns::Heights heights) {
    for (Gathered& gathered : gathered_) {
      const bool touches = gathered.cell == cell && heights.bottom <= gathered.heights.top &&
                           heights.top >= gathered.heights.bottom;
      if (!touches) continue;
      if (heights.bottom < gathered.heights.bottom) gathered.heights.bottom = heights.bottom;
      if (heights.top > gathered.heights.top) gathered.heights.top = heights.top;
      return;
    }
    insert(gathered_[next_]);
    gathered_[next_] = {cell, heights};
    next_ = (next_ + 1) % gathered_.size();
  }
  /// What is gathered still. To be called at the end.
  void finish() {
    for (const Gathered& gathered : gathered_) insert(gathered);
  }

 private:
  struct Gathered {
    CellIndex cell = std::numeric_limits<CellIndex>::max();  ///< none
    Columns::Heights heights = {0, 0};
  };
  void insert(const Gathered& gathered) {
    const auto [bottom, top] = gathered.heights;
    if (bottom < top) static_cast<void>(columns_.insert(gathered.cell, bottom, top, serial_));
  }

  Columns& columns_;
  std::uint32_t serial_;
  std::array<Gathered, 4> gathered_ = {};
  std::size_t next_ = 0;
};

}  // namespace tccm
