#include "check/z_buffer.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "check/column_span.h"
#include "check/ray_entry.h"

namespace tccm {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr float kFar = std::numeric_limits<float>::infinity();
constexpr int kNarrow = 2;  // columns on either side of its middle that most cuboids reach at most

/// What a solid, seen from the viewpoint, cannot reach beyond: from the corners of the box around
/// it.
struct CornerBounds {
  CornerBounds(const Shape& shape, const Pose& T_fixed_shape, const Vector3& to_shape) {
    const double range = to_shape.head<2>().norm();
    ahead = to_shape.head<2>() / (range > 0.0 ? range : 1.0);
    const Vector3 half_extents = bounds(shape, Pose::Identity()).max();
    const Eigen::Matrix3d edges = T_fixed_shape.linear() * half_extents.asDiagonal();
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
  }
  /// All corners are ahead of the plane through the viewpoint that stands upright across the way
  /// to the centre; only then are azimuths bounded.
  [[nodiscard]] bool isAhead() const { return nearest >= 1e-3; }
  /// @param tangent of the azimuth, relative to that of the centre.
  [[nodiscard]] Eigen::Vector2d direction(double tangent) const {
    return ahead + tangent * Eigen::Vector2d(-ahead.y(), ahead.x());
  }

  Eigen::Vector2d ahead;  ///< towards the centre
  double nearest = kInfinity, farthest = 0.0, lowest = kInfinity, highest = -kInfinity;
  double right = kInfinity, left = -kInfinity;  ///< tangents of azimuths
};

}  // namespace

ZBuffer::ZBuffer(double resolution)
    : grid_(resolution),
      narrow_sine_(std::sin(std::min(kNarrow * grid_.resolution(), 0.25 * kPi))),
      depths_(grid_.pixels(), kFar),
      shown_(grid_.pixels()),
      row_drawn_(static_cast<std::size_t>(grid_.rows()), 0),
      row_farthest_(static_cast<std::size_t>(grid_.rows()), kFar),
      columns_(grid_.columns(), 2),
      level_rays_(grid_.columns(), 4),
      found_(grid_.columns()),
      column_farthest_(grid_.columns()),
      neighbours_farthest_(grid_.columns()) {
  for (int c = 0; c < grid_.columns(); ++c) columns_.row(c) = grid_.columnMiddle(c).transpose();
}

void ZBuffer::begin(const Vector3& viewpoint) {
  // Here, as a copy has no room to spare.
  runs_.reserve(depths_.size());
  hidden_.reserve(depths_.size());
  covered_.reserve(depths_.size());
  takeBack({});
  viewpoint_ = viewpoint;
}

void ZBuffer::takeBack(const Mark& mark) {
  for (const std::uint32_t index : covered_) shown_[index].covered = false;
  covered_.clear();
  for (std::size_t i = hidden_.size(); i-- > mark.hidden;) {
    const auto& [index, before] = hidden_[i];
    depths_[index] = before.depth;
    shown_[index] = before;
  }
  hidden_.resize(mark.hidden);
  for (std::size_t i = mark.runs; i < runs_.size(); ++i) {
    const Run& run = runs_[i];
    std::fill(&depths_[run.begin], &depths_[run.begin] + (run.end - run.begin), kFar);
    const auto row = static_cast<std::size_t>(run.row);
    row_drawn_[row] -= static_cast<int>(run.end - run.begin);
    row_farthest_[row] = kFar;
  }
  runs_.resize(mark.runs);
  columns_known_ = false;
}

ZBuffer::Window ZBuffer::windowOf(const Shape& shape, const Pose& T_fixed_shape) const {
  const Vector3 to_shape = T_fixed_shape.translation() - viewpoint_;
  const CornerBounds corners(shape, T_fixed_shape, to_shape);
  Window window{0, grid_.rows(), 0, grid_.columns()};
  const auto rise = [&](double level, double height) {
    window.row_begin = std::max(window.row_begin, grid_.rowOfSlope(level, height));
  };
  const auto sink = [&](double level, double height) {
    window.row_end = std::min(window.row_end, grid_.rowOfSlope(level, height) + 1);
  };
  const auto& [lowest, highest] = std::tie(corners.lowest, corners.highest);
  if (corners.isAhead()) {
    window.column_begin = grid_.columnOfDirection(corners.direction(corners.right));
    window.column_end = grid_.columnOfDirection(corners.direction(corners.left)) + 1;
    if (window.column_end <= window.column_begin) window.column_end += grid_.columns();
  }
  if (corners.isAhead() || lowest > 0.0)
    rise(lowest < 0.0 ? corners.nearest : corners.farthest, lowest);
  if (corners.isAhead() || highest < 0.0)
    sink(highest < 0.0 ? corners.farthest : corners.nearest, highest);
  // And by the sphere around it, above and below the direction of its centre.
  const double range = to_shape.norm();
  const double radius = boundingRadius(shape);
  if (range <= radius) return window;
  const double sine = radius / range;
  const double cosine = std::sqrt(1.0 - sine * sine);
  const double level = to_shape.head<2>().norm();
  const double lower = level * cosine + to_shape.z() * sine;
  const double upper = level * cosine - to_shape.z() * sine;
  if (lower > 0.0) rise(lower, to_shape.z() * cosine - level * sine);
  if (upper > 0.0) sink(upper, to_shape.z() * cosine + level * sine);
  return window;
}

void ZBuffer::draw(const Shape& shape, const Pose& T_fixed_shape, std::uint32_t index) {
  const double nearest = distance(shape, T_fixed_shape.inverse() * viewpoint_);
  if (nearest != 0.0) drawFrom(nearest, shape, T_fixed_shape, index);
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
  for (const Run& run : runs_) {
    // Rounded up, so that nothing is left out that stands just in front.
    const auto level = static_cast<float>(grid_.cosine(run.row) * (1.0 + 1e-6));
    const auto row_begin = static_cast<std::uint32_t>(grid_.index(run.row, 0));
    for (std::uint32_t index = run.begin; index < run.end; ++index) {
      if (shown_[index].sight == Sight::kVisible) continue;
      float& farthest = column_farthest_[index - row_begin];
      farthest = std::max(farthest, depths_[index] * level);
      lowest_row_ = std::min(lowest_row_, run.row);
      highest_row_ = std::max(highest_row_, run.row);
    }
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

void ZBuffer::findLevelRays(const Window& window, const Eigen::Matrix3d& R_shape_fixed,
                            const Vector3& to_shape) {
  const auto find = [&](int begin, int end) {
    const auto x = columns_.col(0).segment(begin, end - begin);
    const auto y = columns_.col(1).segment(begin, end - begin);
    for (int i = 0; i < 3; ++i) {
      level_rays_.col(i).segment(begin, end - begin) =
          R_shape_fixed(i, 0) * x + R_shape_fixed(i, 1) * y;
    }
    level_rays_.col(3).segment(begin, end - begin) = to_shape.x() * x + to_shape.y() * y;
  };
  find(window.column_begin, std::min(window.column_end, grid_.columns()));
  if (window.column_end > grid_.columns()) find(0, window.column_end - grid_.columns());
}

template <typename Solid>
void ZBuffer::drawIn(const Window& window, const Solid& solid, const Pose& T_fixed_shape,
                     std::uint32_t index, float depth_min) {
  const Eigen::Matrix3d R_shape_fixed = T_fixed_shape.linear().transpose();
  const Vector3 to_shape = T_fixed_shape.translation() - viewpoint_;
  RowEntry<Solid> entry(solid, R_shape_fixed * -to_shape);
  const double range = to_shape.norm();
  const double reach = std::min(1.0, boundingRadius(solid) / range);
  // Rays further from the centre's direction than this miss the sphere around the shape.
  const double along_least = reach < 1.0 ? range * std::sqrt(1.0 - reach * reach) - 1e-9 : -range;
  // A ray's direction is its column's, level with the viewpoint, times the cosine of its row's
  // elevation, and upwards by the sine.
  findLevelRays(window, R_shape_fixed, to_shape);
  const double* along = level_rays_.col(3).data();
  const bool is_upright = to_shape.head<2>().isZero(0.0);  // it stands above or below
  const int middle = is_upright ? 0 : grid_.columnOfDirection(to_shape.head<2>());
  ColumnSpan span(window.column_begin, window.column_end, middle, grid_.columns());
  for (int row = window.row_begin; row < window.row_end; ++row) {
    if (row_farthest_[static_cast<std::size_t>(row)] < depth_min) continue;
    const double cosine = grid_.cosine(row);
    const double sine = grid_.sine(row);
    const RowOfRays rays{
        {level_rays_.col(0).data(), level_rays_.col(1).data(), level_rays_.col(2).data()},
        cosine,
        R_shape_fixed.col(2) * sine};
    const double along_level_least = along_least - to_shape.z() * sine;
    span.fit([&](int column) { return cosine * along[column] >= along_level_least; });
    const float* depths = &depths_[grid_.index(row, 0)];
    span.visit([&](int begin, int end) {
      while (begin < end && depths[begin] < depth_min) ++begin;
      while (begin < end && depths[end - 1] < depth_min) --end;
      entry.find(rays, begin, end, depths, depth_min, found_.data());
      show(row, begin, end, found_.data(), index);
    });
    noteIfFull(row);
  }
}

void ZBuffer::show(int row, int begin, int end, const float* depths, std::uint32_t index) {
  const std::size_t first = grid_.index(row, 0);
  float* row_depths = &depths_[first];
  Shown* row_shown = &shown_[first];
  int run_begin = begin, run_end = begin;
  const auto addRun = [&] {
    if (run_begin == run_end) return;
    runs_.push_back({row, static_cast<std::uint32_t>(first) + static_cast<std::uint32_t>(run_begin),
                     static_cast<std::uint32_t>(first) + static_cast<std::uint32_t>(run_end)});
    row_drawn_[static_cast<std::size_t>(row)] += run_end - run_begin;
  };
  const Shown fresh{index, Sight::kNotAsked, false};
  for (int c = begin; c < end; ++c) {
    const float depth = depths[c], before = row_depths[c];
    if (before < kFar) {
      // Of two at the same depth the first of the body is shown, in whichever order they come.
      Shown& shown = row_shown[c];
      if (!(depth < before || (depth == before && index < shown.shape))) continue;
      const auto pixel = static_cast<std::uint32_t>(first) + static_cast<std::uint32_t>(c);
      hidden_.push_back({pixel, {shown, before}});
    } else {
      if (!(depth < kFar)) continue;
      if (c != run_end) {
        addRun();
        run_begin = c;
      }
      run_end = c + 1;
    }
    row_depths[c] = depth;
    row_shown[c] = fresh;
  }
  addRun();
}

void ZBuffer::noteIfFull(int row) {
  float& farthest = row_farthest_[static_cast<std::size_t>(row)];
  // Once: what is drawn over it and taken back again brings nothing further away than it had.
  if (farthest < kFar || row_drawn_[static_cast<std::size_t>(row)] < grid_.columns()) return;
  const float* depths = &depths_[grid_.index(row, 0)];
  farthest = *std::max_element(depths, depths + grid_.columns());
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
    const auto first = static_cast<std::uint32_t>(grid_.index(row, 0));
    for (int c = s->window.column_begin; c < s->window.column_end; ++c) {
      const std::uint32_t index = first + static_cast<std::uint32_t>(c < columns ? c : c - columns);
      const float depth = depths_[index];
      Shown& shown = shown_[index];
      if (std::isinf(depth) || depth <= limit || shown.sight == Sight::kVisible) continue;
      if (!shown.covered) covered_.push_back(index);
      shown.covered = true;
      any = true;
    }
  }
  return any;
}

}  // namespace tccm
