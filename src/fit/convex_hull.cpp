#include "fit/convex_hull.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <memory>
#include <tuple>

extern "C" {
#include <libqhull_r/qhull_ra.h>
}

namespace tccm {
namespace {

constexpr double kFlat = 1e-9;  // of the extent
constexpr std::uint32_t kUnused = std::numeric_limits<std::uint32_t>::max();

std::vector<Vector3> different(std::vector<Vector3> points) {
  const auto before = [](const Vector3& a, const Vector3& b) {
    return std::make_tuple(a.x(), a.y(), a.z()) < std::make_tuple(b.x(), b.y(), b.z());
  };
  std::sort(points.begin(), points.end(), before);
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

/// One run of Qhull, silent, and freed whatever happens.
class Qhull {
 public:
  /// @param coordinates outlives this; Qhull does not change it.
  Qhull(std::vector<double>& coordinates, const char* options)
      : silence_(std::fopen("/dev/null", "w"), &closeFile) {
    qh_zero(&qh_, silence_.get());
    std::string command = options;
    const int count = static_cast<int>(coordinates.size() / 3);
    failed_ = qh_new_qhull(&qh_, 3, count, coordinates.data(), False, command.data(), nullptr,
                           silence_.get()) != qh_ERRnone;
  }
  Qhull(const Qhull&) = delete;
  Qhull& operator=(const Qhull&) = delete;
  ~Qhull() {
    int long_blocks = 0;
    int long_bytes = 0;
    qh_freeqhull(&qh_, !qh_ALL);
    qh_memfreeshort(&qh_, &long_blocks, &long_bytes);
  }

  [[nodiscard]] bool failed() const { return failed_; }

  /// Corners as numbers of points.
  [[nodiscard]] std::vector<Mesh::Triangle> triangles() {
    std::vector<Mesh::Triangle> triangles;
    for (const facetT* facet = qh_.facet_list; facet && facet->next; facet = facet->next) {
      if (qh_setsize(&qh_, facet->vertices) != 3) continue;
      Mesh::Triangle triangle{};
      for (int corner = 0; corner < 3; ++corner) {
        auto* vertex = static_cast<vertexT*>(facet->vertices->e[corner].p);
        triangle.at(static_cast<std::size_t>(corner)) =
            static_cast<std::uint32_t>(qh_pointid(&qh_, vertex->point));
      }
      triangles.push_back(triangle);
    }
    return triangles;
  }

 private:
  static void closeFile(std::FILE* file) { std::fclose(file); }

  std::unique_ptr<std::FILE, void (*)(std::FILE*)> silence_;
  qhT qh_;
  bool failed_ = true;
};

/// None where Qhull finds no hull.
std::vector<Mesh::Triangle> hullTriangles(const std::vector<Vector3>& points) {
  std::vector<double> coordinates;
  coordinates.reserve(3 * points.size());
  for (const Vector3& p : points) coordinates.insert(coordinates.end(), p.data(), p.data() + 3);
  // Merged faces first; joggled input gets through where their merging fails.
  for (const char* options : {"qhull Qt Pp", "qhull QJ Pp"}) {
    Qhull qhull(coordinates, options);
    if (!qhull.failed()) return qhull.triangles();
  }
  return {};
}

/// Leaves out the points that are no corner.
Mesh withoutUnused(const std::vector<Vector3>& points, std::vector<Mesh::Triangle> triangles) {
  Mesh mesh;
  std::vector<std::uint32_t> renumbered(points.size(), kUnused);
  for (Mesh::Triangle& triangle : triangles) {
    for (std::uint32_t& corner : triangle) {
      std::uint32_t& number = renumbered[corner];
      if (number == kUnused) {
        number = static_cast<std::uint32_t>(mesh.vertices.size());
        mesh.vertices.push_back(points[corner]);
      }
      corner = number;
    }
  }
  mesh.triangles = std::move(triangles);
  return mesh;
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

  std::vector<Mesh::Triangle> triangles = hullTriangles(scaled);
  if (triangles.empty()) return hull;
  hull.surface = withoutUnused(unique, std::move(triangles));
  hull.volume_m3 = enclosedVolume(hull.surface);
  return hull;
}

}  // namespace tccm
