/// What scans do before they reach the map; all else that is missing is asked of Checker's tests.

#include "check/check_inputs.h"

#include <gtest/gtest.h>

#include "support/checker_fixture.h"

namespace tccm {
namespace {

using test::at;
using test::kScanPeriod;
using test::kStart;
using Outcome = ScanReport::Outcome;

class CheckInputsTest : public test::CheckerFixture {
 protected:
  void report(double now, Outcome outcome, const std::string& dropped = {}) {
    checker_->inputs().addScanReport(at(now), {at(now), outcome, dropped});
  }
  void robot(double now) {
    setRoot(now);
    addJoints(now, 0.0);
  }
  /// Scans that come in, are assembled and mapped.
  void runMapped(double from, double to) {
    for (double now = from; now < to; now += kScanPeriod) {
      report(now, Outcome::kWaiting);
      report(now, Outcome::kAssembled);
      feedAndCheck(now, clear_);
    }
  }
  /// Scans that come in and do not reach the map. @return the first time it is not clear.
  template <typename Happen>
  double runUnmapped(double from, double to, Happen&& happen) {
    for (double now = from; now < to; now += 0.005) {
      robot(now);
      if (std::fmod(now - from, kScanPeriod) < 0.005) {
        report(now, Outcome::kWaiting);
        happen(now);
      }
      last_ = check(now).reason;
      detail_ = check(now).detail;
      if (last_ != Reason::kClear) return now;
    }
    return to;
  }

  Reason last_ = Reason::kClear;
  std::string detail_;
};

TEST_F(CheckInputsTest, WithoutAnyScanItIsAFaultAfterThreeScanPeriods) {
  runMapped(kStart, kStart + 0.5);
  const double last = kStart + 0.475;
  for (double now = last; now <= last + 0.3; now += 0.005) {
    robot(now);
    const Verdict& verdict = check(now);
    if (verdict.reason == Reason::kClear) continue;
    EXPECT_EQ(verdict.reason, Reason::kNoMap);
    EXPECT_NE(verdict.detail.find("no scan for"), std::string::npos) << verdict.detail;
    EXPECT_NEAR(now - last, 3.0 * kScanPeriod, 0.011);
    return;
  }
  FAIL() << "it stayed clear";
}

TEST_F(CheckInputsTest, ScansThatAreAllBlindAreNamedAfterThreeScanPeriods) {
  runMapped(kStart, kStart + 0.5);
  const double first = runUnmapped(kStart + 0.5, kStart + 2.0,
                                   [this](double now) { report(now, Outcome::kDropped, "blind"); });
  EXPECT_EQ(last_, Reason::kBlind);
  EXPECT_NE(detail_.find("blind"), std::string::npos) << detail_;
  EXPECT_NEAR(first - (kStart + 0.475), 3.0 * kScanPeriod, 0.011);
}

TEST_F(CheckInputsTest, ScansOfTheFutureAreNamedLikewise) {
  runMapped(kStart, kStart + 0.5);
  runUnmapped(kStart + 0.5, kStart + 2.0,
              [this](double now) { report(now, Outcome::kDropped, "future_stamp"); });
  EXPECT_EQ(last_, Reason::kFuture);
}

TEST_F(CheckInputsTest, ScansMayWaitForTransformsAsLongAsThoseMayBeMissing) {
  runMapped(kStart, kStart + 0.5);
  const double first = runUnmapped(kStart + 0.5, kStart + 2.0, [](double) {});
  EXPECT_EQ(last_, Reason::kNoTransform);
  EXPECT_NEAR(first - (kStart + 0.475), 0.5, 0.011);
}

TEST_F(CheckInputsTest, ScansThatAreAssembledButNotMappedAreAFaultAfterThreeScanPeriods) {
  runMapped(kStart, kStart + 0.5);
  const double first = runUnmapped(kStart + 0.5, kStart + 2.0,
                                   [this](double now) { report(now, Outcome::kAssembled); });
  EXPECT_EQ(last_, Reason::kNoMap);
  EXPECT_NE(detail_.find("none was mapped"), std::string::npos) << detail_;
  EXPECT_LT(first - (kStart + 0.475), 4.0 * kScanPeriod);
}

TEST_F(CheckInputsTest, OneScanThatIsDroppedIsNoFault) {
  runMapped(kStart, kStart + 0.5);
  report(kStart + 0.5, Outcome::kWaiting);
  report(kStart + 0.5, Outcome::kDropped, "transform_gap");
  runMapped(kStart + 0.525, kStart + 0.6);
  EXPECT_EQ(reasonAt(kStart + 0.6), Reason::kClear);
}

TEST_F(CheckInputsTest, TheFirstScansMayBeBlindAsWell) {
  for (double now = kStart; now < kStart + 0.8; now += kScanPeriod) {
    robot(now);
    report(now, Outcome::kWaiting);
    report(now, Outcome::kDropped, "blind");
    check(now);
  }
  EXPECT_EQ(reasonAt(kStart + 0.8), Reason::kBlind);
}

TEST_F(CheckInputsTest, JointStatesThatAreAllOfTheFutureAreNamedOnceTheOthersAreTooOld) {
  runMapped(kStart, kStart + 0.5);
  for (double now = kStart + 0.5; now < kStart + 0.7; now += 0.01) {
    checker_->addJoints(at(now), at(now + 3.0), {"slide", "glide"}, {0.0, 0.0}, {});
    setMap(now, clear_);
    setRoot(now);
    const Reason reason = reasonAt(now);
    EXPECT_EQ(reason, now - (kStart + 0.475) <= 0.1 ? Reason::kClear : Reason::kFuture) << now;
  }
}

}  // namespace
}  // namespace tccm
