#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "mesh/mesh.h"

/// The formats behind readMesh(). Vertices come as they stand in the file, a place possibly many
/// times and not yet checked to be finite; indices are valid, and vertices may be without a
/// triangle.
/// All throw ConfigError saying why, without the file's name.
namespace tccm {

[[nodiscard]] Mesh readStl(const std::string& content);
[[nodiscard]] Mesh readObj(const std::string& content);
/// In metres: the file's unit is applied.
[[nodiscard]] Mesh readCollada(const std::string& content, bool apply_up_axis);

/// Adds a face of any number of corners: a fan of triangles for a polygon, else a line or a point.
void addFace(const std::vector<std::uint32_t>& corners, Mesh& mesh);

}  // namespace tccm
