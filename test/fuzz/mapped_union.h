#pragma once

#include <algorithm>
#include <deque>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "fuzz/promises.h"
#include "map/mapper.h"
#include "support/part_union.h"

namespace tccm::test {

/// Heights in quanta, by cell.
using HeightSet = std::set<std::pair<CellIndex, int>>;

inline void insertRuns(const std::vector<Run>& runs, HeightSet& heights) {
  for (const Run& run : runs) {
    for (int h = run.bottom; h < run.top; ++h) heights.insert({run.cell, h});
  }
}

/// The order and bounds of a map's cuboids, whatever was fed.
inline void requireWellFormed(const CuboidMap& map) {
  const Grid::Config& grid = map.grid.config();
  const Cuboid* before = nullptr;
  promise(map.cell_begin.size() == map.grid.cells() + std::size_t{1}, "the map lacks its index");
  for (const Cuboid& cuboid : map.cuboids) {
    promise(cuboid.cell < map.grid.cells(), "a cuboid lies outside the grid");
    promise(cuboid.bottom < cuboid.top, "a cuboid is empty");
    promise(map.grid.metres(cuboid.bottom) > grid.height_min_m - 1e-9, "a cuboid lies too low");
    promise(map.grid.metres(cuboid.top) < grid.height_max_m + 1.01 * grid.height_quantum_m,
            "a cuboid lies too high");
    promise(cuboid.points > 0, "a cuboid is of no return");
    promise(!(cuboid.held && cuboid.appeared), "what is held has appeared");
    promise(!before || before->cell < cuboid.cell ||
                (before->cell == cuboid.cell && before->top <= cuboid.bottom),
            "cuboids overlap, or are out of order");
    before = &cuboid;
  }
  for (CellIndex cell = 0; cell < map.grid.cells(); ++cell) {
    for (std::uint32_t i = map.cell_begin[cell]; i < map.cell_begin[cell + 1]; ++i) {
      promise(map.cuboids.at(i).cell == cell, "the map's index is wrong");
    }
  }
}

/// Follows a mapper by brute force: its live map is the union of the part maps of its window, what
/// it holds was in one, what is left out is counted.
class MappedUnion {
 public:
  explicit MappedUnion(const Mapper::Config& config) : config_(config), grid_(config.map.grid) {}

  /// @param outcome what the mapper made of the scan.
  void follow(const ScanReturns& scan, const Mapper::Outcome& outcome, const Mapper& mapper) {
    const std::string expected = dropped(scan);
    promise(outcome.dropped == expected,
            "dropped as '" + outcome.dropped + "', not '" + expected + "'");
    if (!expected.empty()) return;
    newest_ = scan.stamp;
    ++serial_;
    parts_.push_back({scan.stamp, mappedReturns(grid_, scan.points), true});
    const IntegrationMap::Added& added = outcome.added;
    const std::size_t counted = added.mapped + added.out_of_area + added.forgotten;
    const std::size_t inside = parts_.back().returns.size();
    promise(counted <= scan.points.size(), "more returns are counted than there were");
    promise(added.out_of_area == scan.points.size() - inside, "returns outside are miscounted");
    promise(added.forgotten == 0, "returns are forgotten that nobody asked to");
    parts_.back().is_whole = added.mapped == inside;
    const bool has_room = mapper.map().returns() <= config_.map.returns_max;
    promise(has_room, "more returns are in the window than may be");
    if (parts_.size() > config_.map.scans_max) expireOldest();
    expire(mapper);
    promise(mapper.map().scans() == parts_.size(), "another number of scans is in the window");
  }

  void require(const CuboidMap& map) const {
    requireWellFormed(map);
    if (parts_.empty()) return promise(map.cuboids.empty(), "there are cuboids of no scan");
    promise(map.stamp == newest_ && map.serial == serial_, "stamp or serial are not the newest's");
    promise(map.window_scans == parts_.size(), "window_scans is wrong");
    promise(map.window == newest_ - parts_.front().stamp, "the window's length is wrong");
    const bool is_whole =
        std::all_of(parts_.begin(), parts_.end(), [](const Part& part) { return part.is_whole; });
    promise(is_whole || map.overflowed, "returns were left out, and nobody is told");
    std::vector<Run> live, held;
    for (const Cuboid& c : map.cuboids) {
      (c.held ? held : live).push_back({c.cell, c.bottom, c.top, c.points});
    }
    const std::vector<Run> expected = expectedRuns();
    if (is_whole) {
      promise(live == expected, "the live map is not the union of its window: " + textOf(live) +
                                    " in place of " + textOf(expected));
    }
    requireWithin(live, expected, "the live map has what no scan of the window saw");
    requireHeld(map, held);
  }

 private:
  struct Part {
    Time stamp;
    std::vector<MappedReturn> returns;
    bool is_whole;
  };

  /// By the rule, and starts over where time jumps back.
  std::string dropped(const ScanReturns& scan) {
    if (!scan.viewpoint.allFinite() || !std::isfinite(scan.tilt)) return "bad_viewpoint";
    const bool is_first = parts_.empty() && past_.empty() && !newest_known_;
    if (!is_first && newest_ - scan.stamp > fromSeconds(config_.time_jump_back_s)) {
      parts_.clear();
      past_.clear();
      newest_known_ = true;
      return {};
    }
    if (!is_first && scan.stamp <= newest_) return "out_of_order";
    newest_known_ = true;
    return {};
  }
  void expireOldest() {
    insertRuns(clipped({parts_.front().returns}), past_);
    parts_.pop_front();
  }
  void expire(const Mapper& mapper) {
    if (config_.window_scans > 0) {
      while (parts_.size() > static_cast<std::size_t>(config_.window_scans)) expireOldest();
      return;
    }
    const auto window = mapper.window();
    while (window && newest_ - parts_.front().stamp > *window) expireOldest();
  }
  [[nodiscard]] std::vector<Run> clipped(
      const std::deque<std::vector<MappedReturn>>& part_maps) const {
    const int thickness = grid_.heightOf(config_.map.thickness_m);
    const int lowest = grid_.heightCeil(config_.map.grid.height_min_m - 1e-9);
    return clippedAt(lowest, unionOf(part_maps, thickness));
  }
  [[nodiscard]] std::vector<Run> expectedRuns() const {
    std::deque<std::vector<MappedReturn>> part_maps;
    for (const Part& part : parts_) part_maps.push_back(part.returns);
    return clipped(part_maps);
  }
  static void requireWithin(const std::vector<Run>& runs, const std::vector<Run>& expected,
                            const std::string& what) {
    HeightSet may_be;
    insertRuns(expected, may_be);
    for (const Run& run : runs) {
      for (int h = run.bottom; h < run.top; ++h) promise(may_be.count({run.cell, h}) > 0, what);
    }
  }
  void requireHeld(const CuboidMap& map, const std::vector<Run>& held) const {
    promise(held.empty() || config_.hold.longest_s > 0.0, "something is held");
    promise(held.size() <= config_.hold.intervals_max, "more is held than may be");
    for (const Run& run : held) {
      for (int h = run.bottom; h < run.top; ++h) {
        promise(past_.count({run.cell, h}) > 0, "what is held was in no scan");
      }
    }
    promise(map.hold == fromSeconds(config_.hold.longest_s), "the map's hold is wrong");
  }
  static std::string textOf(const std::vector<Run>& runs) {
    std::ostringstream text;
    for (const Run& run : runs) text << run << ", ";
    return text.str();
  }

  Mapper::Config config_;
  Grid grid_;
  std::deque<Part> parts_;  ///< of the window
  HeightSet past_;          ///< what the scans saw that have left it
  Time newest_;
  bool newest_known_ = false;
  std::uint32_t serial_ = 0;
};

}  // namespace tccm::test
