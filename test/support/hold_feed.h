#pragma once

#include <gtest/gtest.h>

#include <set>
#include <utility>
#include <vector>

#include "map/mapper.h"
#include "support/small_map.h"

namespace tccm::test {

inline constexpr double kScanPeriod = 0.025;  // [s]
inline constexpr int kWindow = 4;             // scans
inline const Vector3 kViewpoint(0.1, 0.1, 1.5);
inline const Vector3 kPlace(0.15, 0.15, 0.5);

inline Time at(double seconds) { return Time(fromSeconds(seconds)); }

/// 10 x 10 cells; what leaves a window of four scans is held for a second.
inline Mapper::Config holdingMapper() {
  Mapper::Config config = smallMapper();
  config.hold.intervals_max = 1000;
  config.window_scans = kWindow;
  config.hold.longest_s = 1.0;
  return config;
}

/// Feeds scans, and lists what the map holds.
class Feed {
 public:
  explicit Feed(const Mapper::Config& config = holdingMapper()) : mapper_(config) {}

  void scan(const std::vector<Look>& looks = {}, int times = 1) {
    for (int i = 0; i < times; ++i) {
      ScanReturns scan;
      scan.stamp = at(kScanPeriod * ++scans_);
      scan.viewpoint = kViewpoint;
      scan.looks = looks;
      for (const Look& look : looks) {
        if (look.what == Seen::kSurface) scan.points.push_back(look.end);
      }
      EXPECT_EQ(mapper_.add(scan).dropped, "");
    }
  }
  /// The place is seen, and then no more until that scan has left the window.
  void seeOnce() {
    scan({{kViewpoint, kPlace, Seen::kSurface}});
    scan({}, kWindow);
  }
  std::size_t count(bool held) {
    mapper_.snapshot(map_);
    std::size_t count = 0;
    for (const Cuboid& cuboid : map_.cuboids) count += cuboid.held == held ? 1 : 0;
    return count;
  }
  std::size_t live() { return count(false); }
  std::size_t held() { return count(true); }
  const CuboidMap& map() { return count(true), map_; }
  Mapper& mapper() { return mapper_; }

 private:
  Mapper mapper_;
  CuboidMap map_;
  int scans_ = 0;
};

inline Look to(const Vector3& end, Seen what = Seen::kSurface) { return {kViewpoint, end, what}; }
/// Past a place, to so much of its distance.
inline Look past(const Vector3& place, double share, Seen what = Seen::kSurface) {
  return to(kViewpoint + share * (place - kViewpoint), what);
}

/// Heights in quanta, by cell.
using Occupied = std::set<std::pair<CellIndex, int>>;

inline Occupied occupiedBy(const CuboidMap& map, bool held) {
  Occupied occupied;
  for (const Cuboid& cuboid : map.cuboids) {
    if (cuboid.held != held) continue;
    for (int h = cuboid.bottom; h < cuboid.top; ++h) occupied.insert({cuboid.cell, h});
  }
  return occupied;
}

}  // namespace tccm::test
