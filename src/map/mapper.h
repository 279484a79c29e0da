#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "config/parameter_table.h"
#include "map/hold.h"
#include "map/integration_map.h"
#include "map/scan_returns.h"
#include "map/tilt_period.h"
#include "sight/look_map.h"
#include "tccm_monitor/cuboid_map.h"

namespace tccm {

/// Keeps the integration map over its window, the last sweep of the tilting sensor; beside it what
/// the sensor looked at, and what is held. Ages of places are kept by whoever shows them.
class Mapper {
 public:
  struct Config {
    IntegrationMap::Config map;
    TiltPeriod::Config tilt;
    /// The window's length: this many scans; where 0, window_s; where that is 0 too, so many
    /// measured tilt periods. A place at a turning point is seen again only after a whole period
    /// (the paper's 3/4 are too short).
    int window_scans = 0;
    double window_s = 0.0;
    double window_tilt_periods = 1.1;
    /// After a longer gap between two scans the window has to fill again.
    double scan_gap_max_s = 0.25;
    /// A scan older than the last by more than this means that time began anew, as when a recording
    /// is played again: the map starts over.
    double time_jump_back_s = 0.1;
    LookMap::Config looks;
    Hold::Config hold;

    void describe(ParameterTable& table);
    /// @throws ConfigError where two values contradict each other.
    void validate() const;
  };

  struct Outcome {
    /// Why nothing was mapped: out_of_order or bad_viewpoint; empty where the scan is in the map.
    std::string dropped;
    IntegrationMap::Added added;
  };

  /// @throws ConfigError
  explicit Mapper(const Config& config);

  /// A scan that is not newer than the last is dropped, unless time jumped back.
  Outcome add(const ScanReturns& scan);
  /// Takes a region out of the map, and out of scans stamped up to `until` that are still to come:
  /// what was grasped is no longer a part of the surroundings. See IntegrationMap::forget(). A jump
  /// back in time ends it.
  /// @return how many returns left the map.
  /// @throws ConfigError where the region is not valid; then nothing has changed.
  std::size_t forget(const Region& region, Time until);
  /// Forgets scans, looks, tilt and regions, as at the start; serials go on.
  void clear();

  /// All of CuboidMap. Allocates nothing once `map` has been through reserve().
  void snapshot(CuboidMap& map) const;
  void reserve(CuboidMap& map) const;

  [[nodiscard]] const IntegrationMap& map() const { return map_; }
  [[nodiscard]] const LookImage& looks() const { return looks_.image(); }
  /// What is held beside the map, in intervals.
  [[nodiscard]] std::size_t held() const { return hold_.layer().size(); }
  /// The length of the window; nothing while the tilt period is not measured.
  [[nodiscard]] std::optional<Duration> window() const;
  [[nodiscard]] std::optional<Duration> tiltPeriod() const { return tilt_.period(); }
  [[nodiscard]] std::size_t memoryBytes() const;

 private:
  [[nodiscard]] bool complete() const;
  [[nodiscard]] Duration lookPeriod() const;
  void followTilt(Time stamp, double tilt);
  void expire();
  void expireOldest() { hold_.expireOldest(map_, looks_.image(), *newest_); }

  Config config_;
  IntegrationMap map_;
  LookMap looks_;
  Hold hold_;
  TiltPeriod tilt_;
  std::optional<Duration> last_period_;  ///< of the tilt, also where it has stopped since
  bool tilt_stopped_ = false;            ///< and has not made a whole period again
  std::optional<Time> newest_;
  Time unbroken_since_;               ///< scans came without a gap, and the tilt did not stop
  std::optional<Time> last_expired_;  ///< the newest scan that has left the window
  Vector3 viewpoint_ = Vector3::Zero();
};

}  // namespace tccm
