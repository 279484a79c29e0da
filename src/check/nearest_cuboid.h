#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>

#include "geometry/distance.h"
#include "tccm_monitor/cuboid_map.h"

namespace tccm {

struct NearestCuboid {
  double distance_m;
  std::uint32_t cuboid;  ///< index into the map's cuboids
};

/// Looks for the cuboid nearest to a placed shape, from the rows of cells in its middle outwards,
/// and ever less far as nearer ones are found.
class NearestCuboidSearch {
 public:
  /// @param nearer_than_m what is not nearer than this is not looked for.
  NearestCuboidSearch(const CuboidMap& map, const Shape& shape, const Pose& T_fixed_shape,
                      double nearer_than_m)
      : map_(map),
        shape_(shape),
        T_fixed_shape_(T_fixed_shape),
        around_(bounds(shape, T_fixed_shape)),
        cells_a_metre_(1.0 / map.grid.config().cell_size_m) {
    setReach(nearer_than_m);
  }

  /// @param counts (cuboid) -> bool: whether a cuboid is to be taken into account.
  /// @return distance 0: the first that was found to touch.
  template <typename Counts>
  [[nodiscard]] std::optional<NearestCuboid> find(Counts&& counts) {
    const auto rows = static_cast<int>(map_.grid.cellsY());
    searchBelow(counts);
    int above = rowOf(around_.center().y()), below = above - 1;
    while ((above < rows || below >= 0) && reach_m_ > 0.0) {
      if (above < rows && !searchRow(above++, counts)) above = rows;
      if (below >= 0 && !searchRow(below--, counts)) below = -1;
    }
    return best_;
  }

 private:
  /// Across the gap between the shape and a cuboid.
  struct Plane {
    Vector3 normal = Vector3::Zero();                          ///< towards the shape
    double lowest = -std::numeric_limits<double>::infinity();  ///< of the shape along it
  };

  /// What stands below its lowest point is mostly among the nearest.
  template <typename Counts>
  void searchBelow(Counts&& counts) {
    const Vector3 p_fixed = furthest(shape_, T_fixed_shape_, -Vector3::UnitZ());
    const int row = rowOf(p_fixed.y());
    if (row == static_cast<int>(map_.grid.cellsY())) return;
    x_begin_ = columnOf(p_fixed.x());
    x_end_ = x_begin_ + 1;
    searchRow(row, counts);
    setReach(reach_m_);
  }

  /// @return false where the row, and with it all beyond, is too far away.
  template <typename Counts>
  bool searchRow(int row, Counts&& counts) {
    const Grid::Config& grid = map_.grid.config();
    const double y = grid.origin_y_m + row * grid.cell_size_m;
    const double gap_y = gap(y, y + grid.cell_size_m, 1);
    if (gap_y >= reach_m_) return false;
    const CellIndex row_begin = static_cast<CellIndex>(row) * map_.grid.cellsX();
    const std::uint32_t* cell_begin = &map_.cell_begin[row_begin];
    for (std::uint32_t k = cell_begin[x_begin_]; k < cell_begin[x_end_]; ++k) {
      const Cuboid& cuboid = map_.cuboids[k];
      if (cuboid.top < low_ || cuboid.bottom > high_) continue;
      const double x = grid.origin_x_m + (cuboid.cell - row_begin) * grid.cell_size_m;
      const double bottom = map_.grid.metres(cuboid.bottom);
      const double top = map_.grid.metres(cuboid.top);
      const double gap_x = gap(x, x + grid.cell_size_m, 0), gap_z = gap(bottom, top, 2);
      if (gap_x * gap_x + gap_y * gap_y + gap_z * gap_z >= reach_m_ * reach_m_) continue;
      if (isBeyondAnyPlane(x, y, bottom, top)) continue;
      const Separation apart = separation(shape_, T_fixed_shape_, map_.box(cuboid), reach_m_);
      addPlane(apart.direction);
      if (apart.distance_m >= reach_m_ || !counts(cuboid)) continue;
      best_ = NearestCuboid{apart.distance_m, k};
      setReach(apart.distance_m);
      if (reach_m_ == 0.0) break;
    }
    return true;
  }

  /// Between the shape's bounds and an interval along an axis; 0 where they overlap [m].
  [[nodiscard]] double gap(double low, double high, int axis) const {
    return std::max({0.0, low - around_.max()[axis], around_.min()[axis] - high});
  }

  /// The number of rows where y lies beyond them all.
  [[nodiscard]] int rowOf(double y) const {
    const double row = (y - map_.grid.config().origin_y_m) * cells_a_metre_;
    return row > 0.0 ? static_cast<int>(std::min(row, 1.0 * map_.grid.cellsY())) : 0;
  }

  [[nodiscard]] CellIndex columnOf(double x) const {
    const double column = (x - map_.grid.config().origin_x_m) * cells_a_metre_;
    return column > 0.0 ? static_cast<CellIndex>(std::min(column, map_.grid.cellsX() - 1.0)) : 0;
  }

  void addPlane(const Vector3& normal) {
    planes_[next_plane_] = {normal, normal.dot(furthest(shape_, T_fixed_shape_, -normal))};
    next_plane_ = (next_plane_ + 1) % planes_.size();
  }

  /// Whether the gap to one of the last shows of this one as well that it is far enough away.
  [[nodiscard]] bool isBeyondAnyPlane(double x, double y, double bottom, double top) const {
    const double cell_size = map_.grid.config().cell_size_m;
    for (const Plane& plane : planes_) {
      const double highest = std::max(plane.normal.x() * x, plane.normal.x() * (x + cell_size)) +
                             std::max(plane.normal.y() * y, plane.normal.y() * (y + cell_size)) +
                             std::max(plane.normal.z() * bottom, plane.normal.z() * top);
      if (plane.lowest - highest >= reach_m_ - kRounding) return true;
    }
    return false;
  }

  void setReach(double metres) {
    reach_m_ = metres;
    x_begin_ = columnOf(around_.min().x() - metres - kRounding);
    x_end_ = columnOf(around_.max().x() + metres + kRounding) + 1;
    low_ = map_.grid.heightFloor(around_.min().z() - metres);
    high_ = map_.grid.heightCeil(around_.max().z() + metres);
  }

  static constexpr double kRounding = 1e-9;

  const CuboidMap& map_;
  const Shape& shape_;
  const Pose& T_fixed_shape_;
  UprightBox around_;
  double cells_a_metre_;
  double reach_m_ = 0.0;  ///< what is not nearer need not be looked at
  CellIndex x_begin_ = 0, x_end_ = 0;
  Height low_ = 0, high_ = 0;
  std::optional<NearestCuboid> best_;
  std::array<Plane, 3> planes_;
  std::size_t next_plane_ = 0;
};

}  // namespace tccm
