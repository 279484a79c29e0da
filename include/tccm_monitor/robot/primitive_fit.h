#pragma once

#include <string>
#include <vector>

#include "tccm_monitor/geometry/mesh.h"
#include "tccm_monitor/geometry/shape.h"

namespace tccm {

/// The few primitives that cover a mesh: every point of every triangle is in one of them.
struct PrimitiveFit {
  std::vector<PlacedShape> primitives;  ///< in the mesh's frame
  double hull_volume_m3 = 0.0;          ///< of the mesh's convex hull
  double overhang_m = 0.0;  ///< the furthest that a primitive reaches beyond the part it covers
};

struct PrimitiveFitConfig {
  int primitives_max = 4;  ///< for one mesh
  /// A further primitive has to take this share of the volume away.
  double split_gain = 0.1;
  /// Primitives are larger by this, so that rounding leaves nothing outside.
  double margin_m = 1e-5;

  /// @throws ConfigError
  void validate() const;
};

/// Covers the mesh with the box, cylinder, capsule or sphere of least volume, or with several where
/// that leaves less air.
/// @throws ConfigError naming owner where the mesh is empty or not finite.
[[nodiscard]] PrimitiveFit fitPrimitives(const Mesh& mesh, const PrimitiveFitConfig& config,
                                         const std::string& owner);

}  // namespace tccm
