#include "tccm_monitor/cuboid_map.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "config/parameter_table.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

constexpr double kCellsMax = 4e6;
constexpr double kFarthest = 1e4;  // [m]

double cellsAlong(double size, double cell_size) {
  return std::ceil(size / cell_size - 1e-9);  // 1.5 / 0.02 is a hair above 75
}

Height clampToHeight(double quanta) {
  return static_cast<Height>(std::clamp(quanta, double{std::numeric_limits<Height>::min()},
                                        double{std::numeric_limits<Height>::max()}));
}

CellIndex clampToCells(double index, CellIndex cells) {
  return static_cast<CellIndex>(std::clamp(index, 0.0, static_cast<double>(cells)));
}

}  // namespace

void Grid::Config::describe(ParameterTable& table) {
  // Room for a thickness below the lowest.
  const double highest = 32000.0 * height_quantum_m;
  table.add("area_origin_x_m", &origin_x_m, "m", {-kFarthest, kFarthest},
            "the area's corner with the least x");
  table.add("area_origin_y_m", &origin_y_m, "m", {-kFarthest, kFarthest},
            "the area's corner with the least y");
  table.add("cell_size_m", &cell_size_m, "m", {0.001, 1.0}, "edge of a cell");
  table.add("area_size_x_m", &size_x_m, "m", {cell_size_m, kFarthest},
            "whole cells; the last may reach beyond");
  table.add("area_size_y_m", &size_y_m, "m", {cell_size_m, kFarthest},
            "whole cells; the last may reach beyond");
  table.add("height_quantum_m", &height_quantum_m, "m", {1e-4, 0.1}, "heights are multiples of it");
  table.add("height_min_m", &height_min_m, "m", {-0.5 * highest, highest},
            "points below are out of the area");
  table.add("height_max_m", &height_max_m, "m", {height_min_m + height_quantum_m, highest},
            "points at or above are out of the area");
}

void Grid::Config::validate() const {
  const double cells = cellsAlong(size_x_m, cell_size_m) * cellsAlong(size_y_m, cell_size_m);
  requireInRange("cells of the area (area_size_x_m, area_size_y_m, cell_size_m)", cells, 1.0,
                 kCellsMax);
}

Grid::Grid(const Config& config)
    : config_(validated(config)),
      cells_a_metre_(1.0 / config.cell_size_m),
      quanta_a_metre_(1.0 / config.height_quantum_m),
      doubt_cells_(kDoubt * cells_a_metre_),
      doubt_quanta_(kDoubt * quanta_a_metre_) {
  cells_x_ = static_cast<CellIndex>(cellsAlong(config_.size_x_m, config_.cell_size_m));
  cells_y_ = static_cast<CellIndex>(cellsAlong(config_.size_y_m, config_.cell_size_m));
}

double Grid::toMicrometre(double metres) { return nearest(metres * 1e6) / 1e6; }

std::optional<CellIndex> Grid::cellOf(const Vector3& p_fixed) const {
  const double x = (p_fixed.x() - config_.origin_x_m) / config_.cell_size_m;
  const double y = (p_fixed.y() - config_.origin_y_m) / config_.cell_size_m;
  const bool inside = x >= 0.0 && x < cells_x_ && y >= 0.0 && y < cells_y_ &&
                      p_fixed.z() >= config_.height_min_m && p_fixed.z() < config_.height_max_m;
  if (!inside) return std::nullopt;
  // From 0 up, a cast is the floor, and needs no call.
  return static_cast<CellIndex>(y) * cells_x_ + static_cast<CellIndex>(x);
}

UprightBox Grid::area() const {
  const double size = config_.cell_size_m;
  const Vector3 origin(config_.origin_x_m, config_.origin_y_m, config_.height_min_m);
  return {origin, Vector3(origin.x() + cells_x_ * size, origin.y() + cells_y_ * size,
                          config_.height_max_m)};
}

std::uint64_t Grid::placeRounded(const Vector3& p_fixed) const {
  const Vector3 rounded(toMicrometre(p_fixed.x()), toMicrometre(p_fixed.y()),
                        toMicrometre(p_fixed.z()));
  const auto cell = cellOf(rounded);
  if (!cell) return kNowhere;
  return static_cast<std::uint64_t>(static_cast<std::uint16_t>(heightOf(rounded.z()))) << 32 |
         *cell;
}

Height Grid::heightOf(double z) const {
  return static_cast<Height>(nearest(z / config_.height_quantum_m));
}

Height Grid::heightFloor(double z) const {
  return clampToHeight(std::floor(z / config_.height_quantum_m));
}

Height Grid::heightCeil(double z) const {
  return clampToHeight(std::ceil(z / config_.height_quantum_m));
}

UprightBox Grid::box(CellIndex cell, int bottom, int top) const {
  const CellIndex column = cell % cells_x_, row = cell / cells_x_;
  const double x = config_.origin_x_m + column * config_.cell_size_m;
  const double y = config_.origin_y_m + row * config_.cell_size_m;
  return {Vector3(x, y, metres(bottom)),
          Vector3(x + config_.cell_size_m, y + config_.cell_size_m, metres(top))};
}

Eigen::Vector2d Grid::centre(CellIndex cell) const {
  const CellIndex column = cell % cells_x_, row = cell / cells_x_;
  return {config_.origin_x_m + (column + 0.5) * config_.cell_size_m,
          config_.origin_y_m + (row + 0.5) * config_.cell_size_m};
}

Grid::Footprint Grid::footprint(const UprightBox& box) const {
  // A box that ends on a cell's border touches the cells on both sides of it.
  const double size = config_.cell_size_m;
  const auto first = [size](double low, double origin) {
    return std::ceil((low - origin) / size) - 1;
  };
  const auto last = [size](double high, double origin) {
    return std::floor((high - origin) / size) + 1;
  };
  return {clampToCells(first(box.min().x(), config_.origin_x_m), cells_x_),
          clampToCells(last(box.max().x(), config_.origin_x_m), cells_x_),
          clampToCells(first(box.min().y(), config_.origin_y_m), cells_y_),
          clampToCells(last(box.max().y(), config_.origin_y_m), cells_y_)};
}

bool Grid::operator==(const Grid& other) const {
  const auto all = [](const Config& c) {
    return std::tie(c.origin_x_m, c.origin_y_m, c.size_x_m, c.size_y_m, c.height_min_m,
                    c.height_max_m, c.cell_size_m, c.height_quantum_m);
  };
  return all(config_) == all(other.config_);
}

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
