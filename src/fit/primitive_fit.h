#pragma once

#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "mesh/mesh.h"
#include "tccm_monitor/shape.h"

namespace tccm {

/// The few primitives that cover a mesh: every point of every triangle is in one of them. What a
/// closed mesh encloses may be in none where several are used.
struct PrimitiveFit {
  std::vector<PlacedShape> primitives;  ///< in the mesh's frame
  double hull_volume_m3 = 0.0;          ///< of the mesh's convex hull
  /// The furthest that a point of a primitive is from the convex hull of the part it covers, margin
  /// included.
  double overhang_m = 0.0;
  Vector3 mesh_extents_m = Vector3::Zero();  ///< sides of the upright box around the mesh
  std::vector<std::string> warnings = {};    ///< the mesh's
};

/// An empty mesh has no primitive. Covers any other with the box, cylinder, capsule or sphere of
/// least volume, or with several where that leaves less air. The same mesh gives the same
/// primitives; about 0.1 s for a mesh of 1000 triangles.
/// @throws ConfigError naming owner where the mesh is not finite, names a vertex that it has
/// not, or is larger than a primitive may be.
[[nodiscard]] PrimitiveFit fitPrimitives(const Mesh& mesh, const PrimitiveFitConfig& config,
                                         const std::string& owner);

/// Remembers fits by what they were made from: in this process, and where there is a folder, in one
/// small file each for processes to come. What is damaged, foreign or of another version is
/// computed anew. Safe to use from several threads, and by several processes with one folder.
class FitCache {
 public:
  /// @param folder made when something is first saved; empty: no files.
  explicit FitCache(std::string folder) : folder_(std::move(folder)) {}

  /// The fit of that mesh, computed only where it is not known yet; equal to the computed one to
  /// the bit. What compute throws passes through, and nothing is remembered then.
  /// @param key everything besides the content that determines the fit, such as the file's
  /// extension, its scale and the fit's configuration.
  /// @param compute must not use this cache.
  [[nodiscard]] PrimitiveFit fit(const std::string& mesh_content, const std::string& key,
                                 const std::function<PrimitiveFit()>& compute);

  /// Why a fit could not be saved, in one line; empty where all could.
  [[nodiscard]] std::string saveProblem() const;

 private:
  const std::string folder_;
  mutable std::mutex mutex_;
  std::map<std::string, PrimitiveFit> known_;  ///< by identity
  std::string save_problem_;
};

}  // namespace tccm
