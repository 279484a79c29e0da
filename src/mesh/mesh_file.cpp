#include "mesh/mesh_file.h"

#include <array>
#include <boost/algorithm/string/predicate.hpp>
#include <boost/functional/hash.hpp>
#include <cmath>
#include <locale>
#include <unordered_map>

#include "mesh/mesh_formats.h"
#include "mesh/text.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

constexpr double kFurthest = 1e3;  // [m]; beyond it is a slip of units
constexpr double kLargestScale = 1e3;

void requireScale(const Vector3& scale) {
  for (const double factor : {scale.x(), scale.y(), scale.z()}) {
    if (std::isnan(factor) || factor == 0.0 || std::abs(factor) > kLargestScale) {
      throw ConfigError("its scale has the factor " + std::to_string(factor) +
                        ", which is 0 or outside [-1000, 1000]");
    }
  }
}

Mesh readFile(const std::string& content, const std::string& uri, bool apply_up_axis) {
  if (content.empty()) throw ConfigError("the file is empty");
  if (content.size() > kMeshBytesMax) throw ConfigError("the file is larger than 256 MB");
  const auto endsWith = [&uri](const char* extension) {
    return boost::algorithm::iends_with(uri, extension, std::locale::classic());
  };
  if (endsWith(".stl")) return readStl(content);
  if (endsWith(".obj")) return readObj(content);
  if (endsWith(".dae")) return readCollada(content, apply_up_axis);
  throw ConfigError("meshes are read from .stl, .dae and .obj files only");
}

/// Scaled, each vertex once, and every vertex in a triangle.
Mesh finished(const Mesh& raw, const Vector3& scale) {
  if (raw.vertices.empty()) throw ConfigError("it holds no geometry: there is no vertex in it");
  using Place = std::array<double, 3>;
  std::unordered_map<Place, std::uint32_t, boost::hash<Place>> numbers;
  std::vector<std::uint32_t> merged;
  merged.reserve(raw.vertices.size());
  Mesh mesh;
  for (const Vector3& unscaled : raw.vertices) {
    const Vector3 p = unscaled.cwiseProduct(scale);
    if (!(p.cwiseAbs().maxCoeff() <= kFurthest) || !p.allFinite()) {
      throw ConfigError("a coordinate is not finite, or beyond 1000 m");
    }
    const auto next = static_cast<std::uint32_t>(mesh.vertices.size());
    // Adding 0 makes -0 and 0 one place.
    const auto [number, is_new] =
        numbers.emplace(Place{p.x() + 0.0, p.y() + 0.0, p.z() + 0.0}, next);
    if (is_new && next == kMeshVerticesMax) throw ConfigError("it has over 2 million vertices");
    if (is_new) mesh.vertices.push_back(p);
    merged.push_back(number->second);
  }
  std::vector<bool> used(mesh.vertices.size(), false);
  mesh.triangles.reserve(raw.triangles.size());
  for (const Mesh::Triangle& t : raw.triangles) {
    mesh.triangles.push_back({merged[t[0]], merged[t[1]], merged[t[2]]});
    for (const std::uint32_t corner : mesh.triangles.back()) used[corner] = true;
  }
  for (std::uint32_t i = 0; i < used.size(); ++i) {
    if (!used[i]) mesh.triangles.push_back({i, i, i});
  }
  return mesh;
}

}  // namespace

void addFace(const std::vector<std::uint32_t>& corners, Mesh& mesh) {
  const std::size_t count = corners.size();
  if (count == 1) mesh.triangles.push_back({corners[0], corners[0], corners[0]});
  if (count == 2) mesh.triangles.push_back({corners[0], corners[1], corners[1]});
  for (std::size_t i = 2; i < count; ++i) {
    mesh.triangles.push_back({corners[0], corners[i - 1], corners[i]});
  }
}

Mesh readMesh(const std::string& content, const std::string& uri, const MeshScaling& scaling) {
  try {
    requireScale(scaling.scale);
    return finished(readFile(content, uri, scaling.apply_up_axis), scaling.scale);
  } catch (const std::exception& error) {  // also where memory does not suffice
    throw ConfigError(printable(uri) + ": " + error.what());
  }
}

}  // namespace tccm
