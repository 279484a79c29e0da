#include "tccm_monitor/map/newest_looks.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "support/random.h"

namespace tccm {
namespace {

constexpr double kAngle = 0.0175;
constexpr double kShort = 0.05;
const Vector3 kViewpoint(0.1, 0.0, 1.5);

Look looking(const Vector3& at, double range, Look::End what = Look::End::kSurface,
             const Vector3& viewpoint = kViewpoint) {
  return {viewpoint, viewpoint + range * (at - viewpoint).normalized(), what};
}

TEST(NewestLooksTest, APlaceIsSeenByALaterLookThatReachesIt) {
  const Vector3 place(0.8, 0.3, 0.75);
  const double distance = (place - kViewpoint).norm();
  NewestLooks looks(kAngle);
  EXPECT_FALSE(looks.sawSince(0, place, kViewpoint, kShort));
  looks.add(7, {looking(place, distance + 1.0)});
  EXPECT_TRUE(looks.sawSince(6, place, kViewpoint, kShort));
  EXPECT_FALSE(looks.sawSince(7, place, kViewpoint, kShort)) << "the scan itself is not later";
  looks.add(8, {looking(place, distance - 0.04)});
  EXPECT_TRUE(looks.sawSince(7, place, kViewpoint, kShort)) << "a little short is good enough";
  looks.add(9, {looking(place, distance - 0.06)});
  EXPECT_FALSE(looks.sawSince(8, place, kViewpoint, kShort)) << "something stands before it";
}

TEST(NewestLooksTest, ALookThatEndsOnTheRobotSeesNothingBehindAndHidesNoEarlierOne) {
  const Vector3 place(0.8, 0.3, 0.75);
  NewestLooks looks(kAngle);
  looks.add(3, {looking(place, 2.0)});
  looks.add(5, {looking(place, 2.0, Look::End::kRobot)});
  EXPECT_TRUE(looks.sawSince(2, place, kViewpoint, kShort));
  EXPECT_FALSE(looks.sawSince(4, place, kViewpoint, kShort));
}

TEST(NewestLooksTest, OfOneScanTheFarthestLookOfADirectionIsKept) {
  const Vector3 place(0.8, 0.3, 0.75);
  NewestLooks looks(kAngle);
  looks.add(3, {looking(place, 2.0), looking(place, 0.3)});
  EXPECT_TRUE(looks.sawSince(2, place, kViewpoint, kShort));
}

TEST(NewestLooksTest, SerialsMayWrap) {
  const Vector3 place(0.8, 0.3, 0.75);
  NewestLooks looks(kAngle);
  looks.add(2, {looking(place, 2.0)});
  EXPECT_TRUE(looks.sawSince(0xFFFFFFF0U, place, kViewpoint, kShort));
}

/// The looks of a scan whose plane turns by so much from its first to its last.
std::vector<Look> scanAt(double tilt, double turn) {
  std::vector<Look> looks;
  for (int i = 0; i < 200; ++i) {
    const double azimuth = 0.02 * (i - 100), now = tilt + turn * i / 200.0;
    const Vector3 direction(std::cos(azimuth) * std::cos(now), std::sin(azimuth),
                            -std::cos(azimuth) * std::sin(now));
    const Vector3 viewpoint = kViewpoint + 0.02 * Vector3(std::sin(now), 0.0, std::cos(now));
    looks.push_back({viewpoint, viewpoint + 1.5 * direction, Look::End::kNothing});
  }
  return looks;
}

TEST(NewestLooksTest, TheLastScanAloneSawWhatItSawSinceTheOneBefore) {
  test::Random random(6);
  NewestLooks looks(kAngle);
  int seen = 0;
  for (std::uint32_t serial = 1; serial < 300; ++serial) {
    const auto scan = scanAt(random.uniform(0.2, 1.3), random.uniform(-0.06, 0.06));
    looks.add(serial, scan);
    const Vector3& viewpoint = scan.back().viewpoint;
    for (int i = 0; i < 300; ++i) {
      const Vector3 place = viewpoint + random.uniform(0.2, 1.4) * random.direction();
      const bool saw = looks.sawSince(serial - 1, place, viewpoint, kShort);
      ASSERT_EQ(looks.sawLast(place, viewpoint, kShort), saw) << place.transpose();
      seen += saw ? 1 : 0;
    }
  }
  EXPECT_GT(seen, 300);
}

TEST(NewestLooksTest, NoAnswerIsYesUnlessSomeLookSawThePlaceAndAloneEachLookIsFound) {
  test::Random random(4);
  for (int i = 0; i < 20000; ++i) {
    const Vector3 place = kViewpoint + random.point(1.0);
    const Vector3 viewpoint = kViewpoint + random.point(0.01);
    const Vector3 to_place = place - viewpoint;
    const Vector3 off = to_place.norm() * random.point(0.03);
    const Vector3 sight = (to_place + off) * random.uniform(0.8, 1.2);
    NewestLooks looks(kAngle);
    looks.add(1, {{viewpoint, viewpoint + sight, Look::End::kSurface}});
    const double angle = std::atan2(to_place.cross(sight).norm(), to_place.dot(sight));
    const double spare = sight.norm() - (to_place.norm() - kShort);
    if (std::abs(angle - kAngle) < 1e-4 || std::abs(spare) < 1e-4) continue;  // float rounding
    const bool saw = angle < kAngle && spare > 0.0;
    ASSERT_EQ(looks.sawSince(0, place, viewpoint, kShort), saw) << place.transpose();
    if (!saw) {
      ASSERT_FALSE(looks.sawSince(0, place, kViewpoint, kShort)) << "from elsewhere neither";
    }
  }
}

}  // namespace
}  // namespace tccm
