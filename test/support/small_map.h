#pragma once

#include "map/integration_map.h"
#include "map/mapper.h"

namespace tccm::test {

/// Its least corner is at (origin_m, origin_m).
inline Grid::Config smallGrid(double size_x_m, double size_y_m, double height_max_m,
                              double origin_m = 0.0) {
  Grid::Config grid;
  grid.origin_x_m = grid.origin_y_m = origin_m;
  grid.size_x_m = size_x_m;
  grid.size_y_m = size_y_m;
  grid.height_max_m = height_max_m;
  return grid;
}

/// 3 x 2 cells from 0 to 1 m.
inline IntegrationMap::Config sixCells(double cell_size_m = 0.1) {
  IntegrationMap::Config config;
  config.grid = smallGrid(3 * cell_size_m, 2 * cell_size_m, 1.0);
  config.grid.cell_size_m = cell_size_m;
  return config;
}

/// 4 x 3 cells from 20 mm to 0.4 m, so that returns meet often.
inline IntegrationMap::Config crowdedMap(std::size_t returns_max, std::size_t intervals_max) {
  IntegrationMap::Config config;
  config.grid = smallGrid(0.08, 0.06, 0.4);
  config.grid.height_min_m = 0.02;
  config.returns_max = returns_max;
  config.intervals_max = intervals_max;
  return config;
}

/// 10 x 10 cells; nothing is held.
inline Mapper::Config smallMapper() {
  Mapper::Config config;
  config.map.grid.origin_y_m = 0.0;
  config.map.grid.size_x_m = config.map.grid.size_y_m = 0.2;
  config.map.returns_max = 10000;
  config.map.intervals_max = 1000;
  config.hold.longest_s = 0.0;
  return config;
}

/// Of an IntegrationMap or a Mapper.
template <typename Map>
[[nodiscard]] CuboidMap snapshotOf(Map&& map) {
  CuboidMap snapshot;
  map.snapshot(snapshot);
  return snapshot;
}

/// When it came, at 28 ms each.
inline Time atScan(int scan) { return Time(fromSeconds(0.028 * scan)); }

}  // namespace tccm::test
