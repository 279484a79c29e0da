#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "map/integration_map.h"
#include "tccm_monitor/cuboid_map.h"
#include "tccm_monitor/look_image.h"
#include "tccm_monitor/time.h"

namespace tccm {

/// For how long the surroundings have been where they are: what Cuboid::dyn tells (paper, section
/// IV.C). The heights of a cell are cut into layers; a layer of a cell is a place.
///
/// A place with a return is known from then on, be it hidden or missed by the scans, until the
/// sensor looks through it. A cuboid is as old as most of the returns around it are, those of what
/// stands on it included: the lowest returns of a thing that was put on a table lie where the
/// table's own do.
///
/// All cells are judged once in half a window, some of them with each scan; ages count these
/// judgements. @pre one map, whose scans are followed one by one.
class PlaceAges {
 public:
  /// Allocates all that it will ever use.
  explicit PlaceAges(const IntegrationMap& map);

  /// Follows the map's newest scan: once each, when nobody waits for it any more. Where the map has
  /// forgotten all since, so does this. @param looks up to that scan.
  void follow(const IntegrationMap& map, const LookImage& looks);
  /// Sets dyn of every cuboid in the map's newest snapshot. Costs what has changed since the last.
  void apply(IntegrationMap& map, CuboidMap& newest);
  /// Knows of no place.
  void clear();
  [[nodiscard]] std::size_t memoryBytes() const {
    return bytesOf(seen_, known_, age_, kept_, stamps_) + judged_.memoryBytes();
  }

  /// The oldest that dyn tells; what is older is told so too.
  static constexpr std::uint32_t kWindowsMax = 127;

 private:
  /// Half windows.
  using Age = std::uint8_t;
  static constexpr Age kOldest = 2 * kWindowsMax;
  struct Place {
    CellIndex cell;
    std::size_t layer;
  };

  /// Returns around a place: all, those at least of an age, and those older than that.
  struct Around {
    std::uint32_t returns = 0, old = 0, older = 0;
  };

  /// What a place has.
  struct Known {
    Age age;
    std::uint32_t returns;
  };

  [[nodiscard]] std::size_t layerOf(Height height, const IntegrationMap& map) const;
  /// Layer by layer, as ReturnCounts.
  [[nodiscard]] std::size_t index(const Place& place) const {
    return place.layer * grid_.cells() + place.cell;
  }
  [[nodiscard]] Vector3 middleOf(const Place& place) const;
  [[nodiscard]] std::uint32_t returnsAt(const IntegrationMap& map, const Place& place) const;
  void judge(CellIndex cell, const IntegrationMap& map, const LookImage& looks);
  [[nodiscard]] bool isKept(const Place& place, const IntegrationMap& map, const LookImage& looks);
  [[nodiscard]] bool wasLookedThrough(const Place& place, const IntegrationMap& map,
                                      const LookImage& looks) const;
  [[nodiscard]] Time seenAround(std::size_t layer, const IntegrationMap& map) const;
  [[nodiscard]] Age ageAround(const Place& place, const IntegrationMap& map);
  void gatherAround(const Place& place, const IntegrationMap& map);
  [[nodiscard]] Around countAround(int age) const;
  [[nodiscard]] std::uint64_t keptFrom(const Place& place) const;
  [[nodiscard]] std::uint32_t windowsOf(const Cuboid& cuboid, const IntegrationMap& map) const;

  Grid grid_;
  int lowest_;           ///< height of the lowest layer [quanta]
  std::size_t counted_;  ///< of the layers that the map counts returns in, in one of these
  int layer_;            ///< thickness of a layer [quanta]
  std::size_t above_;    ///< layers above a place that are around it
  std::size_t layers_;   ///< of a cell
  std::vector<std::uint32_t> seen_;  ///< by place: serial of the newest scan with a return in it
  std::vector<Age> known_;           ///< by place: for how long; 0: it is not known
  std::vector<Age> age_;             ///< by place: of what is around it
  /// By cell, 64 layers each: seen lately, or known; so is each place with a return in the window.
  std::vector<std::uint64_t> kept_;
  std::size_t words_;                ///< of kept_ for a cell
  std::vector<Time> stamps_;         ///< of the newest scans, by serial
  std::vector<CellIndex> around_;    ///< the cell that is judged, and those beside it
  std::vector<Known> known_around_;  ///< the place that is judged, where returns are
  IndexSet judged_;                  ///< cells that were since apply()
  CellIndex next_ = 0;               ///< is judged next
  std::uint32_t beginnings_ = 0;     ///< of the map that is known
  double due_ = 0.0;                 ///< so many cells have to be judged
};

}  // namespace tccm
