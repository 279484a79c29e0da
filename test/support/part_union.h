#pragma once

#include <algorithm>
#include <deque>
#include <map>
#include <ostream>
#include <vector>

#include "map/window_returns.h"
#include "tccm_monitor/cuboid_map.h"

namespace tccm::test {

/// Occupied heights [bottom, top) of one cell [quanta], and the returns that lie in them.
struct Run {
  CellIndex cell;
  int bottom;
  int top;
  std::uint32_t points;

  bool operator==(const Run& other) const {
    return cell == other.cell && bottom == other.bottom && top == other.top &&
           points == other.points;
  }
};

inline std::ostream& operator<<(std::ostream& out, const Run& run) {
  return out << "cell " << run.cell << " [" << run.bottom << ", " << run.top << ") " << run.points
             << " points";
}

inline std::vector<Run> runsOf(const CuboidMap& map) {
  std::vector<Run> runs;
  for (const Cuboid& cuboid : map.cuboids) {
    runs.push_back({cuboid.cell, cuboid.bottom, cuboid.top, cuboid.points});
  }
  return runs;
}

/// The returns of one scan that fall into the area, in cells and quanta.
inline std::vector<MappedReturn> mappedReturns(const Grid& grid,
                                               const std::vector<Vector3>& points) {
  std::vector<MappedReturn> returns;
  for (const Vector3& exact : points) {
    const Vector3 p = exact.unaryExpr([](double x) { return Grid::toMicrometre(x); });
    if (const auto cell = grid.cellOf(p)) returns.push_back({*cell, grid.heightOf(p.z())});
  }
  return returns;
}

/// The brute-force map: every return of every part map occupies (top - thickness, top]; what
/// overlaps or touches is one run. By cell, then from low to high.
inline std::vector<Run> unionOf(const std::deque<std::vector<MappedReturn>>& part_maps,
                                int thickness) {
  std::map<CellIndex, std::vector<int>> tops;
  for (const auto& part_map : part_maps) {
    for (const MappedReturn& entry : part_map) tops[entry.cell].push_back(entry.height);
  }
  std::vector<Run> runs;
  for (auto& [cell, heights] : tops) {
    std::sort(heights.begin(), heights.end());
    const std::size_t first = runs.size();
    for (const int top : heights) {
      if (runs.size() == first || runs.back().top < top - thickness) {
        runs.push_back({cell, top - thickness, top, 0});
      }
      runs.back().top = top;
      ++runs.back().points;
    }
  }
  return runs;
}

/// What of the runs counts where nothing does below the lowest height, and what is seen at it
/// counts as the first quantum above.
inline std::vector<Run> clippedAt(int lowest, const std::vector<Run>& runs) {
  std::vector<Run> clipped;
  for (Run run : runs) {
    run.bottom = std::max(run.bottom, lowest);
    run.top = std::max(run.top, lowest + 1);
    if (!clipped.empty() && clipped.back().cell == run.cell && clipped.back().top >= run.bottom) {
      clipped.back().top = run.top;
      clipped.back().points += run.points;
    } else {
      clipped.push_back(run);
    }
  }
  return clipped;
}

}  // namespace tccm::test
