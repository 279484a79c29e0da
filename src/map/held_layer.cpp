#include "map/held_layer.h"

#include <limits>

namespace tccm {

HeldLayer::HeldLayer(CellIndex cells, std::size_t intervals_max)
    : in_cell_(cells, 0), intervals_max_(intervals_max) {
  intervals_.reserve(intervals_max);
}

bool HeldLayer::hold(const Interval& interval) {
  if (intervals_.size() >= intervals_max_) return false;
  if (in_cell_[interval.cell] == std::numeric_limits<std::uint16_t>::max()) return false;
  ++in_cell_[interval.cell];
  intervals_.push_back(interval);
  return true;
}

bool HeldLayer::seen(CellIndex cell, Columns::Heights heights) {
  if (in_cell_[cell] == 0) return true;
  bool fits = true;
  // Those that are added below lie outside of the heights.
  for (std::size_t i = 0; i < intervals_.size(); ++i) {
    Interval& held = intervals_[i];
    if (held.cell != cell || held.heights.top <= heights.bottom ||
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

void HeldLayer::clear() {
  intervals_.clear();
  std::fill(in_cell_.begin(), in_cell_.end(), std::uint16_t{0});
}

void HeldLayer::sort() {
  std::sort(intervals_.begin(), intervals_.end(), [](const Interval& a, const Interval& b) {
    return a.cell != b.cell ? a.cell < b.cell : a.heights.bottom < b.heights.bottom;
  });
}

std::size_t HeldLayer::memoryBytes() const {
  return in_cell_.capacity() * sizeof(std::uint16_t) + intervals_.capacity() * sizeof(Interval);
}

}  // namespace tccm
