#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "config/parameter_table.h"
#include "map/held_layer.h"
#include "map/integration_map.h"
#include "map/scan_returns.h"
#include "sight/newest_looks.h"
#include "tccm_monitor/look_image.h"

namespace tccm {

/// Keeps what leaves the window although nobody looked at its place again: what the robot hides is
/// no less there. Rule and reasons: docs/perception.md, docs/design.md.
class Hold {
 public:
  struct Config {
    double longest_s = 10.0;
    double look_angle_rad = 0.0175;
    double outline_rad = 0.04;
    double look_short_m = 0.05;
    std::size_t intervals_max = 20000;

    void describe(ParameterTable& table);
  };

  /// Allocates all that it will ever use. @throws ConfigError
  Hold(const Config& config, const IntegrationMap& map);

  [[nodiscard]] bool active() const { return config_.longest_s > 0.0; }
  /// Follows the map's newest scan: lets go of what it saw the place of, be it there or not.
  /// @param looks up to that scan.
  void follow(const ScanReturns& scan, const IntegrationMap& map, const LookImage& looks);
  /// The map's oldest scan leaves, and with it what no other has seen; where nobody looked at the
  /// place of that since, it is held. @param now stamp of the newest scan.
  void expireOldest(IntegrationMap& map, const LookImage& looks, Time now);
  /// After the last change; for layer().
  void sort() { held_.sort(); }
  /// Lets go of what may lie in the region.
  void forget(const Region& region, const IntegrationMap& map);
  void clear();

  [[nodiscard]] const HeldLayer& layer() const { return held_; }
  /// Something that is still in the window's time could not be held for want of room.
  [[nodiscard]] bool overflowed(const IntegrationMap& map) const {
    return lost_serial_ && map.serial() - *lost_serial_ < map.scans();
  }
  [[nodiscard]] std::size_t memoryBytes() const;

 private:
  [[nodiscard]] Vector3& viewpointOf(std::uint32_t serial) {
    return viewpoints_[serial % viewpoints_.size()];
  }
  [[nodiscard]] std::uint32_t heldAround(const Grid& grid, CellIndex cell,
                                         Columns::Heights heights) const;

  Config config_;
  NewestLooks newest_looks_;
  HeldLayer held_;
  std::vector<Vector3> viewpoints_;           ///< of the window's scans, by serial
  std::optional<std::uint32_t> lost_serial_;  ///< of the last scan when something could not be held
};

}  // namespace tccm
