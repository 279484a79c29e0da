#pragma once

#include <vector>

#include "map/region.h"
#include "tccm_monitor/time.h"

namespace tccm {

/// The regions whose returns are left out of scans that were under way when the map was told to
/// forget them. In doubt a return is mapped: at worst it stops the robot until it leaves the
/// window, and no region stays blind.
class ForgottenRegions {
 public:
  /// A scan stamped longer than this before a region's `until` is not held against the region: then
  /// the two are of different clocks, which must not make a part of the map blind for ever.
  static constexpr Duration kUnderWayMax = std::chrono::seconds(10);
  /// Of all regions together; the shapes that were added first make room.
  static constexpr std::size_t kShapesMax = kRegionShapesMax;

  ForgottenRegions();

  /// @param region valid. @param until stamp of the last scan that may still show it.
  void add(const Region& region, Time until);
  /// Chooses the regions for a scan, and drops those that are over. @pre stamps do not fall.
  /// @return whether there are any.
  bool begin(Time stamp);
  /// Whether one of the chosen regions has the point.
  [[nodiscard]] bool contains(const Vector3& p_fixed) const;
  void clear();
  /// Shapes that are remembered.
  [[nodiscard]] std::size_t size() const { return entries_.size(); }
  [[nodiscard]] std::size_t memoryBytes() const { return entries_.capacity() * sizeof(Entry); }

 private:
  struct Entry {
    RegionPart part;
    Time until;
    bool chosen;
  };
  std::vector<Entry> entries_;
};

}  // namespace tccm
