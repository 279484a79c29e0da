#pragma once

#include <cstdint>
#include <vector>

#include "tccm_monitor/cuboid_map.h"

namespace tccm {

/// How many of the window's returns lie in each layer of each cell: a dense array of counters, so
/// that adding and removing a return cost the same however long the window is. Carving leaves no
/// trace here: a return counts until its scan leaves the window.
class ReturnCounts {
 public:
  /// @param layer thickness of a layer in quanta, at least 1.
  ReturnCounts(const Grid& grid, Height layer);

  void add(CellIndex cell, Height height) { ++counts_[index(cell, height)]; }
  void remove(CellIndex cell, Height height) { --counts_[index(cell, height)]; }
  void clear();

  /// The returns in all layers from that of `low` to that of `high`, both included.
  [[nodiscard]] std::uint32_t sum(CellIndex cell, Height low, Height high) const;
  /// Those in one layer; layers count from the lowest up.
  [[nodiscard]] std::uint32_t at(CellIndex cell, std::size_t layer) const {
    return counts_[cell * layers_ + layer];
  }
  /// @param height inside the grid's limits.
  [[nodiscard]] std::size_t layerOf(Height height) const {
    return layer_of_[static_cast<std::size_t>(height - lowest_)];
  }
  [[nodiscard]] std::size_t layers() const { return layers_; }
  /// The thickness of one.
  [[nodiscard]] Height layer() const { return layer_; }
  [[nodiscard]] std::size_t memoryBytes() const;

 private:
  [[nodiscard]] std::size_t index(CellIndex cell, Height height) const {
    return cell * layers_ + layerOf(height);
  }

  Height lowest_;
  Height layer_;
  std::size_t layers_;
  std::vector<std::uint16_t> layer_of_;  ///< by quanta above the lowest: saves a division a return
  std::vector<std::uint32_t> counts_;
};

}  // namespace tccm
