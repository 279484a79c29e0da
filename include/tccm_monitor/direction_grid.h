#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "tccm_monitor/pose.h"

namespace tccm {

/// What follows is asked for each cuboid and each beam: it is inline for that.
namespace directions {

inline constexpr int kBins = 4096;

inline double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

/// Rises with the angle of (x, y) like std::atan2, from -2 to 2, at a fraction of the cost: the
/// place on the square |x| + |y| = 1.
inline double squareAngle(double x, double y) {
  const double quarter = y / (std::abs(x) + std::abs(y));
  if (x >= 0.0) return quarter;
  return y >= 0.0 ? 2.0 - quarter : -2.0 - quarter;
}

/// Of kBins equal parts of the square angles from lowest to -lowest.
inline std::size_t binOf(double angle, double lowest) {
  const int bin = static_cast<int>((angle - lowest) * (kBins / (-2.0 * lowest)));
  return static_cast<std::size_t>(std::clamp(bin, 0, kBins - 1));
}

}  // namespace directions

/// Directions in the fixed frame as pixels of equal steps in azimuth (about z) and elevation (over
/// the xy plane): a tilting scanner sees further round than a plane can show. Rows go from straight
/// down to straight up, columns from azimuth -pi on, counterclockwise.
class DirectionGrid {
 public:
  /// @param resolution edge of a pixel at the horizon [rad], above 0; made a little smaller where
  /// it does not divide pi.
  explicit DirectionGrid(double resolution);

  [[nodiscard]] double resolution() const { return resolution_; }
  [[nodiscard]] int rows() const { return rows_; }
  [[nodiscard]] int columns() const { return columns_; }
  [[nodiscard]] std::size_t pixels() const { return static_cast<std::size_t>(rows_ * columns_); }
  [[nodiscard]] std::size_t index(int row, int column) const {
    return static_cast<std::size_t>(row * columns_ + column);
  }
  [[nodiscard]] int rowOfPixel(std::size_t index) const {
    return static_cast<int>((static_cast<double>(index) + 0.5) * rows_a_pixel_);
  }
  /// A column that may have run past either end, by less than a turn.
  [[nodiscard]] int wrapped(int column) const {
    return column < 0 ? column + columns_ : column < columns_ ? column : column - columns_;
  }

  [[nodiscard]] int rowOf(double elevation) const;
  /// @param level horizontal distance above 0, to a point of that height over the viewpoint.
  [[nodiscard]] int rowOfSlope(double level, double height) const;
  /// Runs past the last column, or below the first, where the azimuth is beyond +-pi.
  [[nodiscard]] int columnOf(double azimuth) const;
  /// @param direction of any length above 0.
  [[nodiscard]] int columnOfDirection(const Eigen::Vector2d& direction) const;
  /// The same for a direction near a column.
  [[nodiscard]] int columnFrom(int column, const Eigen::Vector2d& direction) const;
  /// The pixel of a direction of any length above 0.
  [[nodiscard]] std::size_t pixelOf(const Vector3& direction) const;

  /// Of the elevation in the middle of a row.
  [[nodiscard]] double cosine(int row) const { return cosines_[static_cast<std::size_t>(row)]; }
  [[nodiscard]] double sine(int row) const { return sines_[static_cast<std::size_t>(row)]; }
  [[nodiscard]] double tangent(int row) const { return tangents_[static_cast<std::size_t>(row)]; }
  /// The horizontal unit vector in the middle of a column.
  [[nodiscard]] const Eigen::Vector2d& columnMiddle(int column) const {
    return column_middles_[static_cast<std::size_t>(column)];
  }
  /// The unit vector in the middle of a pixel.
  [[nodiscard]] Vector3 middle(int row, int column) const {
    const Eigen::Vector2d level = cosine(row) * columnMiddle(column);
    return {level.x(), level.y(), sine(row)};
  }
  [[nodiscard]] Vector3 middle(std::size_t pixel) const {
    const int row = rowOfPixel(pixel);
    return middle(row, columnOfPixel(pixel, row));
  }
  /// Tangent of a row's lower border, and direction of a column's right border.
  [[nodiscard]] double rowBorder(int row) const {
    return row_borders_[static_cast<std::size_t>(row)];
  }
  [[nodiscard]] const Eigen::Vector2d& columnBorder(int column) const {
    return column_borders_[static_cast<std::size_t>(column)];
  }
  /// The column of a pixel in that row.
  [[nodiscard]] int columnOfPixel(std::size_t pixel, int row) const {
    return static_cast<int>(pixel) - row * columns_;
  }
  /// How many columns to either side of its own a direction at a row's middle can reach within an
  /// angle [rad]; all of them near the poles.
  [[nodiscard]] int columnsWithin(int row, double angle) const;

  /// Which pixels lie around one.
  struct Around {
    int rows;                  ///< above and below
    std::vector<int> columns;  ///< to either side, by row
  };
  /// All that a direction in a pixel can reach within an angle [rad].
  [[nodiscard]] Around around(double angle) const;
  /// Calls visit (row, column) until it says that it has seen enough. @return whether it did.
  template <typename Visit>
  bool visitAround(std::size_t pixel, const Around& around, Visit&& visit) const {
    const int middle_row = rowOfPixel(pixel);
    const int middle = columnOfPixel(pixel, middle_row);
    const int last = std::min(rows_ - 1, middle_row + around.rows);
    for (int row = std::max(0, middle_row - around.rows); row <= last; ++row) {
      const int reach = around.columns[static_cast<std::size_t>(row)];
      for (int c = middle - reach; c <= middle + reach; ++c) {
        if (visit(row, wrapped(c))) return true;
      }
    }
    return false;
  }

 private:
  double resolution_;
  int rows_;
  int columns_;
  double rows_a_pixel_;
  std::vector<double> cosines_, sines_, tangents_;  ///< of each row's middle elevation
  std::vector<double> row_borders_;                 ///< tangent of each row's lower border
  std::vector<Eigen::Vector2d> column_borders_;     ///< direction of each column's right border
  std::vector<Eigen::Vector2d> column_middles_;
  // The row and column that directions from equal parts of a circle's square begin in.
  std::vector<int> bin_rows_;
  std::vector<int> bin_columns_;
};

inline int DirectionGrid::rowOfSlope(double level, double height) const {
  int row = bin_rows_[directions::binOf(directions::squareAngle(level, height), -1.0)];
  while (row + 1 < rows_ && height >= level * row_borders_[static_cast<std::size_t>(row + 1)]) {
    ++row;
  }
  return row;
}

inline int DirectionGrid::columnOfDirection(const Eigen::Vector2d& direction) const {
  int column =
      bin_columns_[directions::binOf(directions::squareAngle(direction.x(), direction.y()), -2.0)];
  while (column + 1 < columns_ &&
         directions::cross(column_borders_[static_cast<std::size_t>(column + 1)], direction) >=
             0.0) {
    ++column;
  }
  return column;
}

inline int DirectionGrid::columnFrom(int column, const Eigen::Vector2d& direction) const {
  const auto isLeftOf = [&](int border) {
    return directions::cross(column_borders_[static_cast<std::size_t>(border)], direction) >= 0.0;
  };
  const auto next = [this](int c) { return c + 1 < columns_ ? c + 1 : 0; };
  while (!isLeftOf(column)) column = column > 0 ? column - 1 : columns_ - 1;
  while (isLeftOf(next(column))) column = next(column);
  return column;
}

inline std::size_t DirectionGrid::pixelOf(const Vector3& direction) const {
  const double level = direction.head<2>().norm();
  if (level == 0.0) return index(direction.z() < 0.0 ? 0 : rows_ - 1, 0);
  return index(rowOfSlope(level, direction.z()), columnOfDirection(direction.head<2>()));
}

/// Finds the pixels of directions that follow one another and mostly stay in a pixel or go on to
/// one beside it, as those of beams side by side do: what tells that they do is at hand.
class PixelFollower {
 public:
  explicit PixelFollower(const DirectionGrid& grid) : grid_(grid) { moveTo(0, 0); }

  [[nodiscard]] std::size_t pixel() const { return pixel_; }
  [[nodiscard]] Vector3 middle() const { return grid_.middle(row_, column_); }
  /// To the pixel of a direction of any length above 0.
  void follow(const Vector3& direction) {
    const Eigen::Vector2d level = direction.head<2>();
    const double length = level.norm();
    Step step = stepTo(level, length, direction.z());
    if (is_inner_ && step.rows == 0 && step.columns == 0) return;
    if (is_inner_) {
      moveTo(row_ + step.rows, column_ + step.columns);
      step = stepTo(level, length, direction.z());
    }
    if (is_inner_ && step.rows == 0 && step.columns == 0) return;
    const std::size_t pixel = grid_.pixelOf(direction);
    const int row = grid_.rowOfPixel(pixel);
    moveTo(row, grid_.columnOfPixel(pixel, row));
  }

 private:
  struct Step {
    int rows, columns;
  };
  /// On which side of the pixel a direction lies.
  [[nodiscard]] Step stepTo(const Eigen::Vector2d& level, double length, double height) const {
    // Of what lies behind it both are true.
    const bool is_right = directions::cross(right_, level) < 0.0;
    const bool is_left = directions::cross(left_, level) >= 0.0;
    const int below = height >= length * low_ ? 0 : 1;
    const int above = height < length * high_ ? 0 : 1;
    return {above - below, is_right ? -1 : is_left ? 1 : 0};
  }
  void moveTo(int row, int column) {
    row_ = row;
    column_ = column;
    pixel_ = grid_.index(row, column);
    // Not where a border is at an end of the tables.
    is_inner_ = row > 0 && row + 1 < grid_.rows() && column > 0 && column + 1 < grid_.columns();
    if (!is_inner_) return;
    right_ = grid_.columnBorder(column);
    left_ = grid_.columnBorder(column + 1);
    low_ = grid_.rowBorder(row);
    high_ = grid_.rowBorder(row + 1);
  }

  const DirectionGrid& grid_;
  std::size_t pixel_ = 0;
  int row_ = 0, column_ = 0;
  bool is_inner_ = false;
  Eigen::Vector2d right_ = Eigen::Vector2d::Zero(), left_ = Eigen::Vector2d::Zero();
  double low_ = 0.0, high_ = 0.0;
};

}  // namespace tccm
