#include "tccm_monitor/check/z_buffer.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "solid_view.h"

namespace tccm {
namespace {

using view::AngularBounds;
using view::cornerBounds;
using view::cross;
using view::Entry;

constexpr double kPi = 3.14159265358979323846;
constexpr ZBuffer::Pixel kEmpty{std::numeric_limits<float>::infinity(), 0, false};

constexpr int kBins = 4096;
constexpr int kNarrow = 2;  // columns on either side of its middle that most cuboids reach at most

/// Rises with the angle of (x, y) like std::atan2, from -2 to 2, at a fraction of the cost: the
/// place on the square |x| + |y| = 1.
double squareAngle(double x, double y) {
  const double quarter = y / (std::abs(x) + std::abs(y));
  if (x >= 0.0) return quarter;
  return y >= 0.0 ? 2.0 - quarter : -2.0 - quarter;
}

/// The direction at a square angle.
Eigen::Vector2d squareDirection(double angle) {
  if (angle > 1.0) return {1.0 - angle, 2.0 - angle};
  if (angle < -1.0) return {1.0 + angle, -2.0 - angle};
  return {1.0 - std::abs(angle), angle};
}

/// Of kBins equal parts of the square angles from lowest to -lowest.
std::size_t binOf(double angle, double lowest) {
  const int bin = static_cast<int>((angle - lowest) * (kBins / (-2.0 * lowest)));
  return static_cast<std::size_t>(std::clamp(bin, 0, kBins - 1));
}

/// Rounding must not put a direction at a bin's very start into a row or column too high.
double binStart(int bin, double lowest) { return lowest - (2.0 * lowest * bin) / kBins - 1e-9; }

}  // namespace

ZBuffer::ZBuffer(double resolution)
    : resolution_(kPi / std::ceil(kPi / resolution)),
      rows_(static_cast<int>(std::lround(kPi / resolution_))),
      columns_(2 * rows_),
      rows_a_pixel_(1.0 / columns_),
      narrow_sine_(std::sin(std::min(kNarrow * resolution_, 0.25 * kPi))),
      pixels_(static_cast<std::size_t>(rows_ * columns_), kEmpty),
      level_rays_(static_cast<std::size_t>(columns_)),
      column_farthest_(static_cast<std::size_t>(columns_), 0.0F),
      neighbours_farthest_(static_cast<std::size_t>(columns_), 0.0F) {
  drawn_.reserve(pixels_.size());
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
  for (int bin = 0; bin < kBins; ++bin) {
    const Eigen::Vector2d slope = squareDirection(std::max(-1.0, binStart(bin, -1.0)));
    bin_rows_.push_back(rowOf(std::atan2(slope.y(), slope.x())));
    const Eigen::Vector2d level = squareDirection(std::max(-2.0, binStart(bin, -2.0)));
    bin_columns_.push_back(columnOf(bin == 0 ? -kPi : std::atan2(level.y(), level.x())));
  }
}

void ZBuffer::begin(const Vector3& viewpoint) {
  viewpoint_ = viewpoint;
  for (const std::uint32_t index : drawn_) pixels_[index] = kEmpty;
  drawn_.clear();
  std::fill(column_farthest_.begin(), column_farthest_.end(), 0.0F);
  neighbours_known_ = false;
  farthest_ = 0.0F;
  lowest_row_ = rows_;
  highest_row_ = -1;
}

int ZBuffer::rowOf(double elevation) const {
  const auto row = static_cast<int>(std::floor((elevation + 0.5 * kPi) / resolution_));
  return std::clamp(row, 0, rows_ - 1);
}

int ZBuffer::rowOfSlope(double level, double height) const {
  int row = bin_rows_[binOf(squareAngle(level, height), -1.0)];
  while (row + 1 < rows_ && height >= level * row_borders_[static_cast<std::size_t>(row + 1)]) {
    ++row;
  }
  return row;
}

int ZBuffer::columnOf(double azimuth) const {
  return static_cast<int>(std::floor((azimuth + kPi) / resolution_));
}

int ZBuffer::columnOfDirection(const Eigen::Vector2d& direction) const {
  int column = bin_columns_[binOf(squareAngle(direction.x(), direction.y()), -2.0)];
  while (column + 1 < columns_ &&
         cross(column_borders_[static_cast<std::size_t>(column + 1)], direction) >= 0.0) {
    ++column;
  }
  return column;
}

int ZBuffer::columnFrom(int column, const Eigen::Vector2d& direction) const {
  const auto isLeftOf = [&](int border) {
    return cross(column_borders_[static_cast<std::size_t>(border)], direction) >= 0.0;
  };
  const auto next = [this](int c) { return c + 1 < columns_ ? c + 1 : 0; };
  while (!isLeftOf(column)) column = column > 0 ? column - 1 : columns_ - 1;
  while (isLeftOf(next(column))) column = next(column);
  return column;
}

ZBuffer::Window ZBuffer::windowOf(const Shape& shape, const Pose& T_fixed_shape) const {
  const Vector3 to_shape = T_fixed_shape.translation() - viewpoint_;
  const double range = to_shape.norm();
  const double radius = boundingRadius(shape);
  const AngularBounds angles = cornerBounds(shape, T_fixed_shape, to_shape);
  Window window{rowOf(angles.elevation_low), rowOf(angles.elevation_high) + 1, 0, columns_};
  if (angles.azimuth) {
    const double azimuth = std::atan2(to_shape.y(), to_shape.x());
    const int first = columnOf(azimuth + angles.azimuth->low);
    const int last = columnOf(azimuth + angles.azimuth->high);
    const int turn = first < 0 ? columns_ : first >= columns_ ? -columns_ : 0;
    window.column_begin = first + turn;
    window.column_end = last + turn + 1;
  }
  if (range <= radius) return window;
  const double elevation = std::asin(std::clamp(to_shape.z() / range, -1.0, 1.0));
  const double angular_radius = std::asin(radius / range);
  window.row_begin = std::max(window.row_begin, rowOf(elevation - angular_radius));
  window.row_end = std::min(window.row_end, rowOf(elevation + angular_radius) + 1);
  return window;
}

void ZBuffer::draw(const Shape& shape, const Pose& T_fixed_shape, std::uint32_t index) {
  const double nearest = distance(shape, T_fixed_shape.inverse() * viewpoint_);
  if (nearest == 0.0) return;
  const Window window = windowOf(shape, T_fixed_shape);
  // Rounded down: what is nearer already stays.
  const auto depth_min = static_cast<float>(nearest * (1.0 - 1e-6));
  std::visit([&](const auto& solid) { drawIn(window, solid, T_fixed_shape, index, depth_min); },
             shape);
  neighbours_known_ = false;
}

void ZBuffer::findNeighbours() {
  constexpr int kMargin = kNarrow + 1;
  for (int c = 0; c < columns_; ++c) {
    float farthest = 0.0F;
    for (int k = c - kMargin; k <= c + kMargin; ++k) {
      const int column = k < 0 ? k + columns_ : k < columns_ ? k : k - columns_;
      farthest = std::max(farthest, column_farthest_[static_cast<std::size_t>(column)]);
    }
    neighbours_farthest_[static_cast<std::size_t>(c)] = farthest;
    farthest_ = std::max(farthest_, farthest);
  }
  neighbours_known_ = true;
}

template <typename Solid>
void ZBuffer::drawIn(const Window& window, const Solid& solid, const Pose& T_fixed_shape,
                     std::uint32_t index, float depth_min) {
  const Eigen::Matrix3d R_shape_fixed = T_fixed_shape.linear().transpose();
  const Vector3 to_shape = T_fixed_shape.translation() - viewpoint_;
  Entry<Solid> entry(solid, R_shape_fixed * -to_shape);
  const double range = to_shape.norm();
  const double reach = std::min(1.0, boundingRadius(solid) / range);
  // Rays further from the centre's direction than this miss the sphere around the shape.
  const double along_least = reach < 1.0 ? range * std::sqrt(1.0 - reach * reach) - 1e-9 : -range;
  // A ray's direction is its column's, level with the viewpoint, times the cosine of its row's
  // elevation, and upwards by the sine.
  for (int c = window.column_begin; c < window.column_end; ++c) {
    const auto column = static_cast<std::size_t>(c < columns_ ? c : c - columns_);
    const Eigen::Vector2d& level = column_middles_[column];
    level_rays_[column] = {R_shape_fixed.leftCols<2>() * level, to_shape.head<2>().dot(level)};
  }
  for (int row = window.row_begin; row < window.row_end; ++row) {
    Pixel* pixels = &pixels_[static_cast<std::size_t>(row * columns_)];
    const double cosine = cosines_[static_cast<std::size_t>(row)];
    const double sine = sines_[static_cast<std::size_t>(row)];
    const Vector3 upwards = R_shape_fixed.col(2) * sine;
    const double along_level_least = along_least - to_shape.z() * sine;
    // Rounded up, so that nothing is left out that stands just in front.
    const auto level = static_cast<float>(cosine * (1.0 + 1e-6));
    bool any = false;
    for (int c = window.column_begin; c < window.column_end; ++c) {
      const int column = c < columns_ ? c : c - columns_;
      const LevelRay& ray = level_rays_[static_cast<std::size_t>(column)];
      Pixel& pixel = pixels[column];
      if (pixel.depth < depth_min || cosine * ray.along < along_level_least) continue;
      const auto depth = static_cast<float>(entry(cosine * ray.direction + upwards));
      // Of two at the same depth the first of the body is shown, in whichever order they come.
      if (!(depth < pixel.depth || (depth == pixel.depth && index < pixel.shape))) continue;
      if (std::isinf(pixel.depth)) {
        drawn_.push_back(static_cast<std::uint32_t>(&pixel - pixels_.data()));
      }
      pixel = {depth, index, false};
      float& farthest = column_farthest_[static_cast<std::size_t>(column)];
      farthest = std::max(farthest, depth * level);
      any = true;
    }
    if (!any) continue;
    lowest_row_ = std::min(lowest_row_, row);
    highest_row_ = std::max(highest_row_, row);
  }
}

std::optional<ZBuffer::Silhouette> ZBuffer::silhouette(const CuboidMap& map, std::uint32_t cuboid) {
  if (!neighbours_known_) findNeighbours();
  const Cuboid& c = map.cuboids[cuboid];
  const Eigen::Vector2d centre = map.grid.centre(c.cell) - viewpoint_.head<2>();
  const double half_diagonal = std::sqrt(0.5) * map.grid.config().cell_size_m;
  const double range2 = centre.squaredNorm();
  // As below, without a root for most, and with room for rounding.
  const double range_max = farthest_ + half_diagonal + 1e-6;
  if (range2 > range_max * range_max) return std::nullopt;
  const double range = std::sqrt(range2);
  Silhouette s{};
  s.cuboid = cuboid;
  s.near = std::max(range - half_diagonal, 1e-3);
  if (s.near > farthest_) return std::nullopt;
  s.far = range + half_diagonal;
  s.bottom = map.grid.metres(c.bottom) - viewpoint_.z();
  s.top = map.grid.metres(c.top) - viewpoint_.z();
  s.column_end = columns_;
  if (range > half_diagonal) {
    const int middle = columnOfDirection(centre);
    const bool is_narrow = half_diagonal < range * narrow_sine_;
    if (is_narrow && neighbours_farthest_[static_cast<std::size_t>(middle)] <= s.near) {
      return std::nullopt;
    }
    // The tangents from the viewpoint to the circle around the cell.
    const double length = std::sqrt(range * range - half_diagonal * half_diagonal);
    const Eigen::Vector2d across = half_diagonal * Eigen::Vector2d(-centre.y(), centre.x());
    const Eigen::Vector2d right = length * centre - across, left = length * centre + across;
    s.column_begin = is_narrow ? columnFrom(middle, right) : columnOfDirection(right);
    s.column_end = (is_narrow ? columnFrom(middle, left) : columnOfDirection(left)) + 1;
    if (s.column_end <= s.column_begin) s.column_end += columns_;
    if (!reachesBehind(s)) return std::nullopt;
  }
  s.row_begin = std::max(rowOfSlope(s.bottom < 0.0 ? s.near : s.far, s.bottom), lowest_row_);
  s.row_end = std::min(rowOfSlope(s.top < 0.0 ? s.far : s.near, s.top), highest_row_) + 1;
  if (s.row_begin >= s.row_end) return std::nullopt;
  return s;
}

bool ZBuffer::reachesBehind(const Silhouette& s) const {
  for (int c = s.column_begin; c < s.column_end; ++c) {
    const int column = c < columns_ ? c : c - columns_;
    if (column_farthest_[static_cast<std::size_t>(column)] > s.near) return true;
  }
  return false;
}

double ZBuffer::depthOf(const Silhouette& s, int row) const {
  const double tangent = tangents_[static_cast<std::size_t>(row)];
  double range = s.near;
  if (tangent < 0.0 && range * tangent > s.top) range = s.top / tangent;
  if (tangent > 0.0 && range * tangent < s.bottom) range = s.bottom / tangent;
  return std::clamp(range, s.near, s.far) / cosines_[static_cast<std::size_t>(row)];
}

bool ZBuffer::cover(const Silhouette& s, double margin) {
  bool any = false;
  for (int row = s.row_begin; row < s.row_end; ++row) {
    const auto limit = static_cast<float>(depthOf(s, row) + margin);
    Pixel* pixels = &pixels_[static_cast<std::size_t>(row * columns_)];
    for (int c = s.column_begin; c < s.column_end; ++c) {
      Pixel& pixel = pixels[c < columns_ ? c : c - columns_];
      if (std::isinf(pixel.depth) || pixel.depth <= limit) continue;
      pixel.covered = true;
      any = true;
    }
  }
  return any;
}

}  // namespace tccm
