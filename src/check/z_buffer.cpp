#include "tccm_monitor/check/z_buffer.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "tccm_monitor/geometry/line_span.h"

namespace tccm {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr ZBuffer::Pixel kEmpty{std::numeric_limits<float>::infinity(), 0, false};

constexpr int kBins = 4096;

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

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

/// Half the extents of a box in the shape's own frame that contains it.
struct HalfExtents {
  Vector3 operator()(const Box& box) const { return box.half_extents; }
  Vector3 operator()(const Cylinder& c) const { return {c.radius, c.radius, c.half_length}; }
  Vector3 operator()(const Capsule& c) const {
    return {c.radius, c.radius, c.radius + c.half_length};
  }
  Vector3 operator()(const Sphere& s) const { return Vector3::Constant(s.radius); }
};

/// Angles that a solid cannot reach beyond: azimuth relative to that of its centre.
struct AngularBounds {
  double azimuth_low, azimuth_high;
  double elevation_low, elevation_high;
};

/// From the corners of the box around the shape. Nothing where they are not all ahead of the plane
/// through the viewpoint that stands upright across the way to the centre.
std::optional<AngularBounds> cornerBounds(const Shape& shape, const Pose& T_fixed_shape,
                                          const Vector3& to_shape) {
  const double range = to_shape.head<2>().norm();
  if (range == 0.0) return std::nullopt;
  const Eigen::Vector2d ahead = to_shape.head<2>() / range;
  const Eigen::Matrix3d edges =
      T_fixed_shape.linear() * std::visit(HalfExtents{}, shape).asDiagonal();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  double nearest = kInfinity, farthest = 0.0, lowest = kInfinity, highest = -kInfinity;
  double right = kInfinity, left = -kInfinity;  // tangents of the azimuth
  for (unsigned i = 0; i < 8; ++i) {
    const Vector3 corner =
        to_shape + edges * Vector3((i & 1U) ? 1 : -1, (i & 2U) ? 1 : -1, (i & 4U) ? 1 : -1);
    const Eigen::Vector2d level = corner.head<2>();
    const double along = ahead.dot(level);
    if (along < 1e-3) return std::nullopt;
    const double tangent = cross(ahead, level) / along;
    right = std::min(right, tangent);
    left = std::max(left, tangent);
    nearest = std::min(nearest, along);
    farthest = std::max(farthest, level.norm());
    lowest = std::min(lowest, corner.z());
    highest = std::max(highest, corner.z());
  }
  return AngularBounds{std::atan(right), std::atan(left),
                       std::atan(lowest / (lowest < 0.0 ? nearest : farthest)),
                       std::atan(highest / (highest < 0.0 ? farthest : nearest))};
}

}  // namespace

ZBuffer::ZBuffer(double resolution)
    : resolution_(kPi / std::ceil(kPi / resolution)),
      rows_(static_cast<int>(std::lround(kPi / resolution_))),
      columns_(2 * rows_),
      pixels_(static_cast<std::size_t>(rows_ * columns_), kEmpty),
      column_farthest_(static_cast<std::size_t>(columns_), 0.0F) {
  directions_.reserve(pixels_.size());
  drawn_.reserve(pixels_.size());
  for (int row = 0; row < rows_; ++row) {
    const double elevation = (row + 0.5) * resolution_ - 0.5 * kPi;
    cosines_.push_back(std::cos(elevation));
    tangents_.push_back(std::tan(elevation));
    row_borders_.push_back(std::tan(row * resolution_ - 0.5 * kPi));
    for (int column = 0; column < columns_; ++column) {
      const double azimuth = (column + 0.5) * resolution_ - kPi;
      directions_.emplace_back(std::cos(elevation) * std::cos(azimuth),
                               std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
    }
  }
  for (int column = 0; column < columns_; ++column) {
    const double azimuth = column * resolution_ - kPi;
    column_borders_.emplace_back(std::cos(azimuth), std::sin(azimuth));
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

ZBuffer::Window ZBuffer::windowOf(const Shape& shape, const Pose& T_fixed_shape) const {
  const Vector3 to_shape = T_fixed_shape.translation() - viewpoint_;
  const double range = to_shape.norm();
  const double radius = boundingRadius(shape);
  Window window{0, rows_, 0, columns_};
  if (const auto corners = cornerBounds(shape, T_fixed_shape, to_shape)) {
    const double azimuth = std::atan2(to_shape.y(), to_shape.x());
    const int first = columnOf(azimuth + corners->azimuth_low);
    const int last = columnOf(azimuth + corners->azimuth_high);
    const int turn = first < 0 ? columns_ : first >= columns_ ? -columns_ : 0;
    window = {rowOf(corners->elevation_low), rowOf(corners->elevation_high) + 1, first + turn,
              last + turn + 1};
  }
  if (range <= radius) return window;
  const double elevation = std::asin(std::clamp(to_shape.z() / range, -1.0, 1.0));
  const double angular_radius = std::asin(radius / range);
  window.row_begin = std::max(window.row_begin, rowOf(elevation - angular_radius));
  window.row_end = std::min(window.row_end, rowOf(elevation + angular_radius) + 1);
  return window;
}

void ZBuffer::draw(const Shape& shape, const Pose& T_fixed_shape, std::uint32_t index) {
  const Vector3 viewpoint_shape = T_fixed_shape.inverse() * viewpoint_;
  if (distance(shape, viewpoint_shape) == 0.0) return;
  const Window window = windowOf(shape, T_fixed_shape);
  std::visit([&](const auto& solid) { drawIn(window, solid, T_fixed_shape, index); }, shape);
}

template <typename Solid>
void ZBuffer::drawIn(const Window& window, const Solid& solid, const Pose& T_fixed_shape,
                     std::uint32_t index) {
  const Eigen::Matrix3d R_shape_fixed = T_fixed_shape.linear().transpose();
  const Vector3 to_shape = T_fixed_shape.translation() - viewpoint_;
  Ray ray{R_shape_fixed * -to_shape, Vector3::UnitX()};
  const double range = to_shape.norm();
  const double reach = std::min(1.0, boundingRadius(solid) / range);
  // Rays further from the centre's direction than this miss the sphere around the shape.
  const double along_least = reach < 1.0 ? range * std::sqrt(1.0 - reach * reach) - 1e-9 : -range;
  for (int row = window.row_begin; row < window.row_end; ++row) {
    const auto row_start = static_cast<std::size_t>(row * columns_);
    const Vector3* directions = &directions_[row_start];
    Pixel* pixels = &pixels_[row_start];
    // Rounded up, so that nothing is left out that stands just in front.
    const auto level = static_cast<float>(cosines_[static_cast<std::size_t>(row)] * (1.0 + 1e-6));
    bool any = false;
    for (int c = window.column_begin; c < window.column_end; ++c) {
      const int column = c < columns_ ? c : c - columns_;
      if (to_shape.dot(directions[column]) < along_least) continue;
      ray.direction = R_shape_fixed * directions[column];
      const LineSpan span = lineSpan(solid, ray);
      if (span.empty() || span.leave < 0.0) continue;
      const auto depth = static_cast<float>(std::max(0.0, span.enter));
      Pixel& pixel = pixels[column];
      if (depth >= pixel.depth) continue;
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
  farthest_ = *std::max_element(column_farthest_.begin(), column_farthest_.end());
}

std::optional<ZBuffer::Silhouette> ZBuffer::silhouette(const CuboidMap& map,
                                                       std::uint32_t cuboid) const {
  const Cuboid& c = map.cuboids[cuboid];
  const Eigen::Vector2d centre = map.grid.centre(c.cell) - viewpoint_.head<2>();
  const double half_diagonal = std::sqrt(0.5) * map.grid.config().cell_size_m;
  const double range = centre.norm();
  Silhouette s{};
  s.cuboid = cuboid;
  s.near = std::max(range - half_diagonal, 1e-3);
  if (s.near > farthest_) return std::nullopt;
  s.far = range + half_diagonal;
  s.bottom = map.grid.metres(c.bottom) - viewpoint_.z();
  s.top = map.grid.metres(c.top) - viewpoint_.z();
  s.column_end = columns_;
  if (range > half_diagonal) {
    // The tangents from the viewpoint to the circle around the cell.
    const double length = std::sqrt(range * range - half_diagonal * half_diagonal);
    const Eigen::Vector2d across = half_diagonal * Eigen::Vector2d(-centre.y(), centre.x());
    s.column_begin = columnOfDirection(length * centre - across);
    s.column_end = columnOfDirection(length * centre + across) + 1;
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
