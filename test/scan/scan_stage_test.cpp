#include "scan/scan_stage.h"

#include <gtest/gtest.h>

#include <map>

namespace tccm {
namespace {

TEST(ScanStageTest, WhereABeamMeasuredNothingOrIsTakenAwayItSawNeitherASurfaceNorNothing) {
  const std::map<BeamKind, Seen> expected{
      {BeamKind::kReturn, Seen::kSurface},     {BeamKind::kNoReturn, Seen::kNothing},
      {BeamKind::kSelf, Seen::kRobot},         {BeamKind::kShadow, Seen::kUnclear},
      {BeamKind::kMixedPixel, Seen::kUnclear}, {BeamKind::kTooClose, Seen::kUnclear},
      {BeamKind::kUnknown, Seen::kUnclear},    {BeamKind::kThinned, Seen::kUnclear}};
  ASSERT_EQ(expected.size(), kBeamKinds);
  for (const auto& [kind, seen] : expected) {
    EXPECT_EQ(seenBy(kind), seen) << static_cast<int>(kind);
  }
}

TEST(ScanStageTest, OnlyReturnsBecomePointsAndEveryBeamALook) {
  AssembledScan scan;
  for (std::size_t kind = 0; kind < kBeamKinds; ++kind) {
    Beam beam;
    beam.kind = static_cast<BeamKind>(kind);
    beam.p_fixed = Vector3(static_cast<double>(kind), 0.0, 0.0);
    beam.viewpoint = Vector3(0.0, static_cast<double>(kind), 0.0);
    beam.tilt = 0.1 + static_cast<double>(kind);
    scan.beams.push_back(beam);
  }
  ScanReturns returns;
  returns.points.resize(3);
  takeReturns(scan, returns);
  ASSERT_EQ(returns.points.size(), 1U);
  EXPECT_EQ(returns.points[0].x(), static_cast<double>(BeamKind::kReturn));
  EXPECT_EQ(returns.looks.size(), kBeamKinds);
  EXPECT_EQ(returns.tilt, 0.1);
  EXPECT_EQ(returns.viewpoint.y(), static_cast<double>(kBeamKinds - 1));
}

}  // namespace
}  // namespace tccm
