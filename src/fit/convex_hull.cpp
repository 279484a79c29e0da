#include "fit/convex_hull.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

extern "C" {
#include <libqhull_r/qhull_ra.h>
}

namespace tccm {
namespace {

constexpr double kFlat = 1e-9;  // of the extent

std::vector<Vector3> different(std::vector<Vector3> points) {
  std::sort(points.begin(), points.end(), [](const Vector3& a, const Vector3& b) {
    return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
  });
  points.erase(std::unique(points.begin(), points.end()), points.end());
  return points;
}

/// The point for which measure is largest.
template <typename Measure>
Vector3 farthest(const std::vector<Vector3>& points, const Measure& measure) {
  return *std::max_element(points.begin(), points.end(), [&](const Vector3& a, const Vector3& b) {
    return measure(a) < measure(b);
  });
}

/// Whether points of extent 1 lie near one plane, line or point.
bool isFlat(const std::vector<Vector3>& points) {
  const Vector3 a = points.front();
  const Vector3 b = farthest(points, [&](const Vector3& p) { return (p - a).norm(); });
  const Vector3 along = (b - a).normalized();
  const auto from_line = [&](const Vector3& p) { return along.cross(p - a).norm(); };
  const Vector3 c = farthest(points, from_line);
  if (from_line(c) < kFlat) return true;
  const Vector3 normal = along.cross(c - a).normalized();
  const auto from_plane = [&](const Vector3& p) { return std::abs(normal.dot(p - a)); };
  return from_plane(farthest(points, from_plane)) < kFlat;
}

/// Qhull's state, silent, and freed whatever happens.
struct Qhull {
  Qhull() { qh_zero(&state, silence); }
  Qhull(const Qhull&) = delete;
  Qhull& operator=(const Qhull&) = delete;
  ~Qhull() {
    int long_blocks = 0;
    int long_bytes = 0;
    qh_freeqhull(&state, !qh_ALL);
    qh_memfreeshort(&state, &long_blocks, &long_bytes);
    if (silence != nullptr) std::fclose(silence);
  }

  std::FILE* silence = std::fopen("/dev/null", "w");
  qhT state;
};

/// Corners as numbers of points.
std::vector<Mesh::Triangle> trianglesOf(qhT& state) {
  std::vector<Mesh::Triangle> triangles;
  for (const facetT* facet = state.facet_list; facet && facet->next; facet = facet->next) {
    if (qh_setsize(&state, facet->vertices) != 3) continue;
    Mesh::Triangle triangle{};
    for (std::size_t corner = 0; corner < 3; ++corner) {
      auto* vertex = static_cast<vertexT*>(facet->vertices->e[corner].p);
      triangle[corner] = static_cast<std::uint32_t>(qh_pointid(&state, vertex->point));
    }
    triangles.push_back(triangle);
  }
  return triangles;
}

/// None where Qhull finds no hull.
std::vector<Mesh::Triangle> hullTriangles(std::vector<Vector3> points) {
  // Merged faces first; joggled input gets through where their merging fails.
  for (std::string command : {"qhull Qt Pp", "qhull QJ Pp"}) {
    Qhull qhull;
    if (qh_new_qhull(&qhull.state, 3, static_cast<int>(points.size()), points.front().data(), False,
                     command.data(), nullptr, qhull.silence) == qh_ERRnone) {
      return trianglesOf(qhull.state);
    }
  }
  return {};
}

/// Of a star-shaped surface about the vertices' mean, whatever the winding.
double enclosedVolume(const Mesh& mesh) {
  Vector3 middle = Vector3::Zero();
  for (const Vector3& p : mesh.vertices) middle += p / static_cast<double>(mesh.vertices.size());
  double sixfold = 0.0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vector3 from = mesh.vertices[a] - middle;
    const Vector3 normal = (mesh.vertices[b] - middle).cross(mesh.vertices[c] - middle);
    sixfold += std::abs(from.dot(normal));
  }
  return sixfold / 6.0;
}

}  // namespace

ConvexHull convexHull(const std::vector<Vector3>& points) {
  const std::vector<Vector3> unique = different(points);
  ConvexHull hull;
  hull.surface.vertices = unique;
  if (unique.size() < 4) return hull;

  Eigen::AlignedBox3d box;
  for (const Vector3& p : unique) box.extend(p);
  const double extent = box.sizes().maxCoeff();
  // Qhull's tolerances are relative to the largest coordinate.
  std::vector<Vector3> scaled;
  scaled.reserve(unique.size());
  for (const Vector3& p : unique) scaled.emplace_back((p - box.center()) / extent);
  if (isFlat(scaled)) return hull;

  hull.surface.triangles = hullTriangles(std::move(scaled));
  if (hull.surface.triangles.empty()) return hull;
  hull.surface.vertices = withoutUnused(unique, hull.surface.triangles);
  hull.volume_m3 = enclosedVolume(hull.surface);
  return hull;
}

}  // namespace tccm
