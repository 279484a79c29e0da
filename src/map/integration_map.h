#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "config/parameter_table.h"
#include "map/columns.h"
#include "map/cuboid_list.h"
#include "map/held_layer.h"
#include "map/region.h"
#include "map/window_returns.h"
#include "tccm_monitor/cuboid_map.h"

namespace tccm {

/// The time-series composite cuboid map by replacement (paper, section III.C.2): the newest part
/// map is added, the oldest subtracted, at a cost that does not grow with the window.
///
/// After every step the occupied heights of each cell are exactly the union of the part maps of
/// the scans in the window. A return at height z occupies (z - thickness, z], of which nothing
/// counts below height_min_m, and at least the first quantum above it.
class IntegrationMap {
 public:
  struct Config {
    Grid::Config grid;
    double thickness_m = 0.02;          ///< d0, at least a quantum
    std::size_t scans_max = 512;        ///< longest window
    std::size_t returns_max = 4000000;  ///< in the window
    std::size_t intervals_max = 200000;

    void describe(ParameterTable& table);
    void validate() const { grid.validate(); }  ///< @throws ConfigError
  };

  using Added = AddedReturns;

  /// Allocates everything it will ever use. @param held_max intervals of what is held that
  /// snapshots may have beside it. @throws ConfigError
  explicit IntegrationMap(const Config& config, std::size_t held_max = 0);

  /// Adds a scan's part map; its serial is one more than the last scan's. Where scans_max are in
  /// the window already, the oldest leaves first.
  /// @param returns in the fixed frame; those that are not finite count as out of the area.
  Added add(Time stamp, const std::vector<Vector3>& returns);
  /// Subtracts the oldest scan's part map. @pre scans() > 0
  void expireOldest() {
    expireOldest([](const Columns::Interval&) {});
  }
  /// The same. @param visit (Columns::Interval): is shown each interval that leaves with it, as no
  /// scan of the window has seen it any more: once, while all returns still count.
  template <typename Visit>
  void expireOldest(Visit&& visit) {
    columns_.expire(ring_.oldestSerial(), visit);
    ring_.visitOldest([this](const MappedReturn& e) {
      counts_.remove(e.cell, e.height);
      list_.changed().insert(e.cell);
    });
    ring_.dropOldest();
  }
  static constexpr double kSupportHeight = 0.03;  ///< [m] within which returns support each other
  /// The window's returns in an interval, and those in the 3 x 3 cells around it within
  /// kSupportHeight, its own included.
  [[nodiscard]] std::uint32_t pointsIn(CellIndex cell, Columns::Heights heights) const;
  [[nodiscard]] std::uint32_t pointsAround(CellIndex cell, Columns::Heights heights) const;
  /// Takes the returns inside the region out of the window's part maps, at once, and leaves them
  /// out of scans that come later but are stamped up to `until` (see ForgottenRegions for its
  /// limits); from then on what is seen there counts as usual. The map stays the union of what
  /// remains, with the ages it had.
  ///
  /// Of a return in the window only the cell and the height are known. It leaves where the cell's
  /// centre at that height is within the padding plus half a cell's diagonal: so all that were
  /// inside leave, and none that was further away than the padding plus a cell's diagonal and a
  /// quantum. Returns of later scans are judged by their exact place.
  ///
  /// Where the pool of intervals runs out over it, more stays than should, and the map is
  /// overflowed. Costs a visit to every return of the window: for seldom use.
  /// @return how many returns left the window's part maps.
  /// @throws ConfigError where the region is not valid; then nothing has changed.
  std::size_t forget(const Region& region, Time until);
  /// How far a return may have been from its cell's centre at its height [m].
  [[nodiscard]] double placeDoubt() const;
  /// Forgets all scans, and what was to be forgotten of later ones; serials go on.
  void clear();

  /// The heights that a return occupies.
  [[nodiscard]] Columns::Heights occupiedBy(const MappedReturn& entry) const {
    return {static_cast<Height>(std::max(entry.height - thickness_, int{lowest_})),
            static_cast<Height>(std::max(int{entry.height}, lowest_ + 1))};
  }
  /// The least height that a return of a cuboid with this bottom can have.
  [[nodiscard]] Height lowestReturn(Height bottom) const {
    return bottom > lowest_ ? static_cast<Height>(bottom + thickness_) : counts_.lowest();
  }
  [[nodiscard]] Height thickness() const { return thickness_; }
  [[nodiscard]] std::size_t scans() const { return ring_.scans(); }
  /// Of all of them.
  [[nodiscard]] std::size_t returns() const { return ring_.returns(); }
  [[nodiscard]] const Config& config() const { return config_; }
  /// How often all was forgotten.
  [[nodiscard]] std::uint32_t beginnings() const { return beginnings_; }
  [[nodiscard]] Time oldestStamp() const { return ring_.oldestStamp(); }
  [[nodiscard]] Time newestStamp() const { return newest_stamp_; }
  [[nodiscard]] std::uint32_t serial() const { return serial_; }
  /// A bound was met, and points were left out, in a scan that is still in the window.
  [[nodiscard]] bool overflowed() const {
    return overflow_serial_ != 0 && serial_ - overflow_serial_ < ring_.scans();
  }
  [[nodiscard]] const Grid& grid() const { return grid_; }
  /// Of all scans in the window, in layers as thick as what a return occupies.
  [[nodiscard]] const ReturnCounts& returnCounts() const { return counts_; }
  /// Hands each of the newest scan's returns to visit. @pre scans() > 0
  template <typename Visit>
  void visitNewest(Visit&& visit) const {
    ring_.visitNewest(visit);
  }
  [[nodiscard]] std::size_t memoryBytes() const {
    return columns_.memoryBytes() + counts_.memoryBytes() + ring_.memoryBytes() +
           forgotten_.memoryBytes() + list_.memoryBytes() + bytesOf(losses_) +
           bytesOf(cloud_cells_.gathered, cloud_cells_.touched);
  }

  /// Writes cuboids, their dyn as it was told last, index, grid, stamp, serial, window and
  /// thickness; the rest is the caller's. Allocates nothing once `map` has been through reserve().
  /// Costs what has changed since the last one, and a little for each cuboid.
  /// @param held one and the same each time, apart from what is in this map: becomes cuboids of its
  /// own.
  void snapshot(CuboidMap& map, HeldLayer* held = nullptr);
  /// Of the newest snapshot's cuboids that may have changed since this was last called, and those
  /// in other cells, dyn becomes what dynOf (Cuboid) says; all others have theirs from then.
  template <typename DynOf>
  void tellDyn(const IndexSet& others, CuboidMap& newest, DynOf&& dynOf) {
    list_.tellDyn(others, newest, dynOf);
  }
  /// Gives a snapshot the capacity that any of this map's can need.
  void reserve(CuboidMap& map) const;

 private:
  void note(MappedReturn entry) {  // by value: read from memory as a whole, it would wait
    ring_.add(entry);
    counts_.add(entry.cell, entry.height);
    list_.changed().insert(entry.cell);
  }
  /// What forget() does to a cell.
  struct Loss {
    bool near = false;
    Columns::Heights heights = kNothing;  ///< from the lowest return lost to the highest
  };
  static constexpr Columns::Heights kNothing{std::numeric_limits<Height>::max(),
                                             std::numeric_limits<Height>::min()};

  class ScanBatch;
  class CloudBatch;
  /// What a cloud under way has gathered at each cell; nothing between calls of add().
  struct CloudCells {
    std::vector<Columns::Heights> gathered;
    std::vector<CellIndex> touched;
  };
  template <typename Batch>
  Added addAll(const std::vector<Vector3>& returns, bool may_forget, Batch batch);
  /// @pre ring and columns have room for them.
  template <typename Batch>
  void addChunk(const Vector3* begin, const Vector3* end, bool may_forget, Batch& batch,
                Added& added);
  void addEach(const Vector3* begin, const Vector3* end, bool may_forget, Added& added);
  void markCellsNear(const RegionPart& part);
  std::size_t removeReturns(const std::vector<RegionPart>& parts);
  void restoreColumns();
  void listLive(CellIndex cell, std::vector<CuboidList::Entry>& entries) const;

  Config config_;
  Grid grid_;
  Height thickness_;
  Height lowest_;  ///< what is below is out of the area
  Columns columns_;
  ReturnCounts counts_;
  PartMapRing ring_;
  ForgottenRegions forgotten_;
  CloudCells cloud_cells_;
  CuboidList list_;
  std::vector<Loss> losses_;  ///< by cell; none between calls of forget()
  std::uint32_t serial_ = 0;
  std::uint32_t overflow_serial_ = 0;  ///< of the last scan with points left out
  Time newest_stamp_;
  std::uint32_t beginnings_ = 0;
};

}  // namespace tccm
