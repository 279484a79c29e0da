#pragma once

#include <algorithm>
#include <cassert>
#include <cstdint>
#include <memory>
#include <vector>

#include "base/bytes_of.h"
#include "tccm_monitor/cuboid_map.h"
#include "tccm_monitor/time.h"

namespace tccm {

/// One return of a part map.
using MappedReturn = Grid::Place;

/// The part maps of the window's scans, oldest first, in memory that is allocated once: for each
/// scan its stamp and the returns it brought, also where it brought none.
class PartMapRing {
 public:
  PartMapRing(std::size_t scans_max, std::size_t returns_max)
      : parts_(scans_max),
        room_(returns_max),
        chunks_((returns_max + kChunk - 1) / kChunk),
        returns_(new MappedReturn[chunks_.size() * kChunk]) {
    for (std::size_t i = chunks_.size(); i > 0; --i) free_.push_back(i - 1);
  }

  [[nodiscard]] bool full() const { return scans_ == parts_.size(); }
  [[nodiscard]] std::size_t scans() const { return scans_; }
  /// @pre scans() > 0
  [[nodiscard]] Time oldestStamp() const { return parts_[oldest_].stamp; }
  [[nodiscard]] std::uint32_t oldestSerial() const { return parts_[oldest_].serial; }
  /// @param serial of one of the scans; they follow one another.
  [[nodiscard]] Time stampOf(std::uint32_t serial) const {
    const std::size_t place = oldest_ + (serial - oldestSerial());
    return parts_[place < parts_.size() ? place : place - parts_.size()].stamp;
  }

  /// Begins the newest part map. @pre !full()
  void begin(std::uint32_t serial, Time stamp) {
    assert(!full());
    newest_ = (oldest_ + scans_++) % parts_.size();
    parts_[newest_] = Part{serial, stamp, next_, 0};
  }
  /// For so many more returns.
  [[nodiscard]] std::size_t room() const { return room_ - used_; }
  /// Adds to the newest part map. @pre room() > 0 and scans() > 0
  void add(const MappedReturn& entry) { add(&entry, 1); }
  /// @pre room() >= count and scans() > 0
  void add(const MappedReturn* entries, std::size_t count) {
    next_ = visitStretches(next_, count, [&](std::size_t chunk, std::size_t first, std::size_t n) {
      take(chunks_[chunk], n);
      std::copy_n(entries, n, placeIn(chunk, first));
      entries += n;
    });
    used_ += count;
    parts_[newest_].count += count;
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
    const Part& part = parts_[oldest_];
    visitStretches(part.begin, part.count,
                   [this](std::size_t chunk, std::size_t /*first*/, std::size_t n) {
                     giveBack(chunks_[chunk], n);
                   });
    used_ -= part.count;
    oldest_ = oldest_ + 1 < parts_.size() ? oldest_ + 1 : 0;
    --scans_;
  }
  /// Asks keep about each return, oldest scan first, and takes out those it declines; their room is
  /// free again. Part maps stay, also where nothing is left of them.
  template <typename Keep>
  void keepIf(Keep&& keep) {
    if (scans_ == 0) return;
    const auto returnAt = [this](std::size_t place) {
      return placeIn(place / kChunk, place % kChunk);
    };
    const std::size_t begin = parts_[oldest_].begin, before = used_;
    std::size_t from = begin, to = begin;
    used_ = 0;
    for (std::size_t i = 0; i < scans_; ++i) {
      Part& part = parts_[(oldest_ + i) % parts_.size()];
      const std::size_t asked = part.count;
      part.begin = to;
      part.count = 0;
      for (std::size_t k = 0; k < asked; ++k, from = after(from)) {
        if (!keep(*returnAt(from))) continue;
        *returnAt(to) = *returnAt(from);
        to = after(to);
        ++part.count;
      }
      used_ += part.count;
    }
    next_ = to;
    visitStretches(to, before - used_,
                   [this](std::size_t chunk, std::size_t /*first*/, std::size_t n) {
                     giveBack(chunks_[chunk], n);
                   });
  }
  /// Hands each return and its scan's serial to visit, newest scan first.
  template <typename Visit>
  void visitNewestFirst(Visit&& visit) const {
    for (std::size_t i = scans_; i > 0; --i) {
      const Part& part = parts_[(oldest_ + i - 1) % parts_.size()];
      visitPart(part, [&](const MappedReturn& entry) { visit(entry, part.serial); });
    }
  }
  /// Of all part maps.
  [[nodiscard]] std::size_t returns() const { return used_; }
  void clear() {
    while (scans_ > 0) dropOldest();
    oldest_ = next_ = 0;
  }
  [[nodiscard]] std::size_t memoryBytes() const {
    return bytesOf(parts_, chunks_, free_) + chunks_.size() * kChunk * sizeof(MappedReturn);
  }

 private:
  struct Part {
    std::uint32_t serial = 0;
    Time stamp;
    std::size_t begin = 0;
    std::size_t count = 0;
  };
  /// So many places of the ring that lie side by side have a block of memory while any is used.
  static constexpr std::size_t kChunk = 1024;
  struct Chunk {
    std::size_t used = 0;   ///< places
    std::size_t block = 0;  ///< meaningless where none is used
  };
  void take(Chunk& chunk, std::size_t places) {
    if (chunk.used == 0) {
      chunk.block = free_.back();
      free_.pop_back();
    }
    chunk.used += places;
  }
  void giveBack(Chunk& chunk, std::size_t places) {
    chunk.used -= places;
    if (chunk.used == 0) free_.push_back(chunk.block);
  }
  [[nodiscard]] MappedReturn* placeIn(std::size_t chunk, std::size_t first) const {
    return &returns_[chunks_[chunk].block * kChunk + first];
  }
  /// Hands so many places from `begin` on to visit(chunk, its first place, how many in it).
  /// @return the place after them.
  template <typename Visit>
  std::size_t visitStretches(std::size_t begin, std::size_t count, Visit&& visit) const {
    while (count > 0) {
      const std::size_t first = begin % kChunk, n = std::min(count, kChunk - first);
      visit(begin / kChunk, first, n);
      count -= n;
      begin += n;
      if (begin == chunks_.size() * kChunk) begin = 0;
    }
    return begin;
  }
  template <typename Visit>
  void visitPart(const Part& part, Visit&& visit) const {
    visitStretches(part.begin, part.count,
                   [&](std::size_t chunk, std::size_t first, std::size_t n) {
                     const MappedReturn* const from = placeIn(chunk, first);
                     for (std::size_t i = 0; i < n; ++i) visit(from[i]);
                   });
  }
  [[nodiscard]] std::size_t after(std::size_t place) const {
    return place + 1 < chunks_.size() * kChunk ? place + 1 : 0;
  }

  std::vector<Part> parts_;
  std::size_t room_;
  std::vector<Chunk> chunks_;  ///< of the ring, in its order
  /// Blocks that no chunk has. The last that came back is the next to be taken: what the window
  /// never needed at once is never written to, and left to the system.
  std::vector<std::size_t> free_;
  std::unique_ptr<MappedReturn[]> returns_;
  std::size_t oldest_ = 0;
  std::size_t newest_ = 0;  ///< meaningless while there are no scans
  std::size_t scans_ = 0;
  std::size_t next_ = 0;  ///< where the next return goes
  std::size_t used_ = 0;
};

/// How many of the window's returns lie in each layer of each cell: a dense array of counters, so
/// that adding and removing a return cost the same however long the window is. Carving leaves no
/// trace here: a return counts until its scan leaves the window.
class ReturnCounts {
 public:
  /// @param layer thickness of a layer in quanta, at least 1.
  ReturnCounts(const Grid& grid, Height layer)
      : lowest_(grid.heightFloor(grid.config().height_min_m)), layer_(layer) {
    assert(layer >= 1);
    const int heights = grid.heightCeil(grid.config().height_max_m) - lowest_ + 1;
    layer_of_.reserve(static_cast<std::size_t>(heights));
    for (int i = 0; i < heights; ++i) layer_of_.push_back(static_cast<std::uint16_t>(i / layer));
    layers_ = layer_of_.back() + std::size_t{1};
    cells_ = grid.cells();
    counts_.resize(cells_ * layers_, 0);
  }

  void add(CellIndex cell, Height height) { ++counts_[index(cell, height)]; }
  void remove(CellIndex cell, Height height) { --counts_[index(cell, height)]; }
  void clear() { std::fill(counts_.begin(), counts_.end(), 0U); }

  /// The returns in all layers from that of `low` to that of `high`, both included.
  [[nodiscard]] std::uint32_t sum(CellIndex cell, Height low, Height high) const {
    std::uint32_t total = 0;
    const std::size_t last = index(cell, high);
    for (std::size_t i = index(cell, low); i <= last; i += cells_) total += counts_[i];
    return total;
  }
  /// Those in one layer; layers count from the lowest up.
  [[nodiscard]] std::uint32_t at(CellIndex cell, std::size_t layer) const {
    return counts_[layer * cells_ + cell];
  }
  /// @param height inside the grid's limits.
  [[nodiscard]] std::size_t layerOf(Height height) const {
    return layer_of_[static_cast<std::size_t>(height - lowest_)];
  }
  [[nodiscard]] std::size_t layers() const { return layers_; }
  /// The least height of a return.
  [[nodiscard]] Height lowest() const { return lowest_; }
  /// The thickness of one.
  [[nodiscard]] Height layer() const { return layer_; }
  [[nodiscard]] std::size_t memoryBytes() const { return bytesOf(counts_, layer_of_); }

 private:
  [[nodiscard]] std::size_t index(CellIndex cell, Height height) const {
    return layerOf(height) * cells_ + cell;
  }

  Height lowest_;
  Height layer_;
  std::size_t layers_;
  std::size_t cells_;
  std::vector<std::uint16_t> layer_of_;  ///< by quanta above the lowest: saves a division a return
  /// Layer by layer: most returns lie on a few level surfaces, and cells that are asked together
  /// lie side by side.
  std::vector<std::uint32_t> counts_;
};

}  // namespace tccm
