#pragma once

#include <algorithm>

#include "support/placed.h"
#include "support/random.h"
#include "tccm_monitor/cuboid_map.h"

namespace tccm::test {

/// A map without cuboids that a checker may trust.
inline CuboidMap emptyMap(const Grid::Config& grid = {}) {
  CuboidMap map;
  map.grid = Grid(grid);
  map.serial = 1;
  map.window_scans = 1;
  map.complete = true;
  map.thickness = 20;
  indexCells(map);
  return map;
}

/// Adds the cuboid of one cell between two heights [m].
inline void addCuboid(CuboidMap& map, CellIndex cell, double bottom, double top,
                      std::uint32_t points = 5) {
  Cuboid cuboid;
  cuboid.cell = cell;
  cuboid.bottom = map.grid.heightOf(bottom);
  cuboid.top = map.grid.heightOf(top);
  cuboid.points = points;
  const auto place = std::upper_bound(
      map.cuboids.begin(), map.cuboids.end(), cuboid, [](const Cuboid& a, const Cuboid& b) {
        return a.cell != b.cell ? a.cell < b.cell : a.bottom < b.bottom;
      });
  map.cuboids.insert(place, cuboid);
  indexCells(map);
}

/// Fills every column whose centre lies in the box's footprint from its bottom to its top.
inline void addBlock(CuboidMap& map, const UprightBox& block, std::uint32_t points = 5) {
  for (CellIndex cell = 0; cell < map.grid.cells(); ++cell) {
    const Eigen::Vector2d centre = map.grid.centre(cell);
    const Vector3 probe(centre.x(), centre.y(), block.center().z());
    if (block.contains(probe)) addCuboid(map, cell, block.min().z(), block.max().z(), points);
  }
}

/// Cuboids in a share of the cells, one or two in each, that neither overlap nor touch.
inline CuboidMap randomMap(Random& random, const Grid::Config& grid, double share) {
  CuboidMap map = emptyMap(grid);
  for (CellIndex cell = 0; cell < map.grid.cells(); ++cell) {
    double bottom = grid.height_min_m;
    for (int k = 0; k < 2 && random.chance(share); ++k) {
      bottom += random.uniform(0.01, 0.2);
      const double top = bottom + random.uniform(0.01, 0.25);
      addCuboid(map, cell, bottom, top, static_cast<std::uint32_t>(random.integer(1, 3)));
      bottom = top + 0.01;
    }
  }
  return map;
}

}  // namespace tccm::test
