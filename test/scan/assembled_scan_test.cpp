#include "scan/assembled_scan.h"

#include <gtest/gtest.h>

#include <numeric>

namespace tccm {
namespace {

Beam beamOf(BeamKind kind) {
  Beam beam;
  beam.kind = kind;
  return beam;
}

TEST(AssembledScanTest, WhatAFilterRemovedWasStillMeasured) {
  for (const BeamKind kind :
       {BeamKind::kReturn, BeamKind::kMixedPixel, BeamKind::kSelf, BeamKind::kShadow}) {
    EXPECT_TRUE(beamOf(kind).measured());
  }
  for (const BeamKind kind : {BeamKind::kNoReturn, BeamKind::kTooClose, BeamKind::kUnknown}) {
    EXPECT_FALSE(beamOf(kind).measured());
  }
}

TEST(AssembledScanTest, ABeamIsUnknownUntilItIsSaidToBeElse) {
  EXPECT_EQ(Beam().kind, BeamKind::kUnknown);
}

TEST(AssembledScanTest, EveryBeamIsCountedOnceUnderItsKind) {
  AssembledScan scan;
  for (std::size_t kind = 0; kind < kBeamKinds; ++kind) {
    scan.beams.insert(scan.beams.end(), kind + 1, beamOf(static_cast<BeamKind>(kind)));
  }
  const BeamCounts counts = scan.counts();
  for (std::size_t kind = 0; kind < kBeamKinds; ++kind) EXPECT_EQ(counts[kind], kind + 1);
  EXPECT_EQ(std::accumulate(counts.begin(), counts.end(), std::size_t{0}), scan.beams.size());
}

TEST(AssembledScanTest, AnEmptyScanCountsNothing) {
  EXPECT_EQ(AssembledScan().counts(), BeamCounts{});
}

}  // namespace
}  // namespace tccm
