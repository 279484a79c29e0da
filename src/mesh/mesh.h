#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "tccm_monitor/pose.h"

namespace tccm {

/// Triangles in one frame [m]. A line names one vertex twice, a lone point names it three times;
/// every vertex belongs to a triangle.
struct Mesh {
  using Triangle = std::array<std::uint32_t, 3>;

  std::vector<Vector3> vertices;
  std::vector<Triangle> triangles;  ///< indices into vertices; their winding says nothing
};

/// The vertices that are a corner of a polygon, in the order they come there; the corners are
/// numbered anew.
/// @param polygons lists of indices into vertices
template <typename Polygons>
[[nodiscard]] std::vector<Vector3> withoutUnused(const std::vector<Vector3>& vertices,
                                                 Polygons& polygons) {
  constexpr std::uint32_t kUnused = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> numbers(vertices.size(), kUnused);
  std::vector<Vector3> used;
  for (auto& polygon : polygons) {
    for (std::uint32_t& corner : polygon) {
      std::uint32_t& number = numbers[corner];
      if (number == kUnused) {
        number = static_cast<std::uint32_t>(used.size());
        used.push_back(vertices[corner]);
      }
      corner = number;
    }
  }
  return used;
}

}  // namespace tccm
