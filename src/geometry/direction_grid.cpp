#include "tccm_monitor/direction_grid.h"

#include <algorithm>

namespace tccm {
namespace {

using directions::kBins;

constexpr double kPi = 3.14159265358979323846;

/// The direction at a square angle.
Eigen::Vector2d squareDirection(double angle) {
  if (angle > 1.0) return {1.0 - angle, 2.0 - angle};
  if (angle < -1.0) return {1.0 + angle, -2.0 - angle};
  return {1.0 - std::abs(angle), angle};
}

/// Rounding must not put a direction at a bin's very start into a row or column too high.
double binStart(int bin, double lowest) { return lowest - (2.0 * lowest * bin) / kBins - 1e-9; }

}  // namespace

DirectionGrid::DirectionGrid(double resolution)
    : resolution_(kPi / std::ceil(kPi / resolution)),
      rows_(static_cast<int>(std::lround(kPi / resolution_))),
      columns_(2 * rows_),
      rows_a_pixel_(1.0 / columns_) {
  for (int row = 0; row < rows_; ++row) {
    const double elevation = (row + 0.5) * resolution_ - 0.5 * kPi;
    cosines_.push_back(std::cos(elevation));
    sines_.push_back(std::sin(elevation));
    tangents_.push_back(std::tan(elevation));
    row_borders_.push_back(std::tan(row * resolution_ - 0.5 * kPi));
  }
  for (int column = 0; column < columns_; ++column) {
    const double azimuth = column * resolution_ - kPi;
    column_borders_.emplace_back(std::cos(azimuth), std::sin(azimuth));
    const double middle = (column + 0.5) * resolution_ - kPi;
    column_middles_.emplace_back(std::cos(middle), std::sin(middle));
  }
  // From bin to bin as directions are looked up: with the arc tangent of each, nearly all of the
  // time that it takes to make a checker or a map would go into that.
  std::size_t row = 0, column = 0;
  for (int bin = 0; bin < kBins; ++bin) {
    const Eigen::Vector2d slope = squareDirection(std::max(-1.0, binStart(bin, -1.0)));
    while (row + 1 < row_borders_.size() && slope.y() >= slope.x() * row_borders_[row + 1]) ++row;
    bin_rows_.push_back(static_cast<int>(row));
    const Eigen::Vector2d level = squareDirection(std::max(-2.0, binStart(bin, -2.0)));
    while (column + 1 < column_borders_.size() &&
           directions::cross(column_borders_[column + 1], level) >= 0.0) {
      ++column;
    }
    bin_columns_.push_back(static_cast<int>(column));
  }
}

int DirectionGrid::rowOf(double elevation) const {
  const auto row = static_cast<int>(std::floor((elevation + 0.5 * kPi) / resolution_));
  return std::clamp(row, 0, rows_ - 1);
}

int DirectionGrid::columnOf(double azimuth) const {
  return static_cast<int>(std::floor((azimuth + kPi) / resolution_));
}

int DirectionGrid::columnsWithin(int row, double angle) const {
  // At the row's border that is nearer to a pole circles are the smallest.
  const double cosine = cosines_[static_cast<std::size_t>(row)];
  const double sine_max = std::sin(std::min(angle, 0.5 * kPi));
  const double cosine_min = cosine - 0.5 * resolution_;
  if (cosine_min <= sine_max) return rows_;
  return std::min(rows_, static_cast<int>(std::asin(sine_max / cosine_min) / resolution_) + 1);
}

DirectionGrid::Around DirectionGrid::around(double angle) const {
  Around around{static_cast<int>(std::ceil(angle / resolution_)), {}};
  for (int row = 0; row < rows_; ++row) around.columns.push_back(columnsWithin(row, angle));
  return around;
}

}  // namespace tccm
