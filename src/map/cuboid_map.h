#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "geometry/pose.h"
#include "map/grid.h"
#include "sight/look_image.h"

namespace tccm {

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

}  // namespace tccm
