// What is held along random streams, against the rule asked of all that is held after each scan.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "map/mapper.h"
#include "support/random.h"

namespace tccm {
namespace {

constexpr int kScans = 600;
constexpr Duration kScanPeriod = std::chrono::milliseconds(25);
const Vector3 kViewpoint(0.5, -0.2, 1.0);

Mapper::Config config() {
  Mapper::Config config;
  config.map.grid.origin_y_m = 0.0;
  config.map.grid.size_x_m = config.map.grid.size_y_m = 1.0;
  config.map.grid.cell_size_m = 0.05;
  config.map.returns_max = 100000;
  config.map.intervals_max = 10000;
  config.window_scans = 20;
  config.hold.longest_s = 3.0;
  return config;
}

class PlainHold {
 public:
  explicit PlainHold(const Mapper::Config& config)
      : config_(config),
        map_(config.map),
        looks_(config.looks),
        newest_looks_(config.hold.look_angle_rad, config.hold.outline_rad) {}

  void add(const ScanReturns& scan) {
    map_.add(scan.stamp, scan.points);
    looks_.add(scan.stamp, scan.looks, scan.is_whole);
    viewpoints_.push_back(scan.viewpoint);
    newest_looks_.add(map_.serial(), scan.looks, static_cast<std::uint32_t>(map_.scans()));
    for (const Vector3& p_fixed : scan.points) {
      if (const auto place = map_.grid().place(p_fixed)) cut(place->cell, map_.occupiedBy(*place));
    }
    const auto is_over = [&](const HeldLayer::Interval& i) {
      const Vector3 place = placeOf(i.cell, i.heights);
      return i.heights.bottom >= i.heights.top ||
             scan.stamp - i.since > fromSeconds(config_.hold.longest_s) ||
             newest_looks_.sawLast(place, scan.viewpoint, config_.hold.look_short_m) ||
             looks_.image().inViewSince(i.seen, place, -config_.hold.look_short_m);
    };
    held_.erase(std::remove_if(held_.begin(), held_.end(), is_over), held_.end());
    while (map_.scans() > static_cast<std::size_t>(config_.window_scans)) expireOldest(scan.stamp);
  }
  /// Cell, bottom, top, support, age, and how long ago it was seen [ms].
  using Row = std::array<std::int64_t, 6>;
  [[nodiscard]] std::vector<Row> rows() const {
    std::vector<Row> rows;
    for (const HeldLayer::Interval& i : held_) {
      rows.push_back({i.cell, i.heights.bottom, i.heights.top, i.support, map_.serial() - i.born,
                      (map_.newestStamp() - i.seen) / std::chrono::milliseconds(1)});
    }
    std::sort(rows.begin(), rows.end());
    return rows;
  }

 private:
  [[nodiscard]] Vector3 placeOf(CellIndex cell, Columns::Heights heights) const {
    const Eigen::Vector2d centre = map_.grid().centre(cell);
    return {centre.x(), centre.y(), map_.grid().metres(heights.bottom + heights.top) / 2.0};
  }
  void cut(CellIndex cell, Columns::Heights seen) {
    for (std::size_t i = held_.size(); i-- > 0;) {
      HeldLayer::Interval& held = held_[i];
      if (held.cell != cell || held.heights.top <= seen.bottom || held.heights.bottom >= seen.top) {
        continue;
      }
      HeldLayer::Interval above = held;
      above.heights.bottom = std::max(above.heights.bottom, seen.top);
      held.heights.top = std::min(held.heights.top, seen.bottom);
      held_.push_back(above);
    }
  }
  void expireOldest(Time now) {
    const Time seen = map_.oldestStamp();
    map_.expireOldest([&](const Columns::Interval& i) {
      const Columns::Heights heights = i.heights();
      const Vector3 place = placeOf(i.cell, heights);
      if (newest_looks_.sawSince(i.serial, place, viewpoints_[i.serial - 1],
                                 config_.hold.look_short_m) ||
          looks_.image().inViewSince(seen, place, -config_.hold.look_short_m)) {
        return;
      }
      const std::uint32_t points = std::max(1U, map_.pointsIn(i.cell, heights));
      std::uint32_t support = std::max(points, map_.pointsAround(i.cell, heights));
      map_.grid().visitAround(i.cell, [&](CellIndex cell) {
        for (const HeldLayer::Interval& near : held_) {
          const bool is_near = near.cell == cell && near.heights.bottom - 30 <= heights.top &&
                               heights.bottom - 30 <= near.heights.top;
          support += is_near ? near.points : 0;
        }
      });
      held_.push_back({i.cell, heights, points, support, i.serial, i.born, seen, now});
    });
  }

  Mapper::Config config_;
  IntegrationMap map_;
  LookMap looks_;
  NewestLooks newest_looks_;
  std::vector<Vector3> viewpoints_;  ///< by serial, from the first scan's on
  std::vector<HeldLayer::Interval> held_;
};

/// A floor of which each beam meets some height; an arm goes to and fro before it.
class Stream {
 public:
  Stream(unsigned seed, bool is_whole) : random_(seed), is_whole_(is_whole) {}

  ScanReturns next() {
    // It swings, and now and then drives on.
    if (random_.chance(0.02)) base_ += random_.point(0.03);
    const Vector3 viewpoint = base_ + random_.point(0.01);
    const double tilt = -0.9 + 0.5 * std::sin(0.15 * scans_), arm = 0.7 * std::sin(0.02 * scans_);
    ScanReturns scan;
    scan.stamp = Time(std::chrono::seconds(5)) + ++scans_ * kScanPeriod;
    scan.is_whole = is_whole_;
    scan.viewpoint = viewpoint + random_.point(0.002);
    for (int i = 0; i < 60; ++i) {
      const double azimuth = -1.0 + 2.0 / 59.0 * i;
      const double elevation = is_whole_ ? random_.uniform(-1.4, -0.4) : tilt;
      const Vector3 direction(std::sin(azimuth) * std::cos(elevation),
                              std::cos(azimuth) * std::cos(elevation), std::sin(elevation));
      const double range = (viewpoint.z() - 0.3 * random_.uniform(0.0, 1.0)) / -direction.z();
      const bool is_robot = std::abs(azimuth - arm) < 0.4 || random_.chance(0.02);
      const Seen what = is_robot              ? Seen::kRobot
                        : random_.chance(0.1) ? Seen::kUnclear
                        : random_.chance(0.1) ? Seen::kNothing
                                              : Seen::kSurface;
      scan.looks.push_back({viewpoint + random_.point(0.002),
                            viewpoint + (is_robot ? 0.5 : 1.0) * range * direction, what});
      if (what == Seen::kSurface) scan.points.push_back(scan.looks.back().end);
    }
    return scan;
  }

 private:
  test::Random random_;
  bool is_whole_;
  Vector3 base_ = kViewpoint;
  int scans_ = 0;
};

TEST(MapperHoldStreamsTest, HeldIsWhatTheRuleHoldsWhereAllIsAskedAfterEachScan) {
  for (unsigned seed = 0; seed < 6; ++seed) {
    const bool is_whole = seed % 3 == 2;
    Mapper mapper(config());
    PlainHold plain(config());
    Stream stream(seed, is_whole);
    CuboidMap map;
    std::size_t most = 0, released = 0, before = 0;
    for (int i = 0; i < kScans; ++i) {
      const ScanReturns scan = stream.next();
      ASSERT_EQ(mapper.add(scan).dropped, "");
      plain.add(scan);
      mapper.snapshot(map);
      std::vector<PlainHold::Row> rows;
      for (const Cuboid& c : map.cuboids) {
        if (c.held) rows.push_back({c.cell, c.bottom, c.top, c.points, c.age_scans, c.unseen_ms});
      }
      ASSERT_EQ(rows, plain.rows()) << "seed " << seed << ", scan " << i;
      most = std::max(most, rows.size());
      released += rows.size() < before ? 1 : 0;
      before = rows.size();
    }
    EXPECT_GT(most, 50U) << seed;
    EXPECT_GT(released, 50U) << seed;
  }
}

/// What one snapshot tells does not depend on when those before were taken.
TEST(MapperHoldStreamsTest, SnapshotsAreAlikeHoweverManyWereTakenBefore) {
  test::Random random(3);
  Mapper often(config()), seldom(config());
  Stream stream(11, false);
  std::array<CuboidMap, 2> maps;
  for (int i = 0; i < kScans; ++i) {
    const ScanReturns scan = stream.next();
    for (Mapper* mapper : {&often, &seldom}) {
      if (i == kScans / 2) mapper->clear();
      mapper->add(scan);
      if (i % 100 != 50) continue;
      const Pose place(Eigen::Translation3d(0.5, 0.4, 0.1));
      mapper->forget({{{Sphere{0.1}, place}, 0.02}}, scan.stamp);
    }
    often.snapshot(maps[static_cast<std::size_t>(i % 2)]);
    if (random.chance(0.8)) continue;
    CuboidMap fresh;
    seldom.snapshot(fresh);
    const CuboidMap& map = maps[static_cast<std::size_t>(i % 2)];
    ASSERT_EQ(map.cell_begin, fresh.cell_begin) << i;
    ASSERT_EQ(map.cuboids.size(), fresh.cuboids.size()) << i;
    for (std::size_t k = 0; k < fresh.cuboids.size(); ++k) {
      const Cuboid &a = map.cuboids[k], &b = fresh.cuboids[k];
      ASSERT_TRUE(a.cell == b.cell && a.bottom == b.bottom && a.top == b.top &&
                  a.points == b.points && a.age_scans == b.age_scans && a.held == b.held &&
                  a.unseen_ms == b.unseen_ms)
          << i;
    }
    for (std::size_t pixel = 0; pixel < fresh.looks.grid().pixels(); ++pixel) {
      for (std::size_t k = 0; k < LookImage::kPasses; ++k) {
        const auto &a = map.looks.passes(pixel)[k], &b = fresh.looks.passes(pixel)[k];
        ASSERT_TRUE(a.first == b.first && a.last == b.last && a.range_mm == b.range_mm &&
                    a.end == b.end && a.moved == b.moved)
            << i;
      }
    }
  }
}

}  // namespace
}  // namespace tccm
