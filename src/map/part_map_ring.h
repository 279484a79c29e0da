#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "tccm_monitor/cuboid_map.h"
#include "tccm_monitor/time.h"

namespace tccm {

/// One return of a part map: the cell it fell into and its height.
struct MappedReturn {
  CellIndex cell;
  Height height;
};

/// The part maps of the window's scans, oldest first, in memory that is allocated once: for each
/// scan its stamp and the returns it brought, also where it brought none.
class PartMapRing {
 public:
  PartMapRing(std::size_t scans_max, std::size_t returns_max);

  [[nodiscard]] bool full() const { return scans_ == parts_.size(); }
  [[nodiscard]] std::size_t scans() const { return scans_; }
  /// @pre scans() > 0
  [[nodiscard]] Time oldestStamp() const { return parts_[oldest_].stamp; }
  [[nodiscard]] std::uint32_t oldestSerial() const { return parts_[oldest_].serial; }

  /// Begins the newest part map. @pre !full()
  void begin(std::uint32_t serial, Time stamp);
  [[nodiscard]] bool hasRoom() const { return used_ < returns_.size(); }
  /// For so many more returns.
  [[nodiscard]] std::size_t room() const { return returns_.size() - used_; }
  /// Adds to the newest part map. @pre hasRoom() and scans() > 0
  void add(const MappedReturn& entry) {
    returns_[next_] = entry;
    next_ = after(next_);
    ++used_;
    ++parts_[newest_].count;
  }
  /// Hands each of the oldest part map's returns to visit. @pre scans() > 0
  template <typename Visit>
  void visitOldest(Visit&& visit) const {
    visitPart(parts_[oldest_], visit);
  }
  /// And of the newest. @pre scans() > 0
  template <typename Visit>
  void visitNewest(Visit&& visit) const {
    visitPart(parts_[newest_], visit);
  }
  /// Drops the oldest part map. @pre scans() > 0
  void dropOldest() {
    used_ -= parts_[oldest_].count;
    oldest_ = oldest_ + 1 < parts_.size() ? oldest_ + 1 : 0;
    --scans_;
  }
  /// Asks keep about each return, oldest scan first, and takes out those it declines; their room is
  /// free again. Part maps stay, also where nothing is left of them.
  template <typename Keep>
  void keepIf(Keep&& keep) {
    if (scans_ == 0) return;
    std::size_t from = parts_[oldest_].begin, to = from;
    used_ = 0;
    for (std::size_t i = 0; i < scans_; ++i) {
      Part& part = parts_[(oldest_ + i) % parts_.size()];
      const std::size_t asked = part.count;
      part.begin = to;
      part.count = 0;
      for (std::size_t k = 0; k < asked; ++k, from = after(from)) {
        if (!keep(returns_[from])) continue;
        returns_[to] = returns_[from];
        to = after(to);
        ++part.count;
      }
      used_ += part.count;
    }
    next_ = to;
  }
  /// Hands each return and its scan's serial to visit, newest scan first.
  template <typename Visit>
  void visitNewestFirst(Visit&& visit) const {
    for (std::size_t i = scans_; i > 0; --i) {
      const Part& part = parts_[(oldest_ + i - 1) % parts_.size()];
      std::size_t from = part.begin;
      for (std::size_t k = 0; k < part.count; ++k, from = after(from)) {
        visit(returns_[from], part.serial);
      }
    }
  }
  /// Of all part maps.
  [[nodiscard]] std::size_t returns() const { return used_; }
  void clear();
  [[nodiscard]] std::size_t memoryBytes() const;

 private:
  struct Part {
    std::uint32_t serial = 0;
    Time stamp;
    std::size_t begin = 0;
    std::size_t count = 0;
  };
  template <typename Visit>
  void visitPart(const Part& part, Visit&& visit) const {
    const std::size_t straight = std::min(part.count, returns_.size() - part.begin);
    const MappedReturn* from = returns_.data() + part.begin;
    for (std::size_t i = 0; i < straight; ++i) visit(from[i]);
    for (std::size_t i = 0; i < part.count - straight; ++i) visit(returns_[i]);
  }
  [[nodiscard]] std::size_t after(std::size_t place) const {
    return place + 1 < returns_.size() ? place + 1 : 0;
  }

  std::vector<Part> parts_;
  std::vector<MappedReturn> returns_;
  std::size_t oldest_ = 0;
  std::size_t newest_ = 0;  ///< meaningless while there are no scans
  std::size_t scans_ = 0;
  std::size_t next_ = 0;  ///< where the next return goes
  std::size_t used_ = 0;
};

}  // namespace tccm
