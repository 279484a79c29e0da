#include <algorithm>
#include <cmath>
#include <map>

#include "fit/mesh_partition.h"

namespace tccm {
namespace {

/// Where the edge from a to b, on different sides of height, crosses it.
Vector3 crossing(const Vector3& a, const Vector3& b, double height_a, double height_b,
                 double height) {
  const double share = (height - height_a) / (height_b - height_a);
  return a + std::clamp(share, 0.0, 1.0) * (b - a);
}

std::vector<double> heightsAlong(const Vector3& normal, const std::vector<Vector3>& points) {
  std::vector<double> heights;
  heights.reserve(points.size());
  for (const Vector3& p : points) heights.push_back(normal.dot(p));
  return heights;
}

}  // namespace

MeshPart::MeshPart(const Mesh& mesh) : vertices_(mesh.vertices) {
  for (const Mesh::Triangle& triangle : mesh.triangles) {
    polygons_.emplace_back(triangle.begin(), triangle.end());
  }
  finish();
}

/// Leaves out vertices of no polygon and lists the edges.
void MeshPart::finish() {
  vertices_ = withoutUnused(vertices_, polygons_);
  edges_.clear();
  for (const std::vector<std::uint32_t>& polygon : polygons_) {
    std::uint32_t before = polygon.back();
    for (const std::uint32_t corner : polygon) {
      if (corner != before) edges_.push_back({std::min(before, corner), std::max(before, corner)});
      before = corner;
    }
  }
  std::sort(edges_.begin(), edges_.end());
  edges_.erase(std::unique(edges_.begin(), edges_.end()), edges_.end());
}

std::pair<MeshPart, MeshPart> MeshPart::cut(const Plane& plane) const {
  const std::vector<double> heights = heightsAlong(plane.normal, vertices_);
  const auto isAbove = [&](std::uint32_t i) { return heights[i] >= plane.height_m; };
  MeshPart below;
  below.vertices_ = vertices_;
  std::map<Edge, std::uint32_t> crossings;
  const auto crossingOf = [&](std::uint32_t a, std::uint32_t b) {
    const Edge edge{std::min(a, b), std::max(a, b)};
    const auto next = static_cast<std::uint32_t>(below.vertices_.size());
    const auto [known, is_new] = crossings.emplace(edge, next);
    if (is_new) {
      below.vertices_.push_back(crossing(vertices_[edge[0]], vertices_[edge[1]], heights[edge[0]],
                                         heights[edge[1]], plane.height_m));
    }
    return known->second;
  };
  MeshPart above;
  for (const std::vector<std::uint32_t>& polygon : polygons_) {
    std::vector<std::uint32_t> lower;
    std::vector<std::uint32_t> upper;
    std::uint32_t before = polygon.back();
    for (const std::uint32_t corner : polygon) {
      if (isAbove(before) != isAbove(corner)) {
        const std::uint32_t number = crossingOf(before, corner);
        lower.push_back(number);
        upper.push_back(number);
      }
      (isAbove(corner) ? upper : lower).push_back(corner);
      before = corner;
    }
    if (!lower.empty()) below.polygons_.push_back(std::move(lower));
    if (!upper.empty()) above.polygons_.push_back(std::move(upper));
  }
  above.vertices_ = below.vertices_;
  below.finish();
  above.finish();
  return {std::move(below), std::move(above)};
}

std::vector<std::vector<Vector3>> MeshPart::slices(const Vector3& normal,
                                                   const std::vector<double>& heights_m) const {
  const std::vector<double> heights = heightsAlong(normal, vertices_);
  std::vector<std::size_t> slice_of;
  std::vector<std::vector<Vector3>> slices(heights_m.size() + 1);
  for (std::size_t i = 0; i < vertices_.size(); ++i) {
    const auto slice = std::upper_bound(heights_m.begin(), heights_m.end(), heights[i]);
    slice_of.push_back(static_cast<std::size_t>(slice - heights_m.begin()));
    slices[slice_of.back()].push_back(vertices_[i]);
  }
  for (const auto& [a, b] : edges_) {
    const auto [first, last] = std::minmax(slice_of[a], slice_of[b]);
    for (std::size_t i = first; i < last; ++i) {
      const Vector3 p = crossing(vertices_[a], vertices_[b], heights[a], heights[b], heights_m[i]);
      slices[i].push_back(p);
      slices[i + 1].push_back(p);
    }
  }
  return slices;
}

MeshPart MeshPart::joined(const MeshPart& a, const MeshPart& b) {
  MeshPart both = a;
  const std::uint32_t offset = static_cast<std::uint32_t>(a.vertices_.size());
  both.vertices_.insert(both.vertices_.end(), b.vertices_.begin(), b.vertices_.end());
  for (std::vector<std::uint32_t> polygon : b.polygons_) {
    for (std::uint32_t& corner : polygon) corner += offset;
    both.polygons_.push_back(std::move(polygon));
  }
  for (const auto& [low, high] : b.edges_) both.edges_.push_back({low + offset, high + offset});
  return both;
}

std::vector<std::pair<double, double>> MeshPart::ledges(const Vector3& normal) const {
  constexpr double kParallel = 0.9998;
  std::vector<std::pair<double, double>> ledges;
  for (const std::vector<std::uint32_t>& polygon : polygons_) {
    const Vector3& first = vertices_[polygon.front()];
    Vector3 area = Vector3::Zero();
    for (std::size_t i = 2; i < polygon.size(); ++i) {
      area += 0.5 * (vertices_[polygon[i - 1]] - first).cross(vertices_[polygon[i]] - first);
    }
    if (std::abs(area.dot(normal)) < kParallel * area.norm() || area.isZero(0.0)) continue;
    ledges.emplace_back(normal.dot(first), area.norm());
  }
  std::sort(ledges.begin(), ledges.end());
  return ledges;
}

}  // namespace tccm
