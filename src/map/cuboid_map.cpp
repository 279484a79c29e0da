#include "tccm_monitor/cuboid_map.h"

#include <algorithm>

namespace tccm {

std::uint32_t supportOf(const CuboidMap& map, const Cuboid& cuboid, double height_m) {
  constexpr double kRounding = 1e-9;  // [m]; 0.043 / 0.001 is a hair below 43
  const int reach = map.grid.heightFloor(height_m + kRounding);
  std::uint32_t points = 0;
  map.grid.visitAround(cuboid.cell, [&](CellIndex cell) {
    for (std::uint32_t k = map.cell_begin[cell]; k < map.cell_begin[cell + 1]; ++k) {
      const Cuboid& near = map.cuboids[k];
      if (near.bottom - reach <= cuboid.top && cuboid.bottom - reach <= near.top) {
        points += near.points;
      }
    }
  });
  return points;
}

std::size_t heldIn(const CuboidMap& map) {
  return static_cast<std::size_t>(std::count_if(map.cuboids.begin(), map.cuboids.end(),
                                                [](const Cuboid& c) { return c.held; }));
}

void indexCells(CuboidMap& map) {
  const CellIndex cells = map.grid.cells();
  map.cell_begin.resize(cells + 1);
  std::uint32_t next = 0;
  const auto count = static_cast<std::uint32_t>(map.cuboids.size());
  for (CellIndex cell = 0; cell < cells; ++cell) {
    map.cell_begin[cell] = next;
    while (next < count && map.cuboids[next].cell == cell) ++next;
  }
  map.cell_begin[cells] = count;
}

}  // namespace tccm
