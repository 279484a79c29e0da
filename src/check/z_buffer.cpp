#include "check/z_buffer.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "check/column_span.h"
#include "geometry/ray.h"

namespace tccm {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr ZBuffer::Pixel kEmpty{std::numeric_limits<float>::infinity(), 0, false, false};
constexpr int kNarrow = 2;  // columns on either side of its middle that most cuboids reach at most

/// Where rays from one point outside a solid first meet it.
/// @return the way there along the direction of length 1; infinite where the ray misses [m].
template <typename Solid>
class Entry {
 public:
  Entry(const Solid& solid, const Vector3& origin)
      : solid_(solid), ray_{origin, Vector3::UnitX()} {}

  double operator()(const Vector3& direction) {
    ray_.direction = direction;
    const LineSpan span = lineSpan(solid_, ray_);
    return span.empty() || span.leave < 0.0 ? kInfinity : std::max(0.0, span.enter);
  }

 private:
  const Solid& solid_;
  Ray ray_;
};

/// Only faces whose outer side the origin is on can be entered through.
template <>
class Entry<Box> {
 public:
  Entry(const Box& box, const Vector3& origin)
      : half_(box.half_extents * (1.0 + kRounding)), origin_(origin) {
    for (int i = 0; i < 3; ++i) {
      inward_[i] = -std::copysign(1.0, origin[i]);
      beyond_[i] = std::abs(origin[i]) - box.half_extents[i];
    }
  }

  double operator()(const Vector3& direction) const {
    double enter = 0.0;
    for (int i = 0; i < 3; ++i) {
      if (beyond_[i] <= 0.0) continue;
      const double towards = inward_[i] * direction[i];
      if (!(towards > 0.0)) return kInfinity;
      enter = std::max(enter, beyond_[i] / towards);
    }
    for (int i = 0; i < 3; ++i) {
      if (std::abs(origin_[i] + enter * direction[i]) > half_[i]) return kInfinity;
    }
    return enter;
  }

 private:
  static constexpr double kRounding = 1e-12;
  Vector3 half_;
  Vector3 origin_;
  Vector3 inward_;  ///< signs of directions that lead in
  Vector3 beyond_;  ///< how far the origin is outside of the faces on its side [m]
};

/// Angles that a solid cannot reach beyond.
struct AngularBounds {
  double elevation_low = -0.5 * kPi, elevation_high = 0.5 * kPi;
  /// All its corners are ahead of the plane through the viewpoint that stands upright across the
  /// way to the centre; only then are azimuths bounded.
  bool is_ahead = false;
  double azimuth_low = 0.0, azimuth_high = 0.0;  ///< relative to that of its centre
};

/// From the corners of the box around the shape.
AngularBounds cornerBounds(const Shape& shape, const Pose& T_fixed_shape, const Vector3& to_shape) {
  const double range = to_shape.head<2>().norm();
  const Eigen::Vector2d ahead = to_shape.head<2>() / (range > 0.0 ? range : 1.0);
  const Vector3 half_extents = bounds(shape, Pose::Identity()).max();
  const Eigen::Matrix3d edges = T_fixed_shape.linear() * half_extents.asDiagonal();
  double nearest = kInfinity, farthest = 0.0, lowest = kInfinity, highest = -kInfinity;
  double right = kInfinity, left = -kInfinity;  // tangents of the azimuth
  for (unsigned i = 0; i < 8; ++i) {
    const Vector3 corner =
        to_shape + edges * Vector3((i & 1U) ? 1 : -1, (i & 2U) ? 1 : -1, (i & 4U) ? 1 : -1);
    const Eigen::Vector2d level = corner.head<2>();
    const double along = ahead.dot(level);
    const double tangent = directions::cross(ahead, level) / along;
    right = std::min(right, tangent);
    left = std::max(left, tangent);
    nearest = std::min(nearest, along);
    farthest = std::max(farthest, level.norm());
    lowest = std::min(lowest, corner.z());
    highest = std::max(highest, corner.z());
  }
  AngularBounds angles;
  angles.is_ahead = nearest >= 1e-3;
  angles.azimuth_low = std::atan(right);
  angles.azimuth_high = std::atan(left);
  if (angles.is_ahead || lowest > 0.0) {
    angles.elevation_low = std::atan(lowest / (lowest < 0.0 ? nearest : farthest));
  }
  if (angles.is_ahead || highest < 0.0) {
    angles.elevation_high = std::atan(highest / (highest < 0.0 ? farthest : nearest));
  }
  return angles;
}

}  // namespace

ZBuffer::ZBuffer(double resolution)
    : grid_(resolution),
      narrow_sine_(std::sin(std::min(kNarrow * grid_.resolution(), 0.25 * kPi))),
      pixels_(grid_.pixels(), kEmpty),
      level_rays_(static_cast<std::size_t>(grid_.columns())),
      column_farthest_(grid_.columns()),
      neighbours_farthest_(grid_.columns()) {}

void ZBuffer::begin(const Vector3& viewpoint) {
  // Here, as a copy has no room to spare.
  drawn_.reserve(pixels_.size());
  hidden_.reserve(pixels_.size());
  viewpoint_ = viewpoint;
  for (const std::uint32_t index : drawn_) pixels_[index] = kEmpty;
  drawn_.clear();
  hidden_.clear();
  draws_.clear();
  columns_known_ = false;
}

void ZBuffer::beginAs(const ZBuffer& other, std::size_t draws) {
  begin(other.viewpoint_);
  if (draws == 0) return;
  const Draw& last = other.draws_[draws - 1];
  const auto assignFirst = [](auto& to, const auto& from, std::size_t count) {
    to.assign(from.begin(), from.begin() + static_cast<std::ptrdiff_t>(count));
  };
  assignFirst(drawn_, other.drawn_, last.drawn);
  assignFirst(hidden_, other.hidden_, last.hidden);
  assignFirst(draws_, other.draws_, draws);
  for (const std::uint32_t index : drawn_) {
    const Pixel& pixel = other.pixels_[index];
    pixels_[index] = {pixel.depth, pixel.shape, false, false};
  }
  // Of what was hidden again and again the first comes last.
  for (std::size_t i = other.hidden_.size(); i-- > last.hidden;) {
    const auto& [index, before] = other.hidden_[i];
    if (!std::isinf(pixels_[index].depth)) pixels_[index] = before;
  }
}

ZBuffer::Window ZBuffer::windowOf(const Shape& shape, const Pose& T_fixed_shape) const {
  const Vector3 to_shape = T_fixed_shape.translation() - viewpoint_;
  const double range = to_shape.norm();
  const double radius = boundingRadius(shape);
  const AngularBounds angles = cornerBounds(shape, T_fixed_shape, to_shape);
  Window window{grid_.rowOf(angles.elevation_low), grid_.rowOf(angles.elevation_high) + 1, 0,
                grid_.columns()};
  if (angles.is_ahead) {
    const double azimuth = std::atan2(to_shape.y(), to_shape.x());
    const int first = grid_.columnOf(azimuth + angles.azimuth_low);
    const int last = grid_.columnOf(azimuth + angles.azimuth_high);
    const int turn = first < 0 ? grid_.columns() : first >= grid_.columns() ? -grid_.columns() : 0;
    window.column_begin = first + turn;
    window.column_end = last + turn + 1;
  }
  if (range <= radius) return window;
  const double elevation = std::asin(std::clamp(to_shape.z() / range, -1.0, 1.0));
  const double angular_radius = std::asin(radius / range);
  window.row_begin = std::max(window.row_begin, grid_.rowOf(elevation - angular_radius));
  window.row_end = std::min(window.row_end, grid_.rowOf(elevation + angular_radius) + 1);
  return window;
}

void ZBuffer::draw(const Shape& shape, const Pose& T_fixed_shape, std::uint32_t index) {
  const double nearest = distance(shape, T_fixed_shape.inverse() * viewpoint_);
  if (nearest != 0.0) drawFrom(nearest, shape, T_fixed_shape, index);
  draws_.push_back({drawn_.size(), hidden_.size()});
}

void ZBuffer::drawFrom(double nearest, const Shape& shape, const Pose& T_fixed_shape,
                       std::uint32_t index) {
  const Window window = windowOf(shape, T_fixed_shape);
  // Rounded down: what is nearer already stays.
  const auto depth_min = static_cast<float>(nearest * (1.0 - 1e-6));
  std::visit([&](const auto& solid) { drawIn(window, solid, T_fixed_shape, index, depth_min); },
             shape);
  columns_known_ = false;
}

void ZBuffer::findColumns() {
  constexpr int kMargin = kNarrow + 1;
  column_farthest_.setZero();
  lowest_row_ = grid_.rows();
  highest_row_ = -1;
  for (const std::uint32_t index : drawn_) {
    const Pixel& pixel = pixels_[index];
    if (pixel.seen) continue;
    const int row = grid_.rowOfPixel(index);
    const int column = static_cast<int>(index) - row * grid_.columns();
    // Rounded up, so that nothing is left out that stands just in front.
    const auto level = static_cast<float>(grid_.cosine(row) * (1.0 + 1e-6));
    float& farthest = column_farthest_[column];
    farthest = std::max(farthest, pixel.depth * level);
    lowest_row_ = std::min(lowest_row_, row);
    highest_row_ = std::max(highest_row_, row);
  }
  farthest_ = column_farthest_.maxCoeff();
  columns_known_ = true;
  if (farthest_ == 0.0F) return;
  for (int c = 0; c < grid_.columns(); ++c) {
    float farthest = 0.0F;
    for (int k = c - kMargin; k <= c + kMargin; ++k) {
      farthest = std::max(farthest, column_farthest_[grid_.wrapped(k)]);
    }
    neighbours_farthest_[c] = farthest;
  }
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
    const auto column = static_cast<std::size_t>(grid_.wrapped(c));
    const Eigen::Vector2d& level = grid_.columnMiddle(static_cast<int>(column));
    level_rays_[column] = {R_shape_fixed.leftCols<2>() * level, to_shape.head<2>().dot(level)};
  }
  const int middle = grid_.wrapped(grid_.columnOf(std::atan2(to_shape.y(), to_shape.x())));
  ColumnSpan span(window.column_begin, window.column_end, middle, grid_.columns());
  for (int row = window.row_begin; row < window.row_end; ++row) {
    Pixel* pixels = &pixels_[static_cast<std::size_t>(row * grid_.columns())];
    const double cosine = grid_.cosine(row);
    const double sine = grid_.sine(row);
    const Vector3 upwards = R_shape_fixed.col(2) * sine;
    const double along_level_least = along_least - to_shape.z() * sine;
    const auto isNear = [&](int column) {
      const LevelRay& ray = level_rays_[static_cast<std::size_t>(column)];
      return cosine * ray.along >= along_level_least;
    };
    span.fit(isNear);
    span.visit([&](int column) {
      Pixel& pixel = pixels[column];
      if (pixel.depth < depth_min) return;
      const LevelRay& ray = level_rays_[static_cast<std::size_t>(column)];
      const auto depth = static_cast<float>(entry(cosine * ray.direction + upwards));
      // Of two at the same depth the first of the body is shown, in whichever order they come.
      if (!(depth < pixel.depth || (depth == pixel.depth && index < pixel.shape))) return;
      const auto at = static_cast<std::uint32_t>(&pixel - pixels_.data());
      if (std::isinf(pixel.depth)) {
        drawn_.push_back(at);
      } else {
        hidden_.push_back({at, pixel});
      }
      pixel = {depth, index, false, false};
    });
  }
}

std::optional<ZBuffer::Silhouette> ZBuffer::silhouetteOf(const CuboidMap& map,
                                                         const Cuboid& cuboid) const {
  const Eigen::Vector2d centre = map.grid.centre(cuboid.cell) - viewpoint_.head<2>();
  const double half_diagonal = std::sqrt(0.5) * map.grid.config().cell_size_m;
  const double range2 = centre.squaredNorm();
  // As below, without a root for most, and with room for rounding.
  const double range_max = farthest_ + half_diagonal + 1e-6;
  if (range2 > range_max * range_max) return std::nullopt;
  const double range = std::sqrt(range2);
  Silhouette s{};
  Window& window = s.window;
  s.near = std::max(range - half_diagonal, 1e-3);
  if (s.near > farthest_) return std::nullopt;
  s.far = range + half_diagonal;
  s.bottom = map.grid.metres(cuboid.bottom) - viewpoint_.z();
  s.top = map.grid.metres(cuboid.top) - viewpoint_.z();
  window.column_end = grid_.columns();
  if (range > half_diagonal) {
    const int middle = grid_.columnOfDirection(centre);
    const bool is_narrow = half_diagonal < range * narrow_sine_;
    if (is_narrow && neighbours_farthest_[middle] <= s.near) {
      return std::nullopt;
    }
    // The tangents from the viewpoint to the circle around the cell.
    const double length = std::sqrt(range * range - half_diagonal * half_diagonal);
    const Eigen::Vector2d across = half_diagonal * Eigen::Vector2d(-centre.y(), centre.x());
    const Eigen::Vector2d right = length * centre - across, left = length * centre + across;
    window.column_begin =
        is_narrow ? grid_.columnFrom(middle, right) : grid_.columnOfDirection(right);
    window.column_end =
        (is_narrow ? grid_.columnFrom(middle, left) : grid_.columnOfDirection(left)) + 1;
    if (window.column_end <= window.column_begin) window.column_end += grid_.columns();
    if (!reachesBehind(s)) return std::nullopt;
  }
  window.row_begin =
      std::max(grid_.rowOfSlope(s.bottom < 0.0 ? s.near : s.far, s.bottom), lowest_row_);
  window.row_end =
      std::min(grid_.rowOfSlope(s.top < 0.0 ? s.far : s.near, s.top), highest_row_) + 1;
  if (window.row_begin >= window.row_end) return std::nullopt;
  return s;
}

bool ZBuffer::reachesBehind(const Silhouette& s) const {
  for (int c = s.window.column_begin; c < s.window.column_end; ++c) {
    if (column_farthest_[grid_.wrapped(c)] > s.near) return true;
  }
  return false;
}

double ZBuffer::depthOf(const Silhouette& s, int row) const {
  const double tangent = grid_.tangent(row);
  double range = s.near;
  if (tangent < 0.0 && range * tangent > s.top) range = s.top / tangent;
  if (tangent > 0.0 && range * tangent < s.bottom) range = s.bottom / tangent;
  return std::clamp(range, s.near, s.far) / grid_.cosine(row);
}

/// Around what can be covered, as seen from above, and the viewpoint. A cell of which a corner may
/// stand in front of it touches that.
UprightBox ZBuffer::reach(double cell_size) const {
  UprightBox reach(viewpoint_);
  for (int c = 0; c < grid_.columns(); ++c) {
    Vector3 farthest = viewpoint_;
    farthest.head<2>() += double{column_farthest_[c]} * grid_.columnMiddle(c);
    reach.extend(farthest);
  }
  const double half_column = 0.5 * grid_.resolution() * farthest_;
  const Vector3 wider = Vector3::Constant(half_column + 2.0 * cell_size + 1e-6);
  return {reach.min() - wider, reach.max() + wider};
}

void ZBuffer::coverBy(const CuboidMap& map, double margin, std::vector<std::uint32_t>& covering) {
  if (!canBeCovered()) return;
  const Grid::Footprint footprint = map.grid.footprint(reach(map.grid.config().cell_size_m));
  if (footprint.x_begin >= footprint.x_end) return;
  for (CellIndex y = footprint.y_begin; y < footprint.y_end; ++y) {
    const std::uint32_t* cell_begin = &map.cell_begin[std::size_t{y} * map.grid.cellsX()];
    const std::uint32_t end = cell_begin[footprint.x_end];
    for (std::uint32_t k = cell_begin[footprint.x_begin]; k < end; ++k) {
      if (cover(map, map.cuboids[k], margin)) covering.push_back(k);
    }
  }
}

bool ZBuffer::cover(const CuboidMap& map, const Cuboid& cuboid, double margin) {
  if (!canBeCovered()) return false;
  const auto s = silhouetteOf(map, cuboid);
  if (!s) return false;
  bool any = false;
  const int columns = grid_.columns();
  for (int row = s->window.row_begin; row < s->window.row_end; ++row) {
    const auto limit = static_cast<float>(depthOf(*s, row) + margin);
    Pixel* pixels = &pixels_[static_cast<std::size_t>(row * grid_.columns())];
    for (int c = s->window.column_begin; c < s->window.column_end; ++c) {
      Pixel& pixel = pixels[c < columns ? c : c - columns];
      if (std::isinf(pixel.depth) || pixel.depth <= limit || pixel.seen) continue;
      pixel.covered = true;
      any = true;
    }
  }
  return any;
}

}  // namespace tccm
