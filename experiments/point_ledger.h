#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <vector>

#include "simulation/scanner.h"
#include "tccm_monitor/cuboid_map.h"

namespace tccm::simulation {

/// What a beam's range comes from.
enum class BeamSource : std::uint8_t {
  kOwn,         ///< the robot's body
  kScene,       ///< anything else
  kOwnMixed,    ///< between two surfaces, one or both of them the robot's
  kSceneMixed,  ///< between two surfaces of the scene
};
constexpr std::size_t kBeamSources = 4;
using SourceCounts = std::array<std::size_t, kBeamSources>;

/// "own", "scene", "own_mixed" or "scene_mixed".
[[nodiscard]] const char* name(BeamSource source);
/// @pre the beam measured a range. Labels from Simulator::kFirstObject on are the scene's.
[[nodiscard]] BeamSource sourceOf(const BeamTruth& truth);

/// Where the points in the map come from: remembers those of the scans in the map's window.
class PointLedger {
 public:
  struct Entry {
    CellIndex cell;
    Height height;
    BeamSource source;
  };

  /// The newest scan's points. @param window_scans older ones are forgotten.
  void add(std::vector<Entry> scan, std::size_t window_scans);
  void clear() { scans_.clear(); }

  /// Points in the 3 x 3 cells around a cuboid within height_m of its heights, by source: all that
  /// can have made the cuboid and lend it support.
  [[nodiscard]] SourceCounts around(const CuboidMap& map, const Cuboid& cuboid,
                                    double height_m) const;

 private:
  std::deque<std::vector<Entry>> scans_;
};

}  // namespace tccm::simulation
