#include "map/return_counts.h"

#include <algorithm>
#include <cassert>

namespace tccm {

ReturnCounts::ReturnCounts(const Grid& grid, Height layer)
    : lowest_(grid.heightFloor(grid.config().height_min_m)), layer_(layer) {
  assert(layer >= 1);
  const int heights = grid.heightCeil(grid.config().height_max_m) - lowest_ + 1;
  layer_of_.resize(static_cast<std::size_t>(heights));
  for (int i = 0; i < heights; ++i) {
    layer_of_[static_cast<std::size_t>(i)] = static_cast<std::uint16_t>(i / layer);
  }
  layers_ = layer_of_.back() + std::size_t{1};
  counts_.resize(grid.cells() * layers_, 0);
}

void ReturnCounts::clear() { std::fill(counts_.begin(), counts_.end(), 0U); }

std::uint32_t ReturnCounts::sum(CellIndex cell, Height low, Height high) const {
  std::uint32_t total = 0;
  const std::size_t last = index(cell, high);
  for (std::size_t i = index(cell, low); i <= last; ++i) total += counts_[i];
  return total;
}

std::size_t ReturnCounts::memoryBytes() const {
  return counts_.capacity() * sizeof(counts_.front()) +
         layer_of_.capacity() * sizeof(layer_of_.front());
}

}  // namespace tccm
