#include "experiments/point_ledger.h"

#include <cmath>

#include "simulation/simulator.h"

namespace tccm::simulation {
namespace {

bool own(std::size_t label) { return label < Simulator::kFirstObject; }

bool adjacent(const Grid& grid, CellIndex a, CellIndex b) {
  const auto apart = [](CellIndex m, CellIndex n) { return m > n ? m - n : n - m; };
  return apart(a % grid.cellsX(), b % grid.cellsX()) <= 1 &&
         apart(a / grid.cellsX(), b / grid.cellsX()) <= 1;
}

}  // namespace

const char* name(BeamSource source) {
  constexpr std::array<const char*, kBeamSources> kNames = {"own", "scene", "own_mixed",
                                                            "scene_mixed"};
  return kNames[static_cast<std::size_t>(source)];
}

BeamSource sourceOf(const BeamTruth& truth) {
  if (!truth.mixed) return own(*truth.label) ? BeamSource::kOwn : BeamSource::kScene;
  return own(truth.mixed_near) || own(truth.mixed_far) ? BeamSource::kOwnMixed
                                                       : BeamSource::kSceneMixed;
}

void PointLedger::add(std::vector<Entry> scan, std::size_t window_scans) {
  scans_.push_back(std::move(scan));
  while (scans_.size() > window_scans) scans_.pop_front();
}

SourceCounts PointLedger::around(const CuboidMap& map, const Cuboid& cuboid,
                                 double height_m) const {
  SourceCounts counts{};
  const auto reach = static_cast<int>(std::ceil(height_m / map.grid.metres(1)));
  for (const std::vector<Entry>& scan : scans_) {
    for (const Entry& entry : scan) {
      // A return at height h occupies (h - thickness, h].
      const bool level = entry.height >= cuboid.bottom - reach &&
                         entry.height - map.thickness <= cuboid.top + reach;
      if (!level || !adjacent(map.grid, entry.cell, cuboid.cell)) continue;
      ++counts[static_cast<std::size_t>(entry.source)];
    }
  }
  return counts;
}

}  // namespace tccm::simulation
