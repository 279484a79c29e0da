#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "map/cuboid_map.h"
#include "map/held_layer.h"
#include "map/integration_map.h"
#include "map/place_ages.h"
#include "map/tilt_period.h"
#include "sight/look.h"
#include "sight/look_map.h"
#include "sight/newest_looks.h"
#include "tccm_monitor/time.h"

namespace tccm {

/// What the mapper takes of a scan.
struct ScanReturns {
  Time stamp;                           ///< of the first beam
  Vector3 viewpoint = Vector3::Zero();  ///< the sensor's origin at the last beam [m]
  double tilt = 0.0;                    ///< of the sensor at the first beam [rad]
  std::vector<Vector3> points;          ///< in the fixed frame [m]
  std::vector<Look> looks;              ///< what its beams say of the space along them
};

/// Keeps the integration map over its window, the last sweep of the tilting sensor; beside it what
/// the sensor looked at, and what left the window although nobody looked at its place again.
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
    /// What leaves the window is held for so long at most, unless its place is looked at, or looked
    /// through in its direction and all around it; 0: what leaves the window is gone.
    double hold_s = 10.0;
    double hold_look_angle_rad = 0.0175;  ///< a look within it of a place looks at the place
    /// But not where the robot, nearer than the place, was looked at within this angle of the look:
    /// at least what neighbouring scans are apart.
    double hold_outline_rad = 0.04;
    double hold_look_short_m = 0.05;  ///< a look that ends this much before saw it all the same
    std::size_t held_max = 20000;     ///< intervals

    /// @throws ConfigError
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
  /// What nobody waits for: follows the newest scan with the ages that dyn tells. To be called once
  /// the map is out; where it was not, the next scan does it.
  void settle();
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
  /// What is held beside the map, in intervals.
  [[nodiscard]] std::size_t held() const { return held_.size(); }
  /// The length of the window; nothing while the tilt period is not measured.
  [[nodiscard]] std::optional<Duration> window() const;
  [[nodiscard]] std::optional<Duration> tiltPeriod() const { return tilt_.period(); }
  [[nodiscard]] std::size_t memoryBytes() const;

 private:
  [[nodiscard]] bool complete() const;
  [[nodiscard]] Duration lookPeriod() const;
  void followTilt(Time stamp, double tilt);
  void look(const ScanReturns& scan);
  void expire();
  void expireOldest();
  void release(const ScanReturns& scan);
  [[nodiscard]] std::uint32_t heldAround(CellIndex cell, Columns::Heights heights) const;
  [[nodiscard]] Vector3 placeOf(CellIndex cell, Columns::Heights heights) const;
  [[nodiscard]] Vector3& viewpointOf(std::uint32_t serial) {
    return viewpoints_[serial % viewpoints_.size()];
  }

  Config config_;
  IntegrationMap map_;
  LookMap looks_;
  NewestLooks newest_looks_;
  HeldLayer held_;
  PlaceAges ages_;
  bool settled_ = true;                       ///< the ages follow the newest scan
  std::vector<Vector3> viewpoints_;           ///< of the window's scans, by serial
  std::optional<std::uint32_t> lost_serial_;  ///< of the last scan when something could not be held
  TiltPeriod tilt_;
  std::optional<Duration> last_period_;  ///< of the tilt, also where it has stopped since
  bool tilt_stopped_ = false;            ///< and has not made a whole period again
  std::optional<Time> newest_;
  Time unbroken_since_;               ///< scans came without a gap, and the tilt did not stop
  std::optional<Time> last_expired_;  ///< the newest scan that has left the window
  Vector3 viewpoint_ = Vector3::Zero();
};

}  // namespace tccm
