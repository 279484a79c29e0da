#include "map/columns.h"

#include <algorithm>
#include <cassert>

namespace tccm {
namespace {

/// The earlier of two births, as seen from the newest scan: serials may wrap.
std::uint32_t older(std::uint32_t a, std::uint32_t b, std::uint32_t newest) {
  return newest - a > newest - b ? a : b;
}

/// So that slots of serials stay apart when these wrap.
std::uint32_t powerOfTwo(std::size_t at_least) {
  std::uint32_t power = 1;
  while (power < at_least) power *= 2;
  return power;
}

}  // namespace

Columns::Columns(CellIndex cells, std::size_t intervals_max, std::size_t scans_max)
    : first_(cells, kNone),
      intervals_max_(intervals_max),
      scans_mask_(powerOfTwo(scans_max) - 1),
      pool_(intervals_max + scans_mask_ + 1) {
  clear();
}

void Columns::clear() {
  std::fill(first_.begin(), first_.end(), kNone);
  const auto size = static_cast<std::uint32_t>(intervals_max_);
  for (std::uint32_t i = 0; i < size; ++i) pool_[i].next = i + 1 < size ? i + 1 : kNone;
  for (std::uint32_t i = size; i < pool_.size(); ++i) {
    pool_[i].owned_next = pool_[i].owned_previous = i;
  }
  free_ = size > 0 ? 0 : kNone;
  used_ = 0;
}

void Columns::joinOwner(std::uint32_t index) {
  Interval& interval = pool_[index];
  const std::uint32_t anchor = anchorOf(interval.serial);
  const std::uint32_t last = pool_[anchor].owned_previous;
  interval.owned_previous = last;
  interval.owned_next = anchor;
  pool_[last].owned_next = index;
  pool_[anchor].owned_previous = index;
}

void Columns::leaveOwner(std::uint32_t index) {
  const Interval& interval = pool_[index];
  pool_[interval.owned_previous].owned_next = interval.owned_next;
  pool_[interval.owned_next].owned_previous = interval.owned_previous;
}

void Columns::link(CellIndex cell, std::uint32_t previous, std::uint32_t index,
                   std::uint32_t next) {
  (previous == kNone ? first_[cell] : pool_[previous].next) = index;
  if (next != kNone) pool_[next].previous = index;
  pool_[index].previous = previous;
  pool_[index].next = next;
}

void Columns::take(const Interval& interval) {
  assert(free_ != kNone);
  const std::uint32_t index = free_;
  free_ = pool_[index].next;
  pool_[index] = interval;
  joinOwner(index);
  link(interval.cell, interval.previous, index, interval.next);
  ++used_;
}

bool Columns::insert(CellIndex cell, Height bottom, Height top, std::uint32_t serial) {
  assert(bottom < top);
  // One interval of its own, and one more where it splits another in two.
  if (used_ + 2 > intervals_max_) return false;
  Interval added{bottom, top, serial, serial, first_[cell], kNone, kNone, kNone, cell};
  std::uint32_t next = added.next;
  while (next != kNone && pool_[next].top < bottom) {
    added.previous = next;
    next = pool_[next].next;
  }
  while (next != kNone && pool_[next].bottom <= top) {
    const std::uint32_t index = next;
    Interval& other = pool_[index];  // stays valid: the pool never grows
    const bool is_own = other.serial == serial;
    // Beams side by side see the same surface: most returns change nothing.
    if (is_own && other.bottom <= bottom && other.top >= top) return true;
    const bool overlaps = other.bottom < top && other.top > bottom;
    if (is_own || overlaps) added.born = older(added.born, other.born, serial);
    if (is_own) {  // one interval, also where they only touch
      added.bottom = std::min(added.bottom, other.bottom);
      added.top = std::max(added.top, other.top);
    } else if (other.bottom < bottom) {
      if (other.top > top) static_cast<void>(split(index, top));
      other.top = bottom;
      added.previous = index;
      next = other.next;
      continue;
    } else if (other.top > top) {
      other.bottom = top;
      break;
    }
    next = other.next;
    leaveOwner(index);
    release(index);
  }
  added.next = next;
  take(added);
  return true;
}

void Columns::give(std::uint32_t index, std::uint32_t serial) {
  leaveOwner(index);
  pool_[index].serial = serial;
  joinOwner(index);
}

bool Columns::split(std::uint32_t index, Height at) {
  if (free_ == kNone) return false;
  Interval above = pool_[index];
  above.bottom = at;
  above.previous = index;
  pool_[index].top = at;
  take(above);
  return true;
}

bool Columns::uniteWithNext(std::uint32_t index) {
  Interval& interval = pool_[index];
  const std::uint32_t above = interval.next;
  if (above == kNone) return false;
  const Interval& other = pool_[above];
  const bool alike = other.serial == interval.serial && other.born == interval.born;
  if (!alike || other.bottom != interval.top) return false;
  interval.top = other.top;
  unlink(above);
  leaveOwner(above);
  release(above);
  return true;
}

Columns::Heights Columns::disown(CellIndex cell, Heights heights, std::uint32_t nobody) {
  Heights disowned = heights;
  for (std::uint32_t i = first_[cell]; i != kNone && pool_[i].bottom < heights.top;
       i = pool_[i].next) {
    if (pool_[i].top <= heights.bottom) continue;
    give(i, nobody);
    disowned.bottom = std::min(disowned.bottom, pool_[i].bottom);
    disowned.top = std::max(disowned.top, pool_[i].top);
  }
  return disowned;
}

bool Columns::claim(CellIndex cell, Heights heights, std::uint32_t serial, std::uint32_t nobody) {
  bool exact = true;
  std::uint32_t below = kNone;
  for (std::uint32_t i = first_[cell]; i != kNone && pool_[i].bottom < heights.top;
       i = pool_[i].next) {
    if (pool_[i].serial != nobody || pool_[i].top <= heights.bottom) {
      below = i;
      continue;
    }
    if (pool_[i].bottom < heights.bottom) {
      if (split(i, heights.bottom)) {
        below = i;
        i = pool_[i].next;
      } else {
        exact = false;
      }
    }
    if (pool_[i].top > heights.top && !split(i, heights.top)) exact = false;
    give(i, serial);
    // A scan's returns side by side claim one interval, not one each: the pool is bounded.
    uniteWithNext(i);
    if (below != kNone && uniteWithNext(below)) i = below;
    below = i;
  }
  return exact;
}

}  // namespace tccm
