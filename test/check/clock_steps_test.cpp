#include "check/clock_steps.h"

#include <random>

#include "support/checker_fixture.h"

namespace tccm {
namespace {

using test::at;
using test::kScanPeriod;
using test::kStart;

constexpr int kCases = 20;

class ClockStepsTest : public test::CheckerFixture {
 protected:
  ClockStepsTest() {
    config_.permission.hold_until_reset = true;
    remake();
  }

  double draw(double from, double to) {
    return std::uniform_real_distribution<double>(from, to)(engine_);
  }
  /// As likely small as large.
  double drawOfAnyMagnitude(double from, double to) {
    return std::exp(draw(std::log(from), std::log(to)));
  }
  /// Scans and joints by one clock, every `period` on average, that never steps back.
  double runJittering(double from, double seconds, double period) {
    double now = from;
    for (; now < from + seconds; now += draw(0.0, 2.0 * period)) feedAndCheck(now, clear_);
    return now;
  }

  std::mt19937 engine_{19};
};

TEST_F(ClockStepsTest, WhatAwaitsAPersonsResetOutlivesAnyStepBack) {
  for (int i = 0; i < kCases; ++i) {
    remake();
    feedAndCheck(kStart, clear_);
    run(kStart + 0.1, kStart + 0.2, post_, 0.8);
    ASSERT_EQ(checker_->check(at(kStart + 0.2)).latched, Reason::kCollision);
    const double back = drawOfAnyMagnitude(0.15, 1000.0);
    const double begin = kStart + 0.2 - back;
    for (double now = begin; now < begin + 3.0; now += kScanPeriod) {
      EXPECT_TRUE(feedAndCheck(now, clear_).stop) << back << " s back";
    }
    const double end = begin + 3.5;
    EXPECT_EQ(run(begin + 3.0, end, clear_).reason, Reason::kAwaitingReset) << back << " s back";
    EXPECT_EQ(checker_->reset(), "");
    EXPECT_EQ(run(end + 0.1, end + 1.2, clear_).reason, Reason::kClear) << back << " s back";
  }
}

TEST_F(ClockStepsTest, AStepBackOfARobotThatMayMoveNeedsNoReset) {
  for (int i = 0; i < kCases; ++i) {
    remake();
    run(kStart, kStart + 0.5, clear_);
    const double begin = kStart + 0.5 - drawOfAnyMagnitude(0.15, 1000.0);
    const Verdict& verdict = run(begin, begin + 1.5, clear_);
    EXPECT_EQ(verdict.reason, Reason::kClear) << begin;
  }
}

TEST_F(ClockStepsTest, TwoSourcesOfTimeAreAFaultThatHolds) {
  for (int i = 0; i < kCases; ++i) {
    remake();
    run(kStart, kStart + 0.5, clear_);
    const double apart = drawOfAnyMagnitude(0.02, 1e6);
    const double period = draw(0.002, 0.005);
    double now = kStart + 0.5;
    for (; now < kStart + 1.5; now += period)
      feedAndCheck(now - (draw(0.0, 1.0) < 0.5) * apart, clear_);
    const Verdict& verdict = check(now);
    EXPECT_EQ(verdict.reason, Reason::kNoClock) << apart << " s apart";
    EXPECT_EQ(verdict.level, Level::kFault);
    EXPECT_NE(verdict.detail.find("two sources of /clock"), std::string::npos) << verdict.detail;
    EXPECT_NE(checker_->reset(), "") << "it lasts";
    EXPECT_EQ(run(now, now + 4.0, clear_).latched, Reason::kNoClock) << apart << " s apart";
    EXPECT_EQ(checker_->reset(), "");
    EXPECT_EQ(run(now + 4.1, now + 5.5, clear_).reason, Reason::kClear);
  }
}

TEST_F(ClockStepsTest, AClockThatJittersStepsOnceOrBeginsAnewEachSecondIsNone) {
  for (int i = 0; i < kCases; ++i) {
    ClockSteps steps;
    double now = kStart;
    const double period = draw(0.001, 0.02), length = draw(1.0, 3.0);
    for (int k = 0; k < 1000; ++k) {
      now += draw(0.0, 2.0 * period);
      if (now > kStart + std::max(length, 51.0 * period)) now = kStart;
      steps.add(at(now));
      EXPECT_FALSE(steps.goesToAndFro()) << k;
    }
    remake();
    const double end = runJittering(kStart, 1.2, period);
    EXPECT_EQ(checker_->check(at(end)).latched, Reason::kClear);
  }
}

}  // namespace
}  // namespace tccm
