#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "tccm_monitor/cuboid_map.h"
#include "tccm_monitor/direction_grid.h"
#include "tccm_monitor/shape.h"

namespace tccm {

/// A spherical depth image around the sensor (paper, section IV.B). Primitives are drawn first,
/// then cuboids cover them.
class ZBuffer {
 public:
  /// @param resolution edge of a pixel at the horizon [rad].
  explicit ZBuffer(double resolution);

  struct Pixel {
    float depth;          ///< to the nearest primitive [m]; infinite where there is none
    std::uint32_t shape;  ///< that primitive
    bool covered;         ///< a cuboid lies in front of it
    bool seen;            ///< no cuboid is asked to cover it
  };

  /// Empties the picture and moves the camera.
  void begin(const Vector3& viewpoint);
  /// As if begun anew and drawn in as another was by its first so many calls of draw().
  void beginAs(const ZBuffer& other, std::size_t draws);
  [[nodiscard]] const Vector3& viewpoint() const { return viewpoint_; }
  /// Draws a primitive where it is the nearest. One that contains the viewpoint is left out.
  void draw(const Shape& shape, const Pose& T_fixed_shape, std::uint32_t index);
  /// The sensor saw as far as to what a pixel shows: whether a cuboid covers it does not matter.
  void markSeen(std::uint32_t pixel) {
    pixels_[pixel].seen = true;
    columns_known_ = false;
  }
  /// Covers the pixels not seen that a cuboid lies in front of by more than the margin [m]. Every
  /// pixel it reaches into counts: scans are sparser than pixels.
  /// @return whether it covers any.
  bool cover(const CuboidMap& map, const Cuboid& cuboid, double margin);
  /// The same with all of a map's cuboids. @param covering those that cover any, appended in order.
  void coverBy(const CuboidMap& map, double margin, std::vector<std::uint32_t>& covering);

  /// Whether there is a pixel that a cuboid could cover.
  [[nodiscard]] bool canBeCovered() {
    if (!columns_known_) findColumns();
    return farthest_ > 0.0F;
  }
  [[nodiscard]] const DirectionGrid& grid() const { return grid_; }
  [[nodiscard]] const Pixel& pixel(int row, int column) const {
    return pixels_[grid_.index(row, column)];
  }
  /// The indices of the pixels that show a primitive.
  [[nodiscard]] const std::vector<std::uint32_t>& drawn() const { return drawn_; }
  [[nodiscard]] const Pixel& pixelAt(std::uint32_t index) const { return pixels_[index]; }

 private:
  /// Where something may show: elevations, and azimuths, not below 0, that may run past the last
  /// column and wrap.
  struct Window {
    int row_begin, row_end, column_begin, column_end;
  };
  /// Where a cuboid stands in the picture.
  struct Silhouette {
    Window window;
    double near, far;    ///< horizontal distance [m]
    double bottom, top;  ///< height above the viewpoint [m]
  };
  void findColumns();
  [[nodiscard]] UprightBox reach(double cell_size) const;
  /// A ray at elevation 0.
  struct LevelRay {
    Vector3 direction;  ///< in the shape's frame
    double along;       ///< [m] that the shape's centre is ahead
  };
  /// Every pixel whose ray can meet the shape lies in it.
  [[nodiscard]] Window windowOf(const Shape& shape, const Pose& T_fixed_shape) const;
  void drawFrom(double nearest, const Shape& shape, const Pose& T_fixed_shape, std::uint32_t index);
  template <typename Solid>
  void drawIn(const Window& window, const Solid& solid, const Pose& T_fixed_shape,
              std::uint32_t index, float depth_min);
  /// Nothing where the cuboid lies in front of nothing that is drawn and not seen.
  [[nodiscard]] std::optional<Silhouette> silhouetteOf(const CuboidMap& map,
                                                       const Cuboid& cuboid) const;
  /// Whether something that is drawn in its columns is further away than its near side.
  [[nodiscard]] bool reachesBehind(const Silhouette& silhouette) const;
  [[nodiscard]] double depthOf(const Silhouette& silhouette, int row) const;

  DirectionGrid grid_;
  double narrow_sine_;  ///< of half the angle that a cuboid of few columns takes up
  Vector3 viewpoint_ = Vector3::Zero();
  std::vector<Pixel> pixels_;
  std::vector<LevelRay> level_rays_;  ///< of each column, for the shape being drawn
  std::vector<std::uint32_t> drawn_;
  /// What a later primitive was drawn over.
  struct Hidden {
    std::uint32_t pixel;
    Pixel before;
  };
  std::vector<Hidden> hidden_;
  /// How many pixels were drawn and hidden until the end of a draw().
  struct Draw {
    std::size_t drawn, hidden;
  };
  std::vector<Draw> draws_;
  // Horizontal distance of the farthest that is drawn and not seen, in each column and in all [m];
  // 0 for nothing.
  Eigen::ArrayXf column_farthest_;
  Eigen::ArrayXf neighbours_farthest_;  ///< of a column and some to either side
  bool columns_known_ = false;
  float farthest_ = 0.0F;
  int lowest_row_ = 0;  ///< of all that is drawn and not seen
  int highest_row_ = -1;
};

}  // namespace tccm
