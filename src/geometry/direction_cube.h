#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>

namespace tccm {

/// Directions as pixels on the six faces of a cube: of a point its pixel costs one division. For
/// what is asked of every point of a cloud.
class DirectionCube {
 public:
  /// @param edge pixels along a face's edge, above 0: about pi / 2 / edge wide, narrower at edges.
  explicit DirectionCube(int edge) : edge_(edge), half_(0.5F * static_cast<float>(edge)) {}

  [[nodiscard]] int edge() const { return edge_; }
  [[nodiscard]] std::size_t pixels() const { return static_cast<std::size_t>(6 * edge_ * edge_); }

  /// @param p finite and not zero.
  [[nodiscard]] std::size_t pixelOf(const Eigen::Vector3f& p) const {
    const float x = std::abs(p.x()), y = std::abs(p.y()), z = std::abs(p.z());
    if (z >= x && z >= y) return index(p.z() < 0.0F ? 5 : 4, p.x() / z, p.y() / z);
    if (x >= y) return index(p.x() < 0.0F ? 1 : 0, p.y() / x, p.z() / x);
    return index(p.y() < 0.0F ? 3 : 2, p.z() / y, p.x() / y);
  }
  [[nodiscard]] std::size_t index(int face, int row, int column) const {
    return static_cast<std::size_t>((face * edge_ + row) * edge_ + column);
  }
  /// The unit vector to a place on a face, given in pixels from its corner.
  [[nodiscard]] Eigen::Vector3f direction(int face, float row, float column) const {
    const float u = column / half_ - 1.0F, v = row / half_ - 1.0F;
    const float main = face % 2 == 0 ? 1.0F : -1.0F;
    Eigen::Vector3f d(u, v, main);
    if (face < 2) d = {main, u, v};
    if (face == 2 || face == 3) d = {v, main, u};
    return d.normalized();
  }
  /// No direction of a square of so many pixels is further from its middle [rad].
  [[nodiscard]] double halfDiagonal(int pixels) const {
    return std::atan(std::sqrt(2.0) * pixels / edge_);
  }

 private:
  [[nodiscard]] std::size_t index(int face, float u, float v) const {
    const auto pixel = [this](float x) {
      return std::min(edge_ - 1, static_cast<int>((x + 1.0F) * half_));
    };
    return index(face, pixel(v), pixel(u));
  }

  int edge_;
  float half_;
};

}  // namespace tccm
