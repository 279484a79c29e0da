#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "geometry/pose.h"

namespace tccm {

/// Triangles in one frame [m]. A line names one vertex twice, a lone point names it three times;
/// every vertex belongs to a triangle.
struct Mesh {
  using Triangle = std::array<std::uint32_t, 3>;

  std::vector<Vector3> vertices;
  std::vector<Triangle> triangles;  ///< indices into vertices; their winding says nothing
};

}  // namespace tccm
