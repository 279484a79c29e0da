#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "tccm_monitor/pose.h"
#include "tccm_monitor/shape.h"

namespace tccm::simulation {

/// An ideal camera. The ray of a pixel is ((column - centre_column) / focal, (row - centre_row) /
/// focal, 1), in an optical frame: z ahead, x right, y down.
struct Pinhole {
  std::size_t width = 640;
  std::size_t height = 480;
  double focal_px = 400.0;

  /// As wide a view in fewer pixels, or in more.
  [[nodiscard]] static Pinhole ofWidth(std::size_t width) {
    const Pinhole whole;
    return {width, width * whole.height / whole.width,
            whole.focal_px * static_cast<double>(width) / static_cast<double>(whole.width)};
  }
  [[nodiscard]] double centreColumn() const { return 0.5 * static_cast<double>(width - 1); }
  [[nodiscard]] double centreRow() const { return 0.5 * static_cast<double>(height - 1); }
};

/// The nearest surface in each pixel: a Z-buffer in which primitives are drawn exactly, up to the
/// rounding of floats. It is kept in 1 / depth, which is linear in the pixel on each plane.
class DepthImage {
 public:
  static constexpr std::uint32_t kNothing = std::numeric_limits<std::uint32_t>::max();

  explicit DepthImage(const Pinhole& camera);

  void clear();
  /// A shape that contains the camera (its own housing) is not seen. @param target what pixels()
  /// call it.
  void draw(std::uint32_t target, const Shape& shape, const Pose& T_camera_shape);

  /// A plane along a row of pixels.
  struct Face {
    float start, slope;  ///< 1 / depth at the first pixel, and from pixel to pixel
    float distance;      ///< of the camera from the plane [m]
  };

  // One for each pixel, row by row.
  [[nodiscard]] const std::vector<float>& inverseDepths() const { return inverse_depths_; }
  /// The cosine of the angle from the surface's normal to the ray, times the length of the ray that
  /// Pinhole has.
  [[nodiscard]] const std::vector<float>& facings() const { return facings_; }
  /// kNothing where there is none.
  [[nodiscard]] const std::vector<std::uint32_t>& targets() const { return targets_; }

 private:
  struct Rectangle {
    std::size_t column_begin, column_end, row_begin, row_end;
  };
  [[nodiscard]] Rectangle around(const Vector3& half_extents, const Pose& T_camera_shape) const;
  void drawBox(std::uint32_t target, const Box& box, const Pose& T_camera_box);
  void drawRow(std::uint32_t target, const std::array<Face, 3>& faces, std::size_t pixel,
               std::size_t count);
  template <typename Solid>
  void drawEach(std::uint32_t target, const Solid& solid, const Pose& T_camera_shape,
                const Rectangle& pixels);
  void put(std::size_t pixel, float inverse_depth, float facing, std::uint32_t target) {
    if (inverse_depth <= inverse_depths_[pixel]) return;
    inverse_depths_[pixel] = inverse_depth;
    facings_[pixel] = facing;
    targets_[pixel] = target;
  }

  Pinhole camera_;
  std::vector<float> inverse_depths_;  ///< [1/m]; 0: nothing
  std::vector<float> facings_;
  std::vector<std::uint32_t> targets_;
};

}  // namespace tccm::simulation
