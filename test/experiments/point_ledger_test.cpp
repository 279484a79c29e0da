#include "experiments/point_ledger.h"

#include <gtest/gtest.h>

#include "simulation/simulator.h"

namespace tccm::simulation {
namespace {

constexpr std::size_t kScene = Simulator::kFirstObject;

TEST(PointLedgerTest, ABeamComesFromTheBodyTheSceneOrBetweenTheTwo) {
  EXPECT_EQ(sourceOf({3, false, 0, 0}), BeamSource::kOwn);
  EXPECT_EQ(sourceOf({kScene, false, 0, 0}), BeamSource::kScene);
  EXPECT_EQ(sourceOf({kScene, true, 3, kScene}), BeamSource::kOwnMixed);
  EXPECT_EQ(sourceOf({3, true, 3, 4}), BeamSource::kOwnMixed);
  EXPECT_EQ(sourceOf({kScene, true, kScene, kScene + 1}), BeamSource::kSceneMixed);
}

TEST(PointLedgerTest, CountsTheWindowSPointsInTheCellsAndHeightsAroundACuboid) {
  CuboidMap map;
  map.thickness = 20;
  const CellIndex row = map.grid.cellsX();
  const CellIndex cell = 10 * row + 10;
  const Cuboid cuboid{cell, 980, 1000};
  PointLedger ledger;
  ledger.add({{cell, 1000, BeamSource::kOwn}}, 2);
  ledger.add({{cell, 1000, BeamSource::kScene}, {cell + row + 1, 1040, BeamSource::kOwnMixed}}, 2);
  ledger.add({{cell + 2, 1000, BeamSource::kScene}, {cell, 1060, BeamSource::kSceneMixed}}, 2);
  EXPECT_EQ(ledger.around(map, cuboid, 0.03), (SourceCounts{0, 1, 1, 0}));
}

}  // namespace
}  // namespace tccm::simulation
