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

  /// What the sensor says of what a pixel shows.
  enum class Sight : std::uint8_t { kNotAsked, kVisible, kOccluded, kUnseen };
  /// What a pixel has beside its depth; old where nothing is drawn.
  struct Shown {
    std::uint32_t shape;  ///< the nearest primitive
    Sight sight;          ///< where it is visible no cuboid is asked to cover it
    bool covered;         ///< a cuboid lies in front of it
  };
  struct Pixel : Shown {
    float depth;  ///< [m]; infinite where nothing is drawn
  };
  /// Pixels side by side in one row where a primitive was drawn and nothing was before.
  struct Run {
    int row;
    std::uint32_t begin, end;
  };
  /// What a later primitive was drawn over.
  struct Hidden {
    std::uint32_t pixel;
    Pixel before;
  };
  /// How much was drawn so far.
  struct Mark {
    std::size_t runs = 0, hidden = 0;
  };

  /// Empties the picture and moves the camera.
  void begin(const Vector3& viewpoint);
  [[nodiscard]] Mark mark() const { return {runs_.size(), hidden_.size()}; }
  /// Takes back what was drawn since, and whatever is covered.
  void takeBack(const Mark& mark);
  [[nodiscard]] const Vector3& viewpoint() const { return viewpoint_; }
  /// Draws a primitive where it is the nearest. One that contains the viewpoint is left out.
  void draw(const Shape& shape, const Pose& T_fixed_shape, std::uint32_t index);
  /// For what the sensor says of them to be noted.
  [[nodiscard]] Shown* editShown() {
    columns_known_ = false;
    return shown_.data();
  }
  /// Covers the pixels not visible that a cuboid lies in front of by more than the margin [m].
  /// Every pixel it reaches into counts: scans are sparser than pixels.
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
  [[nodiscard]] Pixel pixel(int row, int column) const {
    return pixelAt(static_cast<std::uint32_t>(grid_.index(row, column)));
  }
  /// Together all pixels that show a primitive, each in one run.
  [[nodiscard]] const std::vector<Run>& runs() const { return runs_; }
  [[nodiscard]] const std::vector<Hidden>& hidden() const { return hidden_; }
  /// The indices of covered pixels.
  [[nodiscard]] const std::vector<std::uint32_t>& covered() const { return covered_; }
  [[nodiscard]] Pixel pixelAt(std::uint32_t index) const { return {shown_[index], depths_[index]}; }
  [[nodiscard]] const float* depths() const { return depths_.data(); }

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
  /// Every pixel whose ray can meet the shape lies in it.
  [[nodiscard]] Window windowOf(const Shape& shape, const Pose& T_fixed_shape) const;
  void drawFrom(double nearest, const Shape& shape, const Pose& T_fixed_shape, std::uint32_t index);
  void findLevelRays(const Window& window, const Eigen::Matrix3d& R_shape_fixed,
                     const Vector3& to_shape);
  template <typename Solid>
  void drawIn(const Window& window, const Solid& solid, const Pose& T_fixed_shape,
              std::uint32_t index, float depth_min);
  /// Shows a primitive in some columns of a row where it is the nearest. @param depths by column.
  void show(int row, int begin, int end, const float* depths, std::uint32_t index);
  void noteIfFull(int row);
  /// Nothing where the cuboid lies in front of nothing that is drawn and not visible.
  [[nodiscard]] std::optional<Silhouette> silhouetteOf(const CuboidMap& map,
                                                       const Cuboid& cuboid) const;
  /// Whether something that is drawn in its columns is further away than its near side.
  [[nodiscard]] bool reachesBehind(const Silhouette& silhouette) const;
  [[nodiscard]] double depthOf(const Silhouette& silhouette, int row) const;

  DirectionGrid grid_;
  double narrow_sine_;  ///< of half the angle that a cuboid of few columns takes up
  Vector3 viewpoint_ = Vector3::Zero();
  // Of each pixel. Depths alone, as most of what is drawn is compared with them and no more.
  std::vector<float> depths_;
  std::vector<Shown> shown_;
  std::vector<Run> runs_;
  std::vector<Hidden> hidden_;
  std::vector<std::uint32_t> covered_;
  std::vector<int> row_drawn_;  ///< how many pixels of each row
  /// Of each row no pixel is further away; infinite where one shows nothing [m].
  std::vector<float> row_farthest_;
  Eigen::ArrayX2d columns_;  ///< directions of their middles
  // Of each column, for the shape being drawn: the ray at elevation 0 in its frame, and how far its
  // centre is ahead along it [m]; and the depths in a row.
  Eigen::ArrayX4d level_rays_;
  Eigen::ArrayXf found_;
  // Horizontal distance of the farthest that is drawn and not visible, in each column and in all
  // [m]; 0 for nothing.
  Eigen::ArrayXf column_farthest_;
  Eigen::ArrayXf neighbours_farthest_;  ///< of a column and some to either side
  bool columns_known_ = false;
  float farthest_ = 0.0F;
  int lowest_row_ = 0;  ///< of all that is drawn and not visible
  int highest_row_ = -1;
};

}  // namespace tccm
