#pragma once

#include <array>
#include <cstddef>

#include "tccm_monitor/pose.h"

namespace tccm {

/// The corners of a point, segment, triangle or tetrahedron, for the distance algorithm of Gilbert,
/// Johnson and Keerthi (1988).
class Simplex {
 public:
  [[nodiscard]] bool isFull() const { return count_ == points_.size(); }

  void add(const Vector3& p) { points_[count_++] = p; }

  /// The point of the simplex nearest to 0; the newest corner must be one of those it lies between,
  /// and just these are kept: all four where 0 is inside. However flat the simplex is, the point is
  /// an average of its corners with weights above 0, and so in the simplex but for rounding.
  Vector3 reduce() {
    const Vector3 newest = points_[count_ - 1];
    nearest_ = newest;
    least_ = newest.squaredNorm();
    kept_ = 0;
    for (unsigned i = 0; i + 1 < count_; ++i) {
      edges_[i] = points_[i] - newest;
      offerEdge(i);
      for (unsigned j = 0; j < i; ++j) offerTriangle(i, j);
    }
    if (isFull()) offerTetrahedron();
    std::size_t count = 0;
    for (unsigned i = 0; i + 1 < count_; ++i) {
      if (kept_ & (1U << i)) points_[count++] = points_[i];
    }
    points_[count++] = newest;
    count_ = count;
    return nearest_;
  }

 private:
  void offer(const Vector3& p, unsigned corners) {
    const double norm2 = p.squaredNorm();
    if (!(norm2 < least_)) return;
    nearest_ = p;
    least_ = norm2;
    kept_ = corners;
  }

  void offerEdge(unsigned i) {
    const double along = -newest().dot(edges_[i]);
    const double length2 = edges_[i].squaredNorm();
    if (!(along > 0.0 && along < length2)) return;
    offer(newest() + along / length2 * edges_[i], 1U << i);
  }

  void offerTriangle(unsigned i, unsigned j) {
    const Vector3 normal = edges_[i].cross(edges_[j]);
    const double area2 = normal.squaredNorm();
    const double to_i = edges_[j].cross(newest()).dot(normal);
    const double to_j = newest().cross(edges_[i]).dot(normal);
    if (!(to_i > 0.0 && to_j > 0.0 && to_i + to_j < area2)) return;
    offer(newest() + to_i / area2 * edges_[i] + to_j / area2 * edges_[j], 1U << i | 1U << j);
  }

  void offerTetrahedron() {
    const Vector3 normal = edges_[1].cross(edges_[2]);
    const Vector3 moment = edges_[0].cross(newest());
    const double volume = edges_[0].dot(normal);
    const double a = -newest().dot(normal) / volume;
    const double b = -edges_[2].dot(moment) / volume;
    const double c = edges_[1].dot(moment) / volume;
    if (!(a > 0.0 && b > 0.0 && c > 0.0 && a + b + c < 1.0)) return;
    offer(newest() + a * edges_[0] + b * edges_[1] + c * edges_[2], 7U);
  }

  [[nodiscard]] const Vector3& newest() const { return points_[count_ - 1]; }

  std::array<Vector3, 4> points_;
  std::size_t count_ = 0;
  std::array<Vector3, 3> edges_;  ///< from the newest corner to the others
  Vector3 nearest_;
  double least_ = 0.0;  ///< its squared norm
  unsigned kept_ = 0;   ///< bit i: corner i is needed for it
};

}  // namespace tccm
