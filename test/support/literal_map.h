#pragma once

#include <cstdint>
#include <deque>
#include <list>
#include <map>
#include <vector>

#include "map/window_returns.h"

namespace tccm::test {

/// The paper's cuboid (section III.B): top u and depth d in quanta, and the serials of the part
/// maps it was made from.
struct LiteralCuboid {
  int u;
  int d;
  std::list<std::uint32_t> msnlist;

  [[nodiscard]] int bottom() const { return u - d; }
};

using LiteralColumn = std::list<LiteralCuboid>;
/// Columns of the cells that have any.
using LiteralPartMap = std::map<CellIndex, LiteralColumn>;

/// The paper's integration map, step by step as section III.C describes it, with its slips
/// corrected: lists of cuboids, stored part maps, deformation, addition, subtraction. It shares
/// nothing with IntegrationMap, so that the two can be compared.
class LiteralMap {
 public:
  LiteralMap(CellIndex cells, int thickness) : columns_(cells), thickness_(thickness) {}

  /// Deforms the stored part maps by the newest, then adds that to the integration map.
  void add(const std::vector<MappedReturn>& returns);
  /// Subtracts the oldest part map, as it was deformed. @pre a part map is stored
  void expireOldest();

  /// Each cell's column; its cuboids are in no order.
  [[nodiscard]] const std::vector<LiteralColumn>& columns() const { return columns_; }

 private:
  struct Stored {
    std::uint32_t serial;
    LiteralPartMap part_map;
  };
  void deform(const LiteralPartMap& newest);
  void subtract(CellIndex cell, const LiteralCuboid& part, std::uint32_t serial);

  std::vector<LiteralColumn> columns_;
  std::deque<Stored> stored_;
  int thickness_;
  std::uint32_t next_serial_ = 1;
};

/// Equation 1: one scan's cuboids.
[[nodiscard]] LiteralPartMap literalPartMap(const std::vector<MappedReturn>& returns, int thickness,
                                            std::uint32_t serial);

/// Section III.C.1: the integration map as the sum of all part maps, made anew.
[[nodiscard]] std::vector<LiteralColumn> additionOfAll(const std::deque<LiteralPartMap>& part_maps,
                                                       CellIndex cells);

}  // namespace tccm::test
