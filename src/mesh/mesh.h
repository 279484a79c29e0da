#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "tccm_monitor/pose.h"

namespace tccm {

/// Triangles in one frame [m]. A line names one vertex twice, a lone point names it three times.
struct Mesh {
  using Triangle = std::array<std::uint32_t, 3>;

  std::vector<Vector3> vertices;
  std::vector<Triangle> triangles;  ///< indices into vertices; their winding says nothing
  /// What of a file was left out or passed over, one line each.
  std::vector<std::string> warnings = {};

  /// Adds a fan of triangles for a polygon, else a line or a point.
  void addFace(const std::uint32_t* corners, std::size_t count);
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

/// How a mesh file's coordinates become metres in the mesh's frame.
struct MeshScaling {
  /// Per axis, after the file's own unit; a negative factor mirrors.
  Vector3 scale = Vector3::Ones();
  /// Turns the mesh so that the up axis that a COLLADA file states becomes z. Off: coordinates stay
  /// as they stand in the file, as rviz and MoveIt read them; many robots' files state the wrong
  /// one.
  bool apply_up_axis = false;
};

/// What one mesh file may hold.
constexpr std::size_t kMeshBytesMax = std::size_t{256} << 20U;
constexpr std::size_t kMeshVerticesMax = 2'000'000;  ///< different ones

/// The mesh that content, the bytes of an STL, COLLADA or OBJ file, describes: every instance of
/// every geometry at its place, each vertex once. A body is what faces are made of: vertices that
/// no face uses are left out, and told in the mesh's warnings. So are a file that is whole and
/// holds nothing, which gives an empty mesh, and bytes behind an STL's last facet. Nothing but
/// content is read, whatever files it refers to.
/// @param uri tells the format by its extension (.stl, .dae or .obj in any case), and names the
/// file in errors.
/// @throws ConfigError "uri: why" where the file is damaged or cut off, a face's coordinate is not
/// finite or beyond 1 km, or a factor of the scale is 0 or beyond 1000.
[[nodiscard]] Mesh readMesh(const std::string& content, const std::string& uri,
                            const MeshScaling& scaling);

// The readers behind it, for coordinates as they stand in the file, in metres of a COLLADA file,
// that are not looked at yet. They throw ConfigError saying why, without the file's name.

[[nodiscard]] Mesh readStl(const std::string& content);
[[nodiscard]] Mesh readCollada(const std::string& content, bool apply_up_axis);

}  // namespace tccm
