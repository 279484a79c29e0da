#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "support/part_union.h"

namespace tccm::test {

/// The age of everything by brute force: for each quantum of each cell, which scan saw it last and
/// since which scan something was seen there. Heights from the lowest that counts to heights - 1.
class BirthArray {
 public:
  BirthArray(CellIndex cells, std::size_t heights, int lowest)
      : columns_(cells, Column(heights)), lowest_(lowest) {}

  /// All that one scan's returns cover without a gap takes the earliest birth below it.
  void add(const std::vector<MappedReturn>& returns, int thickness, std::uint32_t serial) {
    for (const Run& run : clippedAt(lowest_, unionOf({returns}, thickness))) {
      const auto begin = columns_[run.cell].begin() + run.bottom;
      const auto end = columns_[run.cell].begin() + run.top;
      std::uint32_t born = serial;
      for (auto q = begin; q != end; ++q) born = q->serial > 0 ? std::min(born, q->born) : born;
      std::fill(begin, end, Quantum{serial, born});
    }
  }

  void expire(std::uint32_t serial) {
    for (Column& column : columns_) {
      for (Quantum& quantum : column) {
        if (quantum.serial == serial) quantum = {};
      }
    }
  }

  /// After returns were taken out of the window's part maps: each quantum belongs to the newest
  /// scan that still saw it, and keeps its birth. @param oldest serial of the first part map.
  void reown(const std::deque<std::vector<MappedReturn>>& part_maps, int thickness,
             std::uint32_t oldest) {
    std::vector<Column> before(columns_.size(), Column(columns_.front().size()));
    before.swap(columns_);
    for (const auto& part_map : part_maps) {
      for (const auto& [cell, height] : part_map) {
        const Run run = clippedAt(lowest_, {{cell, height - thickness, height, 1}}).front();
        for (auto h = static_cast<std::size_t>(run.bottom); h < static_cast<std::size_t>(run.top);
             ++h) {
          columns_[cell][h] = {oldest, before[cell][h].born};
        }
      }
      ++oldest;
    }
  }

  /// The earliest birth among the run's quanta; 0 where one of them is empty.
  [[nodiscard]] std::uint32_t born(CellIndex cell, int bottom, int top) const {
    const auto begin = columns_[cell].begin();
    return std::min_element(begin + bottom, begin + top,
                            [](const Quantum& a, const Quantum& b) { return a.born < b.born; })
        ->born;
  }

 private:
  struct Quantum {
    std::uint32_t serial = 0;  ///< 0: empty
    std::uint32_t born = 0;
  };
  using Column = std::vector<Quantum>;

  std::vector<Column> columns_;
  int lowest_;
};

}  // namespace tccm::test
