#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "tccm_monitor/look_image.h"
#include "tccm_monitor/pose.h"
#include "tccm_monitor/shape.h"

namespace tccm {

class ParameterTable;

/// Heights count in quanta above the fixed frame's z = 0. An interval of heights is half-open:
/// [bottom, top).
using Height = std::int16_t;
/// Cells count along x first: index = iy * cells_x + ix.
using CellIndex = std::uint32_t;

/// The map's area, cut into square columns on the fixed frame's xy plane (paper, section III.A).
class Grid {
 public:
  struct Config {
    double origin_x_m = 0.0;  ///< the corner with the least x and y
    double origin_y_m = -1.0;
    double size_x_m = 1.5;  ///< whole cells; the last may reach beyond
    double size_y_m = 2.0;
    double height_min_m = 0.0;  ///< points below, or at or above height_max_m, are out of the area
    double height_max_m = 2.0;
    double cell_size_m = 0.02;
    double height_quantum_m = 0.001;

    void describe(ParameterTable& table);
    /// @throws ConfigError where two values contradict each other.
    void validate() const;
  };

  Grid() : Grid(Config()) {}
  /// @throws ConfigError
  explicit Grid(const Config& config);

  [[nodiscard]] const Config& config() const { return config_; }
  [[nodiscard]] CellIndex cellsX() const { return cells_x_; }
  [[nodiscard]] CellIndex cellsY() const { return cells_y_; }
  [[nodiscard]] CellIndex cells() const { return cells_x_ * cells_y_; }

  /// A position as the map and every dump of it take it: rounded to the micrometre, so that
  /// floor((x - origin) / cell_size) of the printed number names the same cell.
  [[nodiscard]] static double toMicrometre(double metres);

  /// The cell floor((x - origin) / cell_size) names; nothing outside the area, for NaN, or for a
  /// height outside the limits. @param p_fixed rounded by toMicrometre.
  [[nodiscard]] std::optional<CellIndex> cellOf(const Vector3& p_fixed) const;
  /// Whether the map says anything of a place: not outside the area or the heights, nor for NaN.
  [[nodiscard]] bool covers(const Vector3& p_fixed) const { return cellOf(p_fixed).has_value(); }
  /// The whole of what it covers.
  [[nodiscard]] UprightBox area() const;
  /// A return's cell and height.
  struct Place {
    CellIndex cell;
    Height height;
  };
  /// toMicrometre(), cellOf() and heightOf() in one, with the same result, and without a division
  /// wherever none of the roundings can matter. @param p_fixed as measured.
  [[nodiscard]] std::optional<Place> place(const Vector3& p_fixed) const;
  /// The nearest quantum, halves to even. @param z inside the limits.
  [[nodiscard]] Height heightOf(double z) const;
  /// The largest height in quanta at or below z, and the least at or above it; clamped to 16 bits.
  [[nodiscard]] Height heightFloor(double z) const;
  [[nodiscard]] Height heightCeil(double z) const;
  [[nodiscard]] double metres(int height) const { return height * config_.height_quantum_m; }

  /// The column's part between two heights, as a box in the fixed frame.
  [[nodiscard]] UprightBox box(CellIndex cell, int bottom, int top) const;
  [[nodiscard]] Eigen::Vector2d centre(CellIndex cell) const;

  /// The cells ix in [x_begin, x_end), iy in [y_begin, y_end) that a box's footprint touches.
  struct Footprint {
    CellIndex x_begin, x_end, y_begin, y_end;
  };
  [[nodiscard]] Footprint footprint(const UprightBox& box) const;

  /// Hands the rows of the 3 x 3 cells around a cell to visit(first, last), itself included, those
  /// beyond the area left out.
  template <typename Visit>
  void visitRowsAround(CellIndex cell, Visit&& visit) const {
    const CellIndex ix = cell % cells_x_, iy = cell / cells_x_;
    const CellIndex left = ix - std::min(ix, 1U);
    const CellIndex right = std::min(ix + 1, cells_x_ - 1);
    for (CellIndex y = iy - std::min(iy, 1U); y < std::min(iy + 2, cells_y_); ++y) {
      visit(y * cells_x_ + left, y * cells_x_ + right);
    }
  }
  /// Hands each of these cells to visit.
  template <typename Visit>
  void visitAround(CellIndex cell, Visit&& visit) const {
    visitRowsAround(cell, [&visit](CellIndex first, CellIndex last) {
      for (CellIndex c = first; c <= last; ++c) visit(c);
    });
  }

  [[nodiscard]] bool operator==(const Grid& other) const;

 private:
  static constexpr double kDoubt = 1e-6;  // [m]; rounding to the micrometre moves by half of it
  /// As std::nearbyint, halves to even, for |x| up to 2^51, but inline: adding 1.5 * 2^52 leaves no
  /// bits for the fraction. Each return of each scan is rounded four times.
  [[nodiscard]] static double nearest(double x) {
    constexpr double kShift = 6755399441055744.0;
    return (x + kShift) - kShift;
  }
  static constexpr std::uint64_t kNowhere = ~std::uint64_t{0};
  /// Near a border the rounding decides. In one word, the height above the cell's 32 bits: as a
  /// struct the answer would go through memory, and with it every other.
  [[nodiscard]] std::uint64_t placeRounded(const Vector3& p_fixed) const;

  Config config_;
  CellIndex cells_x_;
  CellIndex cells_y_;
  double cells_a_metre_;
  double quanta_a_metre_;
  double doubt_cells_;  ///< so near to a border the rounding to the micrometre decides
  double doubt_quanta_;
};

/// A maximal run of occupied heights in one cell's column (paper, section III).
struct Cuboid {
  CellIndex cell = 0;
  Height bottom = 0;  ///< quanta; occupied are [bottom, top)
  Height top = 0;     ///< the paper's u; its d is top - bottom
  /// Returns of the window's scans in it (the paper's pnum); of one that is held those around it
  /// too, as they were when it left: what supported it then may have been let go.
  std::uint32_t points = 0;
  std::uint32_t age_scans = 0;  ///< since something was first seen here without interruption
  /// For how many windows the surroundings have been where they are (section IV.C), see PlaceAges;
  /// low means dynamic.
  std::uint32_t dyn = 0;
  /// It left the window, but nobody looked at its place since: no part of the live map.
  bool held = false;
  bool appeared = false;        ///< a moment ago its place was seen free
  std::uint32_t unseen_ms = 0;  ///< since it was seen last, at the map's stamp
};

/// A snapshot of the integration map: all that checks need, and nothing that changes under them.
struct CuboidMap {
  Grid grid;
  Time stamp;                      ///< of the newest scan's first beam
  std::uint32_t serial = 0;        ///< of the newest scan; the first scan's is 1, none is 0
  std::uint32_t window_scans = 0;  ///< scans whose points are in the map
  Duration window{0};              ///< from the oldest of them to the newest
  bool complete = false;           ///< the window holds a whole tilt period, or what was asked for
  bool overflowed = false;         ///< a bound was met and points were left out: not to be trusted
  bool tilt_stopped = false;       ///< the sensor tilted, and does not any more, or not as far
  /// From one look at a place to the next in the same direction of the tilt: the tilt's period, or
  /// where none is measured the window; 0 before either is known.
  Duration look_period{0};
  Duration hold{0};  ///< for which at most is held what leaves the window
  /// The share of the returns inside the area and below it that was taken for the robot, over the
  /// last period of the tilt; nothing where it is not known, or fewer than 50 a scan lie there.
  std::optional<double> self_share = {};
  std::uint32_t appeared = 0;           ///< cuboids that have
  Height thickness = 0;                 ///< d0, quanta
  Vector3 viewpoint = Vector3::Zero();  ///< the sensor's origin at the newest beam, fixed frame [m]
  LookImage looks;                      ///< where the sensor looked, and how far it saw
  std::vector<Cuboid> cuboids;          ///< by cell, then from low to high
  /// The cuboids of a cell are those from cell_begin[cell] up to cell_begin[cell + 1].
  std::vector<std::uint32_t> cell_begin;

  [[nodiscard]] UprightBox box(const Cuboid& cuboid) const {
    return grid.box(cuboid.cell, cuboid.bottom, cuboid.top);
  }
};

/// How many returns of the window lie near a cuboid: those of all cuboids in the 3 x 3 cells around
/// it that come within height_m of its heights, its own included.
[[nodiscard]] std::uint32_t supportOf(const CuboidMap& map, const Cuboid& cuboid, double height_m);

/// How many of a map's cuboids are held.
[[nodiscard]] std::size_t heldIn(const CuboidMap& map);

/// Fills cell_begin from the cuboids' cells. @pre cuboids are ordered by cell.
void indexCells(CuboidMap& map);

/// What became of a scan's returns.
struct AddedReturns {
  std::size_t mapped = 0;
  std::size_t out_of_area = 0;
  std::size_t forgotten = 0;  ///< where a grasped object was just before
};

inline std::optional<Grid::Place> Grid::place(const Vector3& p_fixed) const {
  const double x = (p_fixed.x() - config_.origin_x_m) * cells_a_metre_;
  const double y = (p_fixed.y() - config_.origin_y_m) * cells_a_metre_;
  const double z = p_fixed.z();
  const bool near = x > -doubt_cells_ && x < cells_x_ + doubt_cells_ && y > -doubt_cells_ &&
                    y < cells_y_ + doubt_cells_ && z > config_.height_min_m - kDoubt &&
                    z < config_.height_max_m + kDoubt;
  if (!near) return std::nullopt;  // also for NaN
  const auto ix = static_cast<std::int64_t>(x), iy = static_cast<std::int64_t>(y);
  const double beyond_x = x - static_cast<double>(ix), beyond_y = y - static_cast<double>(iy);
  const double quanta = z * quanta_a_metre_;
  const double height = nearest(quanta);
  const bool sure = beyond_x > doubt_cells_ && beyond_x < 1.0 - doubt_cells_ &&
                    beyond_y > doubt_cells_ && beyond_y < 1.0 - doubt_cells_ &&
                    std::abs(quanta - height) < 0.5 - doubt_quanta_ &&
                    z > config_.height_min_m + kDoubt && z < config_.height_max_m - kDoubt;
  if (sure) {
    return Place{static_cast<CellIndex>(iy) * cells_x_ + static_cast<CellIndex>(ix),
                 static_cast<Height>(height)};
  }
  const std::uint64_t word = placeRounded(p_fixed);
  if (word == kNowhere) return std::nullopt;
  return Place{static_cast<CellIndex>(word), static_cast<Height>(word >> 32)};
}

}  // namespace tccm
