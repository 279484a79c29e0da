#include "map/tilt_period.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "support/random.h"
#include "support/shared_data.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

constexpr double kPeriod = 1.575;   // [s]
constexpr double kStep = 0.028;     // [s] between scans
constexpr double kAmplitude = 0.5;  // [rad]

Time atSeconds(double seconds) { return Time(fromSeconds(seconds)); }

/// Feeds tilt(t) from 0 to until [s].
TiltPeriod fed(const std::function<double(double)>& tilt, double until) {
  TiltPeriod tilt_period({});
  for (double t = 0.0; t <= until; t += kStep) tilt_period.add(atSeconds(t), tilt(t));
  return tilt_period;
}

double sine(double t) { return kAmplitude * std::sin(2.0 * M_PI * t / kPeriod); }

/// From -1 at phase 0 to 1 at phase 0.5 and back.
double triangle(double phase) {
  const double turn = phase - std::floor(phase);
  return turn < 0.5 ? 4.0 * turn - 1.0 : 3.0 - 4.0 * turn;
}

/// The stamps are those of scans: a turning point is known to one of them.
void expectPeriod(const TiltPeriod& tilt_period, double expected, double tolerance = kStep) {
  ASSERT_TRUE(tilt_period.period());
  EXPECT_NEAR(toSeconds(*tilt_period.period()), expected, tolerance + 1e-9);
}

TEST(TiltPeriodTest, ASineIsMeasuredToAScan) { expectPeriod(fed(sine, 10.0), kPeriod); }

TEST(TiltPeriodTest, ATriangleIsMeasuredToAScan) {
  expectPeriod(fed([](double t) { return kAmplitude * triangle(t / kPeriod); }, 10.0), kPeriod);
}

TEST(TiltPeriodTest, APlateauAtTheEndsBelongsToThePeriod) {
  const auto clipped = [](double t) {
    return std::clamp(kAmplitude * triangle(t / kPeriod), -0.35, 0.35);
  };
  expectPeriod(fed(clipped, 10.0), kPeriod);
}

TEST(TiltPeriodTest, UnequalStrokesAreOnePeriodTogether) {
  const auto sawtooth = [](double t) {
    const double phase = t / kPeriod - std::floor(t / kPeriod);
    return phase < 0.8 ? phase / 0.8 : (1.0 - phase) / 0.2;
  };
  expectPeriod(fed(sawtooth, 10.0), kPeriod);
}

TEST(TiltPeriodTest, NothingIsSaidBeforeTheFirstFullPeriod) {
  // The first highest point is at a quarter of a period, the next one a whole period later.
  TiltPeriod tilt_period({});
  for (double t = 0.0; t < 4.0 * kPeriod; t += kStep) {
    tilt_period.add(atSeconds(t), sine(t));
    if (t > 1.25 * kPeriod && t < 1.45 * kPeriod) continue;
    ASSERT_EQ(tilt_period.period().has_value(), t > 1.25 * kPeriod) << "at " << t;
  }
}

TEST(TiltPeriodTest, WhereTheTiltWasFirstSeenIsNoTurningPoint) {
  // It starts halfway up, near the top: one stroke down from there is no full stroke.
  const auto shifted = [](double t) { return sine(t + 0.15 * kPeriod); };
  expectPeriod(fed(shifted, 2.0 * kPeriod), kPeriod);
}

TEST(TiltPeriodTest, RepeatedAndReversedSmallStepsAreNoTurningPoints) {
  test::Random random(13);
  double last = 0.0;
  const auto stuttering = [&](double t) {
    if (!random.chance(0.3))
      last = kAmplitude * triangle(t / kPeriod) + random.uniform(-0.02, 0.02);
    return last;
  };
  expectPeriod(fed(stuttering, 20.0), kPeriod, 4.0 * kStep);
}

TEST(TiltPeriodTest, NoiseBelowTheHysteresisIsNoTilt) {
  test::Random random(14);
  EXPECT_FALSE(fed([&](double) { return 0.3 + random.uniform(-0.024, 0.024); }, 20.0).period());
}

TEST(TiltPeriodTest, AStandingSensorHasNoPeriod) {
  EXPECT_FALSE(fed([](double) { return -0.7; }, 20.0).period());
}

TEST(TiltPeriodTest, AOneWaySweepHasNoPeriod) {
  EXPECT_FALSE(fed([](double t) { return 0.1 * t; }, 20.0).period());
}

TEST(TiltPeriodTest, AChangedSpeedIsFollowedAndTheLongerOfTheTwoHolds) {
  const auto slowing = [](double t) {
    return kAmplitude * triangle(t < 4.0 ? t : 4.0 + (t - 4.0) / 2.0);
  };
  expectPeriod(fed(slowing, 4.0), 1.0);
  expectPeriod(fed(slowing, 10.0), 2.0);
}

TEST(TiltPeriodTest, AfterAResetTheFirstFullPeriodIsAwaitedAgain) {
  TiltPeriod tilt_period = fed(sine, 10.0);
  ASSERT_TRUE(tilt_period.period());
  tilt_period.reset();
  EXPECT_FALSE(tilt_period.period());
  for (double t = 0.0; t < 10.0; t += kStep) tilt_period.add(atSeconds(t), sine(t));
  expectPeriod(tilt_period, kPeriod);
}

TEST(TiltPeriodTest, ARecordedTiltIsMeasured) {
  const auto sweep = test::recordedSweep();
  if (!sweep) GTEST_SKIP() << "no recording " << test::kRecordedSweepFile << " in TCCM_SHARED_DATA";
  constexpr double kScanPeriod = 0.025;
  std::vector<double> tilts = sweep->tilts;
  const double period = 2.0 * kScanPeriod * static_cast<double>(tilts.size());
  TiltPeriod tilt_period({});
  double t = 0.0;
  for (int stroke = 0; stroke < 6; ++stroke) {
    for (const double tilt : tilts) tilt_period.add(atSeconds(t += kScanPeriod), tilt);
    std::reverse(tilts.begin(), tilts.end());
  }
  expectPeriod(tilt_period, period, 4.0 * kScanPeriod);
}

TEST(TiltPeriodTest, AHysteresisOfZeroOrNaNIsRefused) {
  for (const double bad : {0.0, -0.1, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_THROW(TiltPeriod({bad}), ConfigError);
  }
}

}  // namespace
}  // namespace tccm
