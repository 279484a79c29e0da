#pragma once

#include <cstddef>
#include <string>

#include "mesh/mesh.h"

namespace tccm {

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
/// every geometry at its place, each vertex once, and those that no face uses as lone points.
/// Nothing but content is read, whatever files it refers to.
/// @param uri tells the format by its extension (.stl, .dae or .obj in any case), and names the
/// file in errors.
/// @throws ConfigError "uri: why" where the file is damaged, cut off or empty, a coordinate is not
/// finite or beyond 1 km, or a factor of the scale is 0 or beyond 1000.
[[nodiscard]] Mesh readMesh(const std::string& content, const std::string& uri,
                            const MeshScaling& scaling);

}  // namespace tccm
