#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "config/parameter_table.h"
#include "map/appearances.h"
#include "map/held_layer.h"
#include "map/integration_map.h"
#include "map/place_ages.h"
#include "map/self_share.h"
#include "map/tilt_period.h"
#include "sight/look_map.h"
#include "sight/newest_looks.h"
#include "tccm_monitor/cuboid_map.h"

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
    std::size_t support_points = 1;
    std::size_t intervals_max = 20000;

    void describe(ParameterTable& table);
  };

  /// Allocates all that it will ever use. @throws ConfigError
  Hold(const Config& config, const IntegrationMap& map, const LookMap& looks);

  [[nodiscard]] bool active() const { return config_.longest_s > 0.0; }
  /// Follows the map's newest scan: lets go of what it saw the place of, be it there or not.
  /// @param looks up to that scan.
  void follow(const ScanReturns& scan, const IntegrationMap& map, const LookMap& looks);
  /// The map's oldest scan leaves, and with it what no other has seen; where nobody looked at the
  /// place of that since, it is held. @param now stamp of the newest scan.
  void expireOldest(IntegrationMap& map, const LookImage& looks, Time now);
  /// Lets go of the heights that may lie in the region, as IntegrationMap::forget() judges them; of
  /// what is held only those are known, not its returns.
  void forget(const Region& region, const IntegrationMap& map);
  void clear();

  [[nodiscard]] const HeldLayer& held() const { return held_; }
  [[nodiscard]] HeldLayer& held() { return held_; }
  /// Something that is still in the window's time, or would be held yet, was not for want of room.
  [[nodiscard]] bool overflowed(const IntegrationMap& map) const {
    return lost_serial_ && (map.serial() - *lost_serial_ < map.scans() ||
                            map.newestStamp() - lost_at_ < fromSeconds(config_.longest_s));
  }
  [[nodiscard]] std::size_t memoryBytes() const {
    return newest_looks_.memoryBytes() + held_.memoryBytes() + bytesOf(viewpoints_) +
           asked_.memoryBytes();
  }

 private:
  [[nodiscard]] Vector3& viewpointOf(std::uint32_t serial) {
    return viewpoints_[serial % viewpoints_.size()];
  }
  void noteLoss(const IntegrationMap& map);
  void askWhereChanged(const LookMap& looks);
  void releaseSeen(const ScanReturns& scan, const IntegrationMap& map, const LookImage& looks);
  [[nodiscard]] bool mayBeInView(const HeldLayer::Interval& held, const Glance& glance,
                                 const LookImage& looks) const;
  [[nodiscard]] std::uint32_t heldAround(const Grid& grid, CellIndex cell,
                                         Columns::Heights heights) const;

  Config config_;
  NewestLooks newest_looks_;
  HeldLayer held_;
  std::vector<Vector3> viewpoints_;  ///< of the window's scans, by serial
  IndexSet asked_;  ///< directions in which the looks may have come to tell of a place
  Vector3 asked_from_ = Vector3::Zero();      ///< the viewpoint of these directions
  std::optional<std::uint32_t> lost_serial_;  ///< of the last scan when something could not be held
  Time lost_at_;                              ///< its stamp
};

/// Keeps the integration map over its window, the last sweep of the tilting sensor; beside it what
/// the sensor looked at, and what is held. Ages of places are kept by whoever shows them.
class Mapper {
 public:
  struct Config {
    IntegrationMap::Config map;
    TiltPeriod::Config tilt;
    int window_scans = 0;
    double window_s = 0.0;
    /// A place at a turning point is seen again only after a whole period (the paper's 3/4 are too
    /// short).
    double window_tilt_periods = 1.1;
    double tilt_period_min_s = 0.3;
    double scan_gap_max_s = 0.25;
    double time_jump_back_s = 0.1;  ///< time began anew, as when a recording is played again
    LookMap::Config looks;
    Hold::Config hold;
    Appearances::Config appearances;

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

  /// All of CuboidMap but the ages of places. Allocates nothing once `map` has been through
  /// reserve().
  void snapshot(CuboidMap& map);
  /// To the newest snapshot, once it is taken. @param ages have followed this map.
  void apply(PlaceAges& ages, CuboidMap& newest) { ages.apply(map_, newest); }
  void reserve(CuboidMap& map) const;

  [[nodiscard]] const IntegrationMap& map() const { return map_; }
  [[nodiscard]] const LookImage& looks() const { return looks_.image(); }
  /// What is held beside the map, in intervals.
  [[nodiscard]] std::size_t held() const { return hold_.held().intervals().size(); }
  /// The length of the window; nothing while the tilt period is not measured.
  [[nodiscard]] std::optional<Duration> window() const;
  [[nodiscard]] std::optional<Duration> tiltPeriod() const { return tilt_.period(); }
  /// Whether the tilt seems to turn more often than any tilt does: what is measured is not one.
  [[nodiscard]] bool tiltTooFast() const {
    return tilt_.period() && *tilt_.period() < fromSeconds(config_.tilt_period_min_s);
  }
  [[nodiscard]] std::size_t memoryBytes() const {
    return map_.memoryBytes() + looks_.memoryBytes() + hold_.memoryBytes() +
           self_share_.memoryBytes() + appearances_.memoryBytes();
  }

 private:
  [[nodiscard]] bool complete() const;
  [[nodiscard]] Duration lookPeriod() const;
  void followTilt(Time stamp, double tilt);
  void countSelf(const ScanReturns& scan);
  void expire();
  void expireOldest() { hold_.expireOldest(map_, looks_.image(), *newest_); }

  Config config_;
  IntegrationMap map_;
  LookMap looks_;
  Hold hold_;
  SelfShare self_share_;
  Appearances appearances_;
  TiltPeriod tilt_;
  std::optional<Duration> last_period_;  ///< of the tilt, also where it has stopped since
  bool tilt_stopped_ = false;            ///< and has not made a whole period again
  std::optional<Time> newest_;
  Time unbroken_since_;               ///< scans came without a gap, and the tilt did not stop
  std::optional<Time> last_expired_;  ///< the newest scan that has left the window
  Vector3 viewpoint_ = Vector3::Zero();
};

}  // namespace tccm
