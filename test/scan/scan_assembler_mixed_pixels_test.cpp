#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "scan/scan_assembler.h"
#include "support/random.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

using K = BeamKind;

Beam beamAt(double x, K kind = K::kReturn) {
  Beam beam;
  beam.p_fixed = Vector3(x, 0.0, 0.0);
  beam.viewpoint = Vector3(0.0, 0.0, 1.0);
  beam.kind = kind;
  return beam;
}

AssembledScan scanAt(std::initializer_list<double> xs) {
  AssembledScan scan;
  for (const double x : xs) scan.beams.push_back(beamAt(x));
  return scan;
}

std::vector<K> kindsAfter(AssembledScan scan, double separation_m = 0.06) {
  MixedPixelFilter{separation_m}.apply(scan);
  std::vector<K> kinds;
  for (const Beam& beam : scan.beams) kinds.push_back(beam.kind);
  return kinds;
}

TEST(MixedPixelFilterTest, APointBetweenTwoSurfacesIsRemovedAndTheSurfacesStay) {
  EXPECT_EQ(
      kindsAfter(scanAt({1.0, 1.0, 1.0, 1.5, 2.0, 2.0})),
      (std::vector<K>{K::kReturn, K::kReturn, K::kReturn, K::kMixedPixel, K::kReturn, K::kReturn}));
}

TEST(MixedPixelFilterTest, OneNearNeighbourIsEnough) {
  EXPECT_EQ(kindsAfter(scanAt({1.0, 1.05, 2.0, 2.05})), std::vector<K>(4, K::kReturn));
}

TEST(MixedPixelFilterTest, ExactlyTheSeparationIsNear) {
  EXPECT_EQ(kindsAfter(scanAt({1.0, 1.25}), 0.25), std::vector<K>(2, K::kReturn));
  EXPECT_EQ(kindsAfter(scanAt({1.0, 1.2501}), 0.25), std::vector<K>(2, K::kMixedPixel));
}

TEST(MixedPixelFilterTest, ANeighbourThatMeasuredNothingIsSeparated) {
  for (const K nothing : {K::kNoReturn, K::kTooClose, K::kUnknown}) {
    AssembledScan scan;
    scan.beams = {beamAt(1.0, nothing), beamAt(1.0), beamAt(1.0, nothing)};
    EXPECT_EQ(kindsAfter(scan), (std::vector<K>{nothing, K::kMixedPixel, nothing}));
  }
}

TEST(MixedPixelFilterTest, PointsOfBeamsThatMeasuredNothingMayBeNaN) {
  AssembledScan scan = scanAt({1.0, 1.0, 1.0});
  scan.beams[1].kind = K::kUnknown;
  scan.beams[1].p_fixed.setConstant(std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(kindsAfter(scan), (std::vector<K>{K::kMixedPixel, K::kUnknown, K::kMixedPixel}));
}

TEST(MixedPixelFilterTest, NeighboursThatAnotherFilterRemovedStillSupport) {
  AssembledScan scan = scanAt({1.0, 1.0});
  scan.beams[0].kind = K::kSelf;
  EXPECT_EQ(kindsAfter(scan), (std::vector<K>{K::kSelf, K::kReturn}));
}

TEST(MixedPixelFilterTest, ALonelyPointIsRemovedAndAnEmptyScanIsLeftAlone) {
  EXPECT_EQ(kindsAfter(scanAt({1.0})), std::vector<K>{K::kMixedPixel});
  EXPECT_TRUE(kindsAfter(AssembledScan()).empty());
}

TEST(MixedPixelFilterTest, ZeroSeparationSwitchesItOff) {
  EXPECT_EQ(kindsAfter(scanAt({1.0, 2.0, 3.0}), 0.0), std::vector<K>(3, K::kReturn));
}

TEST(MixedPixelFilterTest, RandomScansAreJudgedBeamByBeamInEitherOrder) {
  test::Random random(11);
  for (int round = 0; round < 300; ++round) {
    AssembledScan scan;
    for (int i = random.integer(0, 40); i > 0; --i) {
      scan.beams.push_back(
          beamAt(0.05 * random.integer(0, 4), static_cast<K>(random.integer(0, kBeamKinds - 1))));
    }
    const auto measuredNear = [&](std::size_t i, std::size_t j) {
      return j < scan.beams.size() && scan.beams[j].measured() &&
             (scan.beams[i].p_fixed - scan.beams[j].p_fixed).norm() <= 0.06;
    };
    std::vector<K> expected;
    for (std::size_t i = 0; i < scan.beams.size(); ++i) {
      const K kind = scan.beams[i].kind;
      const bool lonely = kind == K::kReturn && !measuredNear(i, i - 1) && !measuredNear(i, i + 1);
      expected.push_back(lonely ? K::kMixedPixel : kind);
    }
    ASSERT_EQ(kindsAfter(scan), expected) << "round " << round;
    std::reverse(scan.beams.begin(), scan.beams.end());
    std::reverse(expected.begin(), expected.end());
    ASSERT_EQ(kindsAfter(scan), expected) << "reversed round " << round;
  }
}

TEST(MixedPixelFilterTest, BadSeparationsAreRefusedByName) {
  for (const double bad :
       {-0.01, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    EXPECT_THROW(validated(MixedPixelFilter{bad}), ConfigError);
  }
}

}  // namespace
}  // namespace tccm
