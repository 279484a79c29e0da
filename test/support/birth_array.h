#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "support/part_union.h"

namespace tccm::test {

/// The age of everything by brute force: for each quantum of each cell, which scan saw it last and
/// since which scan something was seen there. Heights from 0 to heights - 1.
class BirthArray {
 public:
  BirthArray(CellIndex cells, std::size_t heights) : columns_(cells, Column(heights)) {}

  /// All that one scan's returns cover without a gap takes the earliest birth below it.
  void add(const std::vector<MappedReturn>& returns, int thickness, std::uint32_t serial) {
    for (const Run& run : unionOf({returns}, thickness)) {
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
};

}  // namespace tccm::test
