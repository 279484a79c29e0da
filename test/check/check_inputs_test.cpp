/// What scans do before they reach the map; all else that is missing is asked of Checker's tests.

#include "check/check_inputs.h"

#include <gtest/gtest.h>

#include <functional>

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

  /// Nothing comes of the sensor. @param last its last map. @return how long until that is a fault.
  double silenceAfter(
      double last, const std::function<void(double)>& happen = [](double) {}) {
    for (double now = last; now <= last + 1.0; now += 0.005) {
      robot(now);
      happen(now);
      const Verdict& verdict = check(now);
      if (verdict.reason == Reason::kClear) continue;
      EXPECT_EQ(verdict.reason, Reason::kNoMap);
      detail_ = verdict.detail;
      return now - last;
    }
    ADD_FAILURE() << "it stayed clear";
    return 0.0;
  }

  Reason last_ = Reason::kClear;
  std::string detail_;
};

TEST_F(CheckInputsTest, WithoutAnyScanItIsAFaultAfterThreeScanPeriods) {
  runMapped(kStart, kStart + 0.5);
  EXPECT_NEAR(silenceAfter(kStart + 0.475), 3.0 * kScanPeriod, 0.011);
  EXPECT_NE(detail_.find("no scan for"), std::string::npos) << detail_;
}

TEST_F(CheckInputsTest, PausesDoNotTeachItToBePatientWithSilence) {
  double begin = kStart;
  for (const double pause : {0.2, 0.45, 2.0}) {
    runMapped(begin, begin + 0.5);
    begin += 0.475 + pause;
  }
  runMapped(begin, begin + 0.5);
  EXPECT_NEAR(silenceAfter(begin + 0.475), 3.0 * kScanPeriod, 0.011);
}

TEST_F(CheckInputsTest, OneOfTwoPausesInAFewScansIsNotTakenForTheirPeriod) {
  runMapped(kStart, kStart + 0.5);
  runMapped(kStart + 0.6, kStart + 0.65);
  runMapped(kStart + 0.8, kStart + 0.875);
  EXPECT_NEAR(silenceAfter(kStart + 0.85), 3.0 * kScanPeriod, 0.011);
}

TEST_F(CheckInputsTest, ScansThatComeMoreSlowlyAreWaitedForAccordingly) {
  runMapped(kStart, kStart + 0.5);
  double last = kStart + 0.475;
  for (int i = 0; i < 9; ++i) {
    last += 4.0 * kScanPeriod;
    report(last, Outcome::kWaiting);
    report(last, Outcome::kAssembled);
    feedAndCheck(last, clear_);
  }
  EXPECT_NEAR(silenceAfter(last), 12.0 * kScanPeriod, 0.011);
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

TEST_F(CheckInputsTest, ScansOfTwoFramesAreAFaultThatNamesBothAndLastsForTwoSeconds) {
  runMapped(kStart, kStart + 0.5);
  checker_->inputs().addScanReport(
      at(kStart + 0.5),
      {at(kStart + 0.5), Outcome::kDropped, "frame_changed", "'laser_2' after 'laser_1'"});
  runMapped(kStart + 0.5, kStart + 2.4);
  EXPECT_EQ(reasonAt(kStart + 2.4), Reason::kFrameChanged);
  EXPECT_EQ(check(kStart + 2.4).detail, "'laser_2' after 'laser_1'");
  runMapped(kStart + 2.4, kStart + 2.6);
  EXPECT_NE(reasonAt(kStart + 2.6), Reason::kFrameChanged);
}

TEST_F(CheckInputsTest, ABodyFilterThatTakesNearlyAllIsBlindNamingTheLink) {
  runMapped(kStart, kStart + 0.5);
  for (const double share : {0.0, 0.5, 0.89, 0.91, 1.0}) {
    CuboidMap map = clear_;
    map.self_share = share;
    ScanReport assembled{at(kStart + 0.5), Outcome::kAssembled};
    assembled.self_link = "wing";
    checker_->inputs().addScanReport(at(kStart + 0.5), assembled);
    robot(kStart + 0.5);
    setMap(kStart + 0.5, map);
    const Verdict& verdict = check(kStart + 0.5);
    EXPECT_EQ(verdict.reason == Reason::kBlind, share > 0.9) << share;
    EXPECT_EQ(verdict.detail.find("'wing'") != std::string::npos, share > 0.9) << verdict.detail;
  }
}

TEST_F(CheckInputsTest, WhatIsKnownFromOutsideToBeWrongStopsTheRobotWhileItLasts) {
  runMapped(kStart, kStart + 0.5);
  checker_->setOutsideCause({Reason::kCheckLate, "the last check took too long"});
  const Verdict& verdict = feedAndCheck(kStart + 0.5, clear_);
  EXPECT_EQ(verdict.reason, Reason::kCheckLate);
  EXPECT_EQ(verdict.detail, "the last check took too long");
  checker_->setOutsideCause({});
  runMapped(kStart + 0.525, kStart + 2.0);
  EXPECT_EQ(feedAndCheck(kStart + 2.0, clear_).reason, Reason::kClear);
}

TEST_F(CheckInputsTest, ATiltThatStandsStillIsAFault) {
  CuboidMap stands = clear_;
  stands.tilt_stopped = true;
  const Verdict& verdict = feedAndCheck(kStart, stands);
  EXPECT_EQ(verdict.reason, Reason::kSweepIncomplete);
  EXPECT_TRUE(verdict.stop);
}

TEST_F(CheckInputsTest, AMapThatComesAgainIsNoNews) {
  runMapped(kStart, kStart + 0.5);
  const double last = kStart + 0.475;
  auto same = std::make_shared<CuboidMap>(clear_);
  same->stamp = at(last);
  same->serial = checker_->map()->serial;
  test::refreshLooks(*same);
  EXPECT_NEAR(silenceAfter(last, [&](double now) { checker_->setMap(at(now), same); }),
              3.0 * kScanPeriod, 0.011);
}

TEST_F(CheckInputsTest, TheJointThatIsSilentIsNamedWithItsSilence) {
  runMapped(kStart, kStart + 0.5);
  for (double now = kStart + 0.5; now < kStart + 0.8; now += 0.01) {
    setRoot(now);
    checker_->addJoints(at(now), at(now), {"slide"}, {0.0}, {});
    setMap(now, clear_);
    check(now);
  }
  const Verdict& verdict = check(kStart + 0.8);
  EXPECT_EQ(verdict.reason, Reason::kNoJoints);
  EXPECT_NE(verdict.detail.find("'glide' was not heard of for 3"), std::string::npos)
      << verdict.detail;
}

TEST_F(CheckInputsTest, WhyScansAreDroppedIsSaid) {
  runMapped(kStart, kStart + 0.5);
  runUnmapped(kStart + 0.5, kStart + 2.0, [this](double now) {
    checker_->inputs().addScanReport(at(now),
                                     {at(now), Outcome::kDropped, "malformed", "it has no beams"});
  });
  EXPECT_EQ(last_, Reason::kNoMap);
  EXPECT_NE(detail_.find("it has no beams"), std::string::npos) << detail_;
}

}  // namespace
}  // namespace tccm
