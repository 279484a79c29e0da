#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "check/surroundings.h"
#include "tccm_monitor/cuboid_map.h"

namespace tccm {

/// The maps of all sensors, and all that is occupied by any of them as one map.
///
/// Each sensor's cuboids are in it, but for those that another sensor has looked through since they
/// were seen last: time decides. So do those of a sensor that is not heard any more, as held ones,
/// for as long as its mapper would hold them; also those from before its map began anew. Of one
/// sensor alone its map is passed on as it is.
class SensorMaps {
 public:
  struct Source {
    std::shared_ptr<const CuboidMap> map;  ///< nothing: none came yet
    bool is_out = false;                   ///< nothing that is to be relied on comes any more
    /// The last map from before it was out: what came since may be wrong of what it saw.
    std::shared_ptr<const CuboidMap> seen;
  };

  /// @param sources one for each sensor, always of the same number. @param maps_changed false:
  /// they are those of the last call.
  void unite(Time now, const std::vector<Source>& sources, bool maps_changed);
  void clear();

  /// Nothing where no sensor has a map. Serials rise with each change.
  [[nodiscard]] const CuboidMap* all() const { return all_; }
  /// Of each sensor that ever saw something that is to be relied on.
  [[nodiscard]] const std::vector<SensorView>& each() const { return each_; }
  /// Whether two maps cover the same cells.
  [[nodiscard]] static bool fit(const CuboidMap& one, const CuboidMap& other) {
    return one.grid == other.grid;
  }

 private:
  /// Which maps count now, in counted_.
  void select(Time now, const std::vector<Source>& sources);
  void fill();
  void append(CellIndex cell, const Source& source);
  [[nodiscard]] bool isOverruled(const Cuboid& cuboid, const Source& by_source) const;

  std::vector<Source> sources_;  ///< that are in it; of one that is out, maybe its last two maps
  std::vector<Source> counted_;
  std::vector<std::shared_ptr<const CuboidMap>> kept_;  ///< those of each_
  std::vector<SensorView> each_;
  CuboidMap united_;
  const CuboidMap* all_ = nullptr;
};

}  // namespace tccm
