#include "tccm_monitor/map/columns.h"

#include <algorithm>
#include <cassert>

namespace tccm {
namespace {

/// The earlier of two births, as seen from the newest scan: serials may wrap.
std::uint32_t older(std::uint32_t a, std::uint32_t b, std::uint32_t newest) {
  return newest - a > newest - b ? a : b;
}

}  // namespace

Columns::Columns(CellIndex cells, std::size_t intervals_max)
    : first_(cells, kNone), pool_(intervals_max) {
  clear();
}

void Columns::clear() {
  std::fill(first_.begin(), first_.end(), kNone);
  const auto size = static_cast<std::uint32_t>(pool_.size());
  for (std::uint32_t i = 0; i < size; ++i) pool_[i].next = i + 1 < size ? i + 1 : kNone;
  free_ = size > 0 ? 0 : kNone;
  used_ = 0;
}

std::uint32_t Columns::take(const Interval& interval) {
  assert(free_ != kNone);
  const std::uint32_t index = free_;
  free_ = pool_[index].next;
  pool_[index] = interval;
  ++used_;
  return index;
}

bool Columns::insert(CellIndex cell, Height bottom, Height top, std::uint32_t serial) {
  assert(bottom < top);
  // One interval of its own, and one more where it splits another in two.
  if (used_ + 2 > pool_.size()) return false;
  Interval added{bottom, top, serial, serial, kNone};
  std::uint32_t* link = &first_[cell];
  while (*link != kNone && pool_[*link].top < bottom) link = &pool_[*link].next;
  std::uint32_t reused = kNone;
  while (*link != kNone && pool_[*link].bottom <= top) {
    Interval& other = pool_[*link];
    // Beams side by side see the same surface: most returns change nothing.
    if (other.serial == serial && other.bottom <= bottom && other.top >= top) return true;
    const bool overlaps = other.bottom < top && other.top > bottom;
    if (overlaps) added.born = older(added.born, other.born, serial);
    if (other.serial == serial) {  // the scan's own: one interval, also where they only touch
      added.bottom = std::min(added.bottom, other.bottom);
      added.top = std::max(added.top, other.top);
      added.born = older(added.born, other.born, serial);
    } else if (!overlaps && other.top <= bottom) {  // touches from below
      link = &other.next;
      continue;
    } else if (!overlaps) {  // touches from above
      break;
    } else if (other.bottom < bottom && other.top > top) {
      const Interval above{top, other.top, other.serial, other.born, other.next};
      other.top = bottom;
      added.next = take(above);
      other.next = take(added);  // `other` stays valid: the pool never grows
      return true;
    } else if (other.bottom < bottom) {
      other.top = bottom;
      link = &other.next;
      continue;
    } else if (other.top > top) {
      other.bottom = top;
      break;
    }
    const std::uint32_t covered = *link;
    *link = other.next;
    if (reused == kNone) {
      reused = covered;
    } else {
      release(covered);
    }
  }
  added.next = *link;
  if (reused == kNone) {
    *link = take(added);
  } else {
    pool_[reused] = added;
    *link = reused;
  }
  return true;
}

bool Columns::split(std::uint32_t index, Height at) {
  if (free_ == kNone) return false;
  Interval above = pool_[index];
  above.bottom = at;
  pool_[index].top = at;
  pool_[index].next = take(above);
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
  interval.next = other.next;
  release(above);
  return true;
}

Columns::Heights Columns::disown(CellIndex cell, Heights heights, std::uint32_t nobody) {
  Heights disowned = heights;
  for (std::uint32_t i = first_[cell]; i != kNone && pool_[i].bottom < heights.top;
       i = pool_[i].next) {
    if (pool_[i].top <= heights.bottom) continue;
    pool_[i].serial = nobody;
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
    pool_[i].serial = serial;
    // A scan's returns side by side claim one interval, not one each: the pool is bounded.
    uniteWithNext(i);
    if (below != kNone && uniteWithNext(below)) i = below;
    below = i;
  }
  return exact;
}

std::size_t Columns::memoryBytes() const {
  return first_.capacity() * sizeof(std::uint32_t) + pool_.capacity() * sizeof(Interval);
}

}  // namespace tccm
