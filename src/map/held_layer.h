#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "base/bytes_of.h"
#include "base/index_set.h"
#include "map/columns.h"
#include "tccm_monitor/time.h"

namespace tccm {

/// What is looked at with each scan of all that is held, kept apart from the rest.
struct Glance {
  [[nodiscard]] bool isKnown() const { return place.x() == place.x(); }
  /// NaN where nothing is known.
  Eigen::Vector3f place = Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN());
  float range = 0.0F;
  std::uint32_t direction = 0;
  std::uint32_t since_ms = 0;
};

/// Many of them, each member in a row of its own: several are compared at once.
class Glances {
 public:
  void reserve(std::size_t count) {
    for (auto* floats : {&x_, &y_, &z_, &range_}) floats->reserve(count);
    for (auto* numbers : {&direction_, &since_ms_}) numbers->reserve(count);
  }
  [[nodiscard]] Glance get(std::size_t i) const {
    return {{x_[i], y_[i], z_[i]}, range_[i], direction_[i], since_ms_[i]};
  }
  void set(std::size_t i, const Glance& glance) {
    x_[i] = glance.place.x();
    y_[i] = glance.place.y();
    z_[i] = glance.place.z();
    range_[i] = glance.range;
    direction_[i] = glance.direction;
    since_ms_[i] = glance.since_ms;
  }
  /// Adds one of which nothing is known.
  void add() {
    resize(x_.size() + 1);
    set(x_.size() - 1, Glance());
  }
  void dropLast() { resize(x_.size() - 1); }

  [[nodiscard]] const float* x() const { return x_.data(); }
  [[nodiscard]] const float* y() const { return y_.data(); }
  [[nodiscard]] const float* z() const { return z_.data(); }
  [[nodiscard]] const std::uint32_t* directions() const { return direction_.data(); }
  [[nodiscard]] const std::uint32_t* sinceMs() const { return since_ms_.data(); }
  [[nodiscard]] std::size_t memoryBytes() const {
    return bytesOf(x_, y_, z_, range_) + bytesOf(direction_, since_ms_);
  }

 private:
  void resize(std::size_t count) {
    for (auto* floats : {&x_, &y_, &z_, &range_}) floats->resize(count);
    for (auto* numbers : {&direction_, &since_ms_}) numbers->resize(count);
  }

  std::vector<float> x_, y_, z_, range_;
  std::vector<std::uint32_t> direction_, since_ms_;
};

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
      : first_(cells, kNone), changed_(cells), intervals_max_(intervals_max) {
    intervals_.reserve(intervals_max);
    glances_.reserve(intervals_max);
    links_.reserve(intervals_max);
  }

  /// @param interval meets none that is held already. @return false, with nothing changed, where
  /// there is no room.
  [[nodiscard]] bool hold(const Interval& interval);
  /// These heights of a cell were seen again: they are held no longer.
  /// @return false where the room ran out over it, and less is held than should be.
  [[nodiscard]] bool seen(CellIndex cell, Columns::Heights heights);
  /// Takes out of each interval the heights that heightsOf names for it; none: bottom >= top.
  /// @return as seen().
  template <typename HeightsOf>
  [[nodiscard]] bool cut(HeightsOf&& heightsOf);
  static constexpr std::size_t kBlock = 64;
  /// Lets go of those that isOver (const Interval&, Glance&) says so of. It may write the glance;
  /// where an interval is new, or its heights have changed, nothing is known of it.
  /// @param mayBeOver (const Glances&, begin, end): which ones of up to kBlock have to be asked
  /// about, the first one's bit the lowest. All are looked at with each scan: it has to be quick.
  template <typename MayBeOver, typename IsOver>
  void releaseIf(MayBeOver&& mayBeOver, IsOver&& isOver);
  void clear() {
    while (!intervals_.empty()) remove(intervals_.size() - 1);
  }

  /// @param visit (Interval): is shown those of the cells from `first` to `last`, by cell, then
  /// from low to high.
  template <typename Visit>
  void visit(CellIndex first, CellIndex last, Visit&& visit) const {
    for (CellIndex cell = first; cell <= last; ++cell) {
      for (std::uint32_t i = first_[cell]; i != kNone; i = links_[i].next) visit(intervals_[i]);
    }
  }
  /// In no order.
  [[nodiscard]] const std::vector<Interval>& intervals() const { return intervals_; }
  /// Adds the cells where what is held has changed since this was last called.
  void takeChanged(IndexSet& cells) {
    if (changed_.empty()) return;
    cells.insert(changed_);
    changed_.clear();
  }
  [[nodiscard]] std::size_t memoryBytes() const {
    return bytesOf(first_, intervals_) + glances_.memoryBytes() + bytesOf(links_) +
           changed_.memoryBytes();
  }

 private:
  static constexpr std::uint32_t kNone = 0xFFFFFFFFU;
  /// Of a cell's intervals, from low to high.
  struct Link {
    std::uint32_t previous = kNone;
    std::uint32_t next = kNone;
  };
  [[nodiscard]] std::uint32_t& linkTo(std::uint32_t next_of, CellIndex cell) {
    return next_of == kNone ? first_[cell] : links_[next_of].next;
  }
  [[nodiscard]] bool cut(std::size_t index, Columns::Heights heights);
  void remove(std::size_t index);

  std::vector<std::uint32_t> first_;  ///< by cell: its lowest, or kNone
  std::vector<Interval> intervals_;   ///< without gaps: the last one fills what is left
  Glances glances_;                   ///< of the same, here and below
  std::vector<Link> links_;
  IndexSet changed_;
  std::size_t intervals_max_;
};

inline bool HeldLayer::hold(const Interval& interval) {
  if (intervals_.size() >= intervals_max_) return false;
  Link link{kNone, first_[interval.cell]};
  while (link.next != kNone && intervals_[link.next].heights.bottom < interval.heights.bottom) {
    link = {link.next, links_[link.next].next};
  }
  const auto index = static_cast<std::uint32_t>(intervals_.size());
  linkTo(link.previous, interval.cell) = index;
  if (link.next != kNone) links_[link.next].previous = index;
  links_.push_back(link);
  intervals_.push_back(interval);
  glances_.add();
  changed_.insert(interval.cell);
  return true;
}

inline void HeldLayer::remove(std::size_t index) {
  const CellIndex cell = intervals_[index].cell;
  const Link link = links_[index];
  linkTo(link.previous, cell) = link.next;
  if (link.next != kNone) links_[link.next].previous = link.previous;
  changed_.insert(cell);
  const std::size_t last = intervals_.size() - 1;
  if (index != last) {
    intervals_[index] = intervals_[last];
    glances_.set(index, glances_.get(last));
    links_[index] = links_[last];
    const auto moved = static_cast<std::uint32_t>(index);
    linkTo(links_[index].previous, intervals_[index].cell) = moved;
    if (links_[index].next != kNone) links_[links_[index].next].previous = moved;
  }
  intervals_.pop_back();
  glances_.dropLast();
  links_.pop_back();
}

/// Takes the heights out of one.
inline bool HeldLayer::cut(std::size_t index, Columns::Heights heights) {
  Interval& held = intervals_[index];
  const auto [bottom, top] = held.heights;
  if (heights.bottom >= heights.top || top <= heights.bottom || bottom >= heights.top) return true;
  if (heights.bottom <= bottom && heights.top >= top) {
    remove(index);
    return true;
  }
  changed_.insert(held.cell);
  glances_.set(index, Glance());
  if (heights.bottom <= bottom) {
    held.heights.bottom = heights.top;
    return true;
  }
  held.heights.top = heights.bottom;
  if (heights.top >= top) return true;
  Interval above = held;
  above.heights = {heights.top, top};
  return hold(above);
}

inline bool HeldLayer::seen(CellIndex cell, Columns::Heights heights) {
  bool fits = true;
  for (std::uint32_t i = first_[cell]; i != kNone && intervals_[i].heights.bottom < heights.top;) {
    const std::uint32_t next = links_[i].next;
    const std::size_t before = intervals_.size();
    fits = cut(i, heights) && fits;
    // Where it has gone, the last one has taken its place.
    const bool next_has_moved = intervals_.size() < before && next == intervals_.size();
    if (!next_has_moved) i = next;
  }
  return fits;
}

template <typename HeightsOf>
bool HeldLayer::cut(HeightsOf&& heightsOf) {
  bool fits = true;
  // From the last one down: what is added, or takes the place of another, has been cut already.
  for (std::size_t i = intervals_.size(); i-- > 0;) {
    const Columns::Heights heights = heightsOf(static_cast<const Interval&>(intervals_[i]));
    fits = cut(i, heights) && fits;
  }
  return fits;
}

template <typename MayBeOver, typename IsOver>
void HeldLayer::releaseIf(MayBeOver&& mayBeOver, IsOver&& isOver) {
  for (std::size_t begin = 0; begin < intervals_.size(); begin += kBlock) {
    const std::size_t end = std::min(begin + kBlock, intervals_.size());
    std::uint64_t left = mayBeOver(static_cast<const Glances&>(glances_), begin, end);
    for (; left != 0; left &= left - 1) {
      const std::size_t i = begin + static_cast<std::size_t>(__builtin_ctzll(left));
      // Where it goes the last one takes its place, and is asked about, too.
      while (i < intervals_.size()) {
        Glance glance = glances_.get(i);
        if (!isOver(static_cast<const Interval&>(intervals_[i]), glance)) {
          glances_.set(i, glance);
          break;
        }
        remove(i);
      }
    }
  }
}

}  // namespace tccm
