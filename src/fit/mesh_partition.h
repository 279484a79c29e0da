#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "mesh/mesh.h"

namespace tccm {

/// The points p with normal . p = height; below is the side where it is less.
struct Plane {
  Vector3 normal = Vector3::UnitZ();  ///< a unit vector
  double height_m = 0.0;
};

/// What planes leave of a mesh's triangles: convex polygons.
class MeshPart {
 public:
  explicit MeshPart(const Mesh& mesh);

  [[nodiscard]] const std::vector<Vector3>& vertices() const { return vertices_; }

  /// The parts below and above: together every point of every polygon, up to rounding. Either may
  /// be empty.
  [[nodiscard]] std::pair<MeshPart, MeshPart> cut(const Plane& plane) const;

  /// Only the vertices of the slices between planes of one normal at rising heights: one slice more
  /// than heights.
  [[nodiscard]] std::vector<std::vector<Vector3>> slices(
      const Vector3& normal, const std::vector<double>& heights_m) const;

  /// Both together.
  [[nodiscard]] static MeshPart joined(const MeshPart& a, const MeshPart& b);

  /// Sum of the polygons' areas whose normal is within about 1 degree of the given one, at each
  /// height along it [m, m2], rising.
  [[nodiscard]] std::vector<std::pair<double, double>> ledges(const Vector3& normal) const;

 private:
  using Edge = std::array<std::uint32_t, 2>;  // the lower number first

  MeshPart() = default;
  void finish();

  std::vector<Vector3> vertices_;
  std::vector<std::vector<std::uint32_t>> polygons_;
  std::vector<Edge> edges_;  // each once
};

/// A mesh cut into parts, which together hold every point of every triangle: for each number of
/// parts up to parts_max those around which primitives are the smallest, as far as found. By
/// cutting the part that gains most, again and again, and joining parts that lose least; or by
/// several cuts along one direction at once, where the best are found together.
/// Rising numbers of parts, of which some may be missing; the first is the mesh in one.
[[nodiscard]] std::vector<std::vector<MeshPart>> partitions(const Mesh& mesh,
                                                            std::size_t parts_max);

}  // namespace tccm
