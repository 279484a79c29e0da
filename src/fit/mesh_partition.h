#pragma once

#include <vector>

#include "fit/mesh_cut.h"

namespace tccm {

/// A mesh cut into parts, which together hold every point of every triangle.
struct MeshPartition {
  std::vector<MeshPart> parts;
  double rough_volume_m3 = 0.0;  ///< of a primitive around each part, before refinement
};

/// For each number of parts up to parts_max the partition whose primitives are the smallest, as far
/// as found: by cutting the part that gains most, again and again, and joining parts that lose
/// least; or by several cuts along one direction at once, where the best are found together.
/// Rising numbers of parts, of which some may be missing; the first is the mesh in one.
[[nodiscard]] std::vector<MeshPartition> partitions(const Mesh& mesh, std::size_t parts_max);

}  // namespace tccm
