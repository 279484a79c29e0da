#pragma once

#include <array>
#include <string>
#include <vector>

#include "fit/primitive_fit.h"
#include "fuzz/promises.h"
#include "mesh/mesh.h"

/// What the fuzz target of readMesh() and the test of its corpus do with an input: a byte that
/// chooses the format, and a file.
namespace tccm::test {

inline void requireMesh(const Mesh& mesh) {
  promise(!mesh.vertices.empty() || !mesh.warnings.empty(), "an empty mesh is not told of");
  std::vector<bool> used(mesh.vertices.size(), false);
  for (const Mesh::Triangle& triangle : mesh.triangles) {
    for (const std::uint32_t corner : triangle) used.at(corner) = true;
  }
  for (std::size_t i = 0; i < used.size(); ++i) {
    promise(used[i], "a vertex belongs to no triangle");
    promise(mesh.vertices[i].allFinite(), "a vertex is not finite");
  }
}

/// Every corner is in one of the primitives.
inline void requireCovered(const Mesh& mesh, const PrimitiveFit& fit) {
  for (const Vector3& corner : mesh.vertices) {
    bool inside = false;
    for (const PlacedShape& primitive : fit.primitives) {
      inside = inside || distance(primitive.shape, primitive.pose.inverse() * corner) == 0.0;
    }
    promise(inside, "a corner is in no primitive");
  }
}

/// What readMesh() and the fit broke of their promises on an input, or nothing.
inline std::string meshDefect(const std::string& input) {
  if (input.empty()) return {};
  const auto choice = static_cast<unsigned char>(input.front());
  const std::array<const char*, 3> uris{"m.stl", "m.obj", "m.dae"};
  const std::string uri = uris.at(choice % 3U);
  MeshScaling scaling;
  scaling.apply_up_axis = (choice & 0x40U) != 0;
  if ((choice & 0x80U) != 0) scaling.scale << 1.0, -2.0, 0.001;
  return brokenPromise([&] {
    const Mesh mesh = readMesh(input.substr(1), uri, scaling);
    requireMesh(mesh);
    if (mesh.triangles.size() > 30) return;  // larger ones are fitted slowly
    requireCovered(mesh, fitPrimitives(mesh, {}, uri));
  });
}

}  // namespace tccm::test
