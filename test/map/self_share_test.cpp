#include "map/self_share.h"

#include <gtest/gtest.h>

#include <deque>

#include "map/mapper.h"
#include "support/random.h"
#include "support/small_map.h"

namespace tccm {
namespace {

constexpr double kScanPeriod = 0.025;  // [s]
constexpr Duration kPeriod = std::chrono::seconds(2);

Time atScan(int scan) { return Time(fromSeconds(100.0 + scan * kScanPeriod)); }

std::optional<double> shareAfter(int scans, std::size_t self, std::size_t others,
                                 Duration period = kPeriod) {
  SelfShare share(300);
  for (int i = 0; i < scans; ++i) share.add(atScan(i), self, others, period);
  return share.share();
}

TEST(SelfShareTest, IsKnownOnceAPeriodWasSeenThrough) {
  EXPECT_FALSE(shareAfter(70, 97, 3));
  EXPECT_DOUBLE_EQ(shareAfter(90, 97, 3).value(), 0.97);
  EXPECT_FALSE(shareAfter(1000, 97, 3, Duration::zero())) << "no period";
}

TEST(SelfShareTest, IsNotToldOfAPartOfAPeriodWhenThatIsMeasuredFirstNorAfterAPause) {
  SelfShare share(300);
  for (int i = 0; i < 30; ++i) share.add(atScan(i), 97, 3, Duration::zero());
  share.add(atScan(30), 97, 3, kPeriod);
  EXPECT_FALSE(share.share());
  for (int i = 31; i < 120; ++i) share.add(atScan(i), 97, 3, kPeriod);
  EXPECT_TRUE(share.share());
  for (int i = 400; i < 470; ++i) {
    share.add(atScan(i), 97, 3, kPeriod);
    EXPECT_FALSE(share.share()) << i;
  }
}

TEST(SelfShareTest, IsNotToldOfFewReturns) {
  EXPECT_FALSE(shareAfter(200, 49, 0));
  EXPECT_EQ(shareAfter(200, 50, 0), 1.0);
  EXPECT_FALSE(shareAfter(200, 0, 0));
}

TEST(SelfShareTest, IsThatOfTheLastPeriodByBruteForce) {
  test::Random random(1);
  for (int run = 0; run < 20; ++run) {
    SelfShare share(300);
    std::deque<std::pair<std::size_t, std::size_t>> last;
    const int scans = random.integer(85, 400);
    for (int i = 0; i < scans; ++i) {
      const auto self = static_cast<std::size_t>(random.integer(0, 100));
      const auto others = static_cast<std::size_t>(random.integer(30, 100));
      share.add(atScan(i), self, others, kPeriod);
      last.emplace_back(self, others);
      if (last.size() > 81) last.pop_front();  // from the newest 2 s back, both ends included
    }
    double self = 0.0, all = 0.0;
    for (const auto& [s, o] : last)
      self += static_cast<double>(s), all += static_cast<double>(s + o);
    EXPECT_NEAR(share.share().value(), self / all, 1e-12);
  }
}

TEST(SelfShareTest, TheMapHasThatOfItsArea) {
  Mapper::Config config = test::smallMapper();
  config.window_s = 1.0;
  Mapper mapper(config);
  const Vector3 inside(0.05, 0.05, 0.5), outside(50.0, 0.0, 0.5), viewpoint(0.0, 0.0, 1.0);
  for (int i = 0; i < 100; ++i) {
    ScanReturns scan;
    scan.stamp = atScan(i);
    for (int k = 0; k < 60; ++k) scan.looks.push_back({viewpoint, inside, Seen::kRobot});
    for (int k = 0; k < 500; ++k) scan.looks.push_back({viewpoint, outside, Seen::kRobot});
    scan.points.assign(20, inside);
    scan.points.resize(300, outside);
    for (const Vector3& p : scan.points) scan.looks.push_back({viewpoint, p, Seen::kSurface});
    mapper.add(scan);
  }
  EXPECT_DOUBLE_EQ(test::snapshotOf(mapper).self_share.value(), 0.75);
  mapper.clear();
  EXPECT_FALSE(test::snapshotOf(mapper).self_share);
}

TEST(SelfShareTest, TheFloorBelowTheAreaCounts) {
  Mapper::Config config = test::smallMapper();
  config.window_s = 1.0;
  Mapper mapper(config);
  const Vector3 inside(0.05, 0.05, 0.5), viewpoint(0.0, 0.0, 1.0);
  const Vector3 floor(0.05, 0.05, config.map.grid.height_min_m - 0.1);
  const Vector3 beside(50.0, 0.0, floor.z());
  for (int i = 0; i < 100; ++i) {
    ScanReturns scan;
    scan.stamp = atScan(i);
    for (int k = 0; k < 60; ++k) scan.looks.push_back({viewpoint, inside, Seen::kRobot});
    for (int k = 0; k < 20; ++k) scan.looks.push_back({viewpoint, floor, Seen::kSurface});
    for (int k = 0; k < 500; ++k) scan.looks.push_back({viewpoint, beside, Seen::kSurface});
    mapper.add(scan);
  }
  EXPECT_DOUBLE_EQ(test::snapshotOf(mapper).self_share.value(), 0.75);
}

TEST(SelfShareTest, OfACloudWithALookForManyPointsLooksAreComparedWithLooks) {
  Mapper::Config config = test::smallMapper();
  config.window_s = 1.0;
  Mapper mapper(config);
  const Vector3 inside(0.05, 0.05, 0.5), viewpoint(0.0, 0.0, 1.0);
  for (int i = 0; i < 100; ++i) {
    ScanReturns scan;
    scan.stamp = atScan(i);
    for (int k = 0; k < 57; ++k) scan.looks.push_back({viewpoint, inside, Seen::kRobot});
    for (int k = 0; k < 3; ++k) scan.looks.push_back({viewpoint, inside, Seen::kSurface});
    scan.points.assign(100, inside);
    mapper.add(scan);
  }
  EXPECT_DOUBLE_EQ(test::snapshotOf(mapper).self_share.value(), 0.95);
}

}  // namespace
}  // namespace tccm
