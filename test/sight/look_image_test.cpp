#include "tccm_monitor/look_image.h"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include "support/random.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

using Kind = LookImage::Sight::Kind;

Time at(double seconds) { return Time(fromSeconds(seconds)); }

const Time kEpoch = at(100.0);
const Vector3 kViewpoint(0.0, 0.0, 1.0);
const Vector3 kAhead(1.0, 0.001, 0.001);  // in no border of pixels

/// An image whose passes straight ahead are these, the newest first.
LookImage ahead(LookImage::Pass newest, LookImage::Pass before = {}) {
  LookImage image;
  image.begin(kEpoch, kViewpoint);
  const std::size_t pixel = image.grid().pixelOf(kAhead);
  const int row = image.grid().rowOfPixel(pixel);
  image.edit(row, static_cast<int>(pixel) - row * image.grid().columns()) = {newest, before};
  return image;
}

Vector3 placeAhead(double metres) { return kViewpoint + metres * kAhead.normalized(); }

TEST(LookImageTest, AtFirstNobodyHasLookedAnywhere) {
  const LookImage image;
  EXPECT_TRUE(image.empty());
  EXPECT_EQ(image.at(kAhead, 0.0).kind, Kind::kNeverLooked);
  EXPECT_EQ(image.at(Vector3::Zero(), 0.0).kind, Kind::kNeverLooked) << "the viewpoint itself";
}

TEST(LookImageTest, WhatAPassReachedWasSeenThen) {
  const LookImage image = ahead({2000, 2500, 800, Seen::kSurface});
  for (const double metres : {0.1, 0.5, 0.799}) {
    const auto sight = image.at(placeAhead(metres), 0.0);
    EXPECT_EQ(sight.kind, Kind::kSeen) << metres;
    EXPECT_EQ(sight.stamp, at(102.5));
  }
  EXPECT_EQ(image.at(placeAhead(0.81), 0.0).kind, Kind::kBehind);
  EXPECT_EQ(image.at(placeAhead(0.84), 0.05).kind, Kind::kSeen) << "within the margin";
  EXPECT_EQ(image.at(kViewpoint - kAhead, 0.0).kind, Kind::kNeverLooked) << "the other way";
}

TEST(LookImageTest, BehindTheRobotThePassBeforeCounts) {
  const LookImage::Pass robot{3000, 3000, 400, Seen::kRobot};
  const auto seen = ahead(robot, {1000, 1000, 900, Seen::kNothing}).at(placeAhead(0.7), 0.0);
  EXPECT_EQ(seen.kind, Kind::kSeen);
  EXPECT_EQ(seen.stamp, at(101.0));
  EXPECT_EQ(*seen.looked, at(103.0));
  const auto hidden = ahead(robot, {1000, 1000, 500, Seen::kSurface}).at(placeAhead(0.7), 0.0);
  EXPECT_EQ(hidden.kind, Kind::kBehind);
  EXPECT_EQ(hidden.stamp, at(101.0));
  for (const Seen end : {Seen::kRobot, Seen::kNever}) {
    const auto unseen = ahead(robot, {1000, 1000, 500, end}).at(placeAhead(0.7), 0.0);
    EXPECT_EQ(unseen.kind, Kind::kUnclear);
    EXPECT_EQ(unseen.stamp, at(103.0));
  }
}

TEST(LookImageTest, BehindANewSurfaceItDoesNotCountWhatWasSeenBefore) {
  const LookImage image =
      ahead({3000, 3000, 400, Seen::kSurface}, {1000, 1000, 900, Seen::kNothing});
  EXPECT_EQ(image.at(placeAhead(0.7), 0.0).kind, Kind::kBehind);
}

/// Straight ahead and in the directions around it one pass, which ends so far away.
LookImage around(const LookImage::Pass& pass, int row_by = 0, int column_by = 0,
                 const LookImage::Pass& other = {}) {
  LookImage image;
  image.begin(kEpoch, kViewpoint);
  const auto pixel = static_cast<int>(image.grid().pixelOf(kAhead));
  const int row = image.grid().rowOfPixel(static_cast<std::size_t>(pixel));
  const int column = pixel - row * image.grid().columns();
  for (int r = row - 2; r <= row + 2; ++r) {
    for (int c = column - 2; c <= column + 2; ++c) image.edit(r, c)[0] = pass;
  }
  if (row_by != 0 || column_by != 0) image.edit(row + row_by, column + column_by)[0] = other;
  return image;
}

TEST(LookImageTest, APlaceIsInViewOnceItsDirectionAndThoseAroundItReachAsFar) {
  const LookImage::Pass far{2000, 2100, 900, Seen::kNothing};
  EXPECT_TRUE(around(far).inViewSince(at(101.9), placeAhead(0.8), 0.0));
  EXPECT_TRUE(around(far).inViewSince(at(101.9), placeAhead(0.94), 0.05));
  EXPECT_FALSE(around(far).inViewSince(at(101.9), placeAhead(1.0), 0.05)) << "not as far";
  EXPECT_FALSE(around(far).inViewSince(at(102.05), placeAhead(0.8), 0.0)) << "the pass goes on";
  for (const auto& [row, column] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
    const LookImage::Pass robot{2000, 2100, 400, Seen::kRobot},
        unclear{2000, 2100, 900, Seen::kUnclear};
    for (const auto& other : {robot, unclear, LookImage::Pass{}}) {
      EXPECT_FALSE(around(far, row, column, other).inViewSince(at(101.9), placeAhead(0.8), 0.0));
    }
  }
  EXPECT_FALSE(LookImage().inViewSince(at(0.0), placeAhead(0.8), 0.0));
}

/// Of copies that are brought up to date now and then, each by itself.
TEST(LookImageTest, CopiesOfWhatChangesAreAlikeHoweverLongAgoTheyWereMade) {
  test::Random random(8);
  LookImage image(0.1), other(0.1);
  std::vector<LookImage> copies(4, LookImage(0.1));
  for (LookImage::Ticks step = 1; step < 3000; ++step) {
    LookImage& edited = random.chance(0.8) ? image : other;
    const int row = random.integer(0, edited.grid().rows() - 1);
    const int column = random.integer(0, edited.grid().columns() - 1);
    edited.edit(row, column)[0] = {step, step, 100, Seen::kSurface};
    if (random.chance(0.01)) image.begin(at(step), kViewpoint);
    if (random.chance(0.01)) std::swap(image, other);
    if (random.chance(0.01)) image = other;
    if (random.chance(0.02)) copies[1].edit(row, column)[1] = {step, step, 200, Seen::kRobot};
    if (random.chance(0.5)) continue;
    LookImage& copy = copies[static_cast<std::size_t>(random.integer(0, 3))];
    const LookImage& from = random.chance(0.8) ? image : other;
    copy.copyFrom(from);
    ASSERT_EQ(copy.rowBegin(), from.rowBegin());
    ASSERT_EQ(copy.rowEnd(), from.rowEnd());
    for (std::size_t pixel = 0; pixel < from.grid().pixels(); ++pixel) {
      for (std::size_t k = 0; k < LookImage::kPasses; ++k) {
        const LookImage::Pass &a = copy.passes(pixel)[k], &b = from.passes(pixel)[k];
        ASSERT_TRUE(a.first == b.first && a.range_mm == b.range_mm && a.end == b.end) << step;
      }
    }
  }
}

TEST(LookImageTest, ACopyAnswersAsTheOriginalAndForgetsWhatItWas) {
  const LookImage image = ahead({2000, 2500, 800, Seen::kSurface});
  for (const double resolution : {0.035, 0.1}) {
    LookImage copy(resolution);
    copy.begin(at(1.0), Vector3::Zero());
    copy.edit(0, 3) = {LookImage::Pass{1, 1, 100, Seen::kRobot}, LookImage::Pass{}};
    copy.copyFrom(image);
    EXPECT_EQ(copy.grid().rows(), image.grid().rows());
    EXPECT_EQ(copy.viewpoint(), kViewpoint);
    EXPECT_EQ(copy.rowBegin(), image.rowBegin());
    EXPECT_EQ(copy.rowEnd(), image.rowEnd());
    EXPECT_EQ(copy.at(placeAhead(0.5), 0.0).stamp, at(102.5));
    for (std::size_t pixel = 0; pixel < image.grid().pixels(); ++pixel) {
      ASSERT_EQ(copy.passes(pixel)[0].end, image.passes(pixel)[0].end) << pixel;
    }
  }
}

TEST(LookImageTest, AResolutionThatIsNoneIsRefused) {
  EXPECT_THROW(LookImage(0.0), ConfigError);
  EXPECT_THROW(LookImage(1.0), ConfigError);
}

/// The same with passes in the direction beside it to the left.
LookImage withBeside(LookImage image, LookImage::Pass newest, LookImage::Pass before = {}) {
  const auto pixel = static_cast<int>(image.grid().pixelOf(kAhead));
  const int row = image.grid().rowOfPixel(static_cast<std::size_t>(pixel));
  const int column = pixel - row * image.grid().columns();
  image.edit(row, image.grid().wrapped(column + 1)) = {newest, before};
  return image;
}

constexpr Duration kPeriod = std::chrono::milliseconds(1600);
constexpr Duration kLate = std::chrono::milliseconds(200);

TEST(LookImageTest, TheNextLookIsAPeriodAfterOneThatReached) {
  const LookImage image =
      ahead({3000, 3000, 900, Seen::kSurface}, {2400, 2450, 900, Seen::kSurface});
  const Vector3 place = placeAhead(0.8);
  EXPECT_EQ(image.nextLook(place, 0.0, at(103.1), kPeriod, kLate), at(104.0));
  EXPECT_EQ(image.nextLook(place, 0.0, at(104.1), kPeriod, kLate), at(104.0)) << "a little late";
  EXPECT_EQ(image.nextLook(place, 0.0, at(104.3), kPeriod, kLate), at(104.6));
  EXPECT_EQ(image.nextLook(place, 0.0, at(104.9), kPeriod, kLate), std::nullopt) << "overdue";
  EXPECT_EQ(image.nextLook(placeAhead(1.0), 0.0, at(103.1), kPeriod, kLate), std::nullopt);
  EXPECT_TRUE(image.passedSince(at(102.9), place, 0.0));
  EXPECT_FALSE(image.passedSince(at(103.0), place, 0.0));
}

TEST(LookImageTest, WhatTheRobotHidTheDirectionBesideMayShowInTheSameStroke) {
  const LookImage own = ahead({3000, 3000, 400, Seen::kRobot});
  const Vector3 place = kViewpoint + 0.8 * Vector3(1.0, 0.028, 0.017).normalized();
  EXPECT_FALSE(own.passedSince(at(102.9), place, 0.0));
  const LookImage image = withBeside(own, {3040, 3040, 900, Seen::kSurface});
  EXPECT_TRUE(image.passedSince(at(102.9), place, 0.0));
  EXPECT_EQ(image.nextLook(place, 0.0, at(103.1), kPeriod, kLate), at(104.6))
      << "when its own direction is looked in";
}

TEST(LookImageTest, ALookBesideIsNoneBeforeThePlaceIsLookedAtItself) {
  const Vector3 place = placeAhead(0.8);
  const LookImage::Pass beside{3600, 3600, 900, Seen::kSurface};
  const LookImage image = withBeside(ahead({3000, 3000, 900, Seen::kSurface}), beside);
  EXPECT_FALSE(image.passedSince(at(103.1), place, 0.0));
  EXPECT_EQ(image.nextLook(place, 0.0, at(103.7), kPeriod, kLate), at(104.6));
  EXPECT_FALSE(withBeside(ahead({}), beside).passedSince(at(103.1), place, 0.0));
}

TEST(LookImageTest, ALookBesideIsNoneOfACamera) {
  const Vector3 place = kViewpoint + 0.8 * Vector3(1.0, 0.028, 0.017).normalized();
  const LookImage::Pass beside{3000, 3000, 900, Seen::kSurface};
  for (const LookImage::Ticks between : {33U, 400U}) {
    const LookImage own = ahead({3000, 3000, 400, Seen::kSurface},
                                {3000 - between, 3000 - between, 400, Seen::kSurface});
    EXPECT_EQ(withBeside(own, beside).passedSince(at(102.9), place, 0.0), between == 400U);
  }
}

TEST(LookImageTest, ACameraLooksAgainAFrameLater) {
  const auto dueAfter = [](LookImage::Ticks between) {
    const LookImage image = ahead({3000, 3000, 800, Seen::kSurface},
                                  {3000 - between, 3000 - between, 800, Seen::kSurface});
    return image.nextLook(placeAhead(0.5), 0.0, at(103.01), fromSeconds(0.3), fromSeconds(0.05));
  };
  EXPECT_EQ(dueAfter(33), at(103.033));
  EXPECT_EQ(dueAfter(99), at(103.099));
  EXPECT_EQ(dueAfter(100), at(103.2)) << "a tilt may be as fast: it comes back the other way";
}

}  // namespace
}  // namespace tccm
