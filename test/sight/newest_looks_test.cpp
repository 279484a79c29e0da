#include "sight/newest_looks.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "support/random.h"

namespace tccm {
namespace {

constexpr double kAngle = 0.0175;
constexpr double kOutline = 0.04;
constexpr std::uint32_t kOutlineScans = 60;
constexpr double kShort = 0.05;
const Vector3 kViewpoint(0.1, 0.0, 1.5);

Look looking(const Vector3& at, double range, Seen what = Seen::kSurface,
             const Vector3& viewpoint = kViewpoint) {
  return {viewpoint, viewpoint + range * (at - viewpoint).normalized(), what};
}

TEST(NewestLooksTest, APlaceIsSeenByALaterLookThatReachesIt) {
  const Vector3 place(0.8, 0.3, 0.75);
  const double distance = (place - kViewpoint).norm();
  NewestLooks looks(kAngle, kOutline);
  EXPECT_FALSE(looks.sawSince(0, place, kViewpoint, kShort));
  looks.add(7, {looking(place, distance + 1.0)}, kOutlineScans);
  EXPECT_TRUE(looks.sawSince(6, place, kViewpoint, kShort));
  EXPECT_FALSE(looks.sawSince(7, place, kViewpoint, kShort)) << "the scan itself is not later";
  looks.add(8, {looking(place, distance - 0.04)}, kOutlineScans);
  EXPECT_TRUE(looks.sawSince(7, place, kViewpoint, kShort)) << "a little short is good enough";
  looks.add(9, {looking(place, distance - 0.06)}, kOutlineScans);
  EXPECT_FALSE(looks.sawSince(8, place, kViewpoint, kShort)) << "something stands before it";
}

TEST(NewestLooksTest, ALookThatEndsOnTheRobotSeesNothingBehindAndHidesNoEarlierOne) {
  const Vector3 place(0.8, 0.3, 0.75);
  NewestLooks looks(kAngle, kOutline);
  looks.add(3, {looking(place, 2.0)}, kOutlineScans);
  looks.add(5, {looking(place, 2.0, Seen::kRobot)}, kOutlineScans);
  EXPECT_TRUE(looks.sawSince(2, place, kViewpoint, kShort));
  EXPECT_FALSE(looks.sawSince(4, place, kViewpoint, kShort));
}

TEST(NewestLooksTest, OfOneScanTheFarthestLookOfADirectionIsKept) {
  const Vector3 place(0.8, 0.3, 0.75);
  NewestLooks looks(kAngle, kOutline);
  looks.add(3, {looking(place, 2.0), looking(place, 0.3)}, kOutlineScans);
  EXPECT_TRUE(looks.sawSince(2, place, kViewpoint, kShort));
}

/// A place and looks above it, by so many radians, that go by or end on the robot halfway.
class OutlineTest : public testing::Test {
 protected:
  [[nodiscard]] Look passing(double above = 0.01) const { return above_by(above, 2.0); }
  [[nodiscard]] Look robot(double above = 0.03, double share = 0.5) const {
    return above_by(above, share * distance_, Seen::kRobot);
  }
  [[nodiscard]] bool saw(std::uint32_t since = 0) const {
    return looks_.sawSince(since, place_, kViewpoint, kShort);
  }
  void add(std::uint32_t serial, const std::vector<Look>& looks) {
    looks_.add(serial, looks, kOutlineScans);
  }

  const Vector3 place_ = kViewpoint + Vector3(0.8, 0.0, 0.0);
  const double distance_ = 0.8;
  NewestLooks looks_{kAngle, kOutline};

 private:
  [[nodiscard]] Look above_by(double angle, double range, Seen what = Seen::kSurface) const {
    return looking(kViewpoint + Vector3(std::cos(angle), 0.0, std::sin(angle)), range, what);
  }
};

TEST_F(OutlineTest, ALookBesideTheRobotsOutlineDoesNotTellWhatItHides) {
  add(1, {passing()});
  EXPECT_TRUE(saw());
  add(2, {robot(), passing()});
  EXPECT_FALSE(saw());
  add(3, {passing(-0.01)});
  EXPECT_FALSE(saw(2)) << "the line just below passes beside it too";
}

TEST_F(OutlineTest, WhatIsNearerThanTheRobotOrFarFromItsOutlineIsSeen) {
  add(1, {robot(0.03, 1.2), passing()});
  EXPECT_TRUE(saw());
  add(2, {robot(0.09), passing()});
  EXPECT_TRUE(saw(1));
}

TEST_F(OutlineTest, TheRobotMayBeSeenAFewScansAfterTheLookThatPassed) {
  for (const std::uint32_t after : {1U, 2U, 3U}) {
    looks_.clear();
    add(10, {passing()});
    ASSERT_TRUE(saw());
    add(10 + after, {robot()});
    EXPECT_FALSE(saw()) << after;
  }
  looks_.clear();
  add(10, {passing()});
  add(20, {robot()});
  EXPECT_TRUE(saw()) << "it was not there yet";
}

TEST_F(OutlineTest, AnOutlineStandsForSoManyScans) {
  add(100, {robot(0.02), robot(0.03)});
  add(100 + kOutlineScans, {passing()});
  EXPECT_FALSE(saw(100));
  add(101 + kOutlineScans, {passing()});
  EXPECT_TRUE(saw(100));
}

TEST(NewestLooksTest, SerialsMayWrap) {
  const Vector3 place(0.8, 0.3, 0.75);
  NewestLooks looks(kAngle, kOutline);
  looks.add(2, {looking(place, 2.0)}, kOutlineScans);
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
    looks.push_back({viewpoint, viewpoint + 1.5 * direction, Seen::kNothing});
  }
  return looks;
}

TEST(NewestLooksTest, TheLastScanAloneSawWhatItSawSinceTheOneBefore) {
  test::Random random(6);
  NewestLooks looks(kAngle, kOutline);
  int seen = 0, asked = 0;
  for (std::uint32_t serial = 1; serial < 300; ++serial) {
    const auto scan = scanAt(random.uniform(0.2, 1.3), random.uniform(-0.06, 0.06));
    looks.add(serial, scan, kOutlineScans);
    const Vector3& viewpoint = scan.back().viewpoint;
    for (int i = 0; i < 300; ++i) {
      const Vector3 place = viewpoint + random.uniform(0.2, 1.4) * random.direction();
      const bool saw = looks.sawSince(serial - 1, place, viewpoint, kShort);
      ASSERT_EQ(looks.sawLast(place, viewpoint, kShort), saw) << place.transpose();
      const bool may_see = looks.maySeeLast(place.cast<float>());
      ASSERT_TRUE(may_see || !saw) << place.transpose();
      seen += saw ? 1 : 0;
      asked += may_see ? 1 : 0;
    }
  }
  EXPECT_GT(seen, 300);
  EXPECT_LT(asked, 300 * 300 / 2);
}

TEST(NewestLooksTest, NoAnswerIsYesUnlessSomeLookSawThePlaceAndAloneEachLookIsFound) {
  test::Random random(4);
  for (int i = 0; i < 20000; ++i) {
    const Vector3 place = kViewpoint + random.point(1.0);
    const Vector3 viewpoint = kViewpoint + random.point(0.01);
    const Vector3 to_place = place - viewpoint;
    const Vector3 off = to_place.norm() * random.point(0.03);
    const Vector3 sight = (to_place + off) * random.uniform(0.8, 1.2);
    NewestLooks looks(kAngle, kOutline);
    looks.add(1, {{viewpoint, viewpoint + sight, Seen::kSurface}}, kOutlineScans);
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
