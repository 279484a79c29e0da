#include "scan/cloud_filters.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace tccm {
namespace {

constexpr float kNoises = 6.0F;  // two ranges of one surface hardly ever differ by more

/// Where the neighbours of a point lie, along its beam: before it, near it or behind it.
struct Sides {
  static constexpr int kBefore = -1, kNear = 0, kBehind = 1, kNone = 2;
  int left, right, above, below;

  /// Both along a row or a column, one before and one behind.
  [[nodiscard]] bool areAround() const { return left * right == -1 || above * below == -1; }
  [[nodiscard]] int near() const {
    return (left == kNear) + (right == kNear) + (above == kNear) + (below == kNear);
  }
};

class Neighbourhood {
 public:
  static constexpr std::size_t kRun = 64;

  Neighbourhood(const FlyingPixelFilter& filter, const Cloud& cloud, const RangeNoise& noise,
                const std::vector<float>& ranges)
      : cloud_(cloud),
        noise_(noise),
        ranges_(ranges),
        separation_(static_cast<float>(filter.separation_m)),
        slope_squared_(static_cast<float>(filter.slope_max * filter.slope_max)) {}

  [[nodiscard]] bool isFlying(std::size_t row, std::size_t column) const {
    const Sides sides = sidesOf(row, column);
    if (sides.areAround()) return true;
    const int near = sides.near();
    if (near != 1) return near == 0;
    if (sides.left == Sides::kNear) return !carries(row, column - 1);
    if (sides.right == Sides::kNear) return !carries(row, column + 1);
    if (sides.above == Sides::kNear) return !carries(row - 1, column);
    return !carries(row + 1, column);
  }

  /// Of a run of points that have neighbours on all sides: whether all four were measured and lie
  /// near, as most do. @param first index of the first. @param are_near one for each of kRun.
  void tellNear(std::size_t first, bool* are_near) const {
    float furthest[kRun], nearest[kRun];
    const float* own = ranges_.data() + first;
    const float *above = own - cloud_.width, *below = own + cloud_.width;
    for (std::size_t i = 0; i < kRun; ++i) {
      const float range = own[i], left = own[i - 1], right = own[i + 1];
      const float aside = std::max(std::abs(left - range), std::abs(right - range));
      const float along = std::max(std::abs(above[i] - range), std::abs(below[i] - range));
      furthest[i] = std::max(aside, along);
      nearest[i] = std::min(std::min(left, right), std::min(above[i], below[i]));
    }
    for (std::size_t i = 0; i < kRun; ++i) {
      are_near[i] = nearest[i] > 0.0F && furthest[i] <= separation_ + kNoises * noise_.at(own[i]);
    }
  }

 private:
  /// Whether the only point near another one keeps that from being a flying pixel: not where it is
  /// one itself, nor where it has no other near it.
  [[nodiscard]] bool carries(std::size_t row, std::size_t column) const {
    const Sides sides = sidesOf(row, column);
    return !sides.areAround() && sides.near() > 1;
  }
  [[nodiscard]] Sides sidesOf(std::size_t row, std::size_t column) const {
    const std::size_t i = row * cloud_.width + column;
    const float near = separation_ + kNoises * noise_.at(ranges_[i]);
    const auto side = [&](bool exists, std::size_t neighbour) {
      return exists ? sideOf(i, neighbour, near) : Sides::kNone;
    };
    return {side(column > 0, i - 1), side(column + 1 < cloud_.width, i + 1),
            side(row > 0, i - cloud_.width), side(row + 1 < cloud_.height, i + cloud_.width)};
  }
  [[nodiscard]] int sideOf(std::size_t i, std::size_t neighbour, float near) const {
    if (ranges_[neighbour] == 0.0F) return Sides::kNone;
    const float further = ranges_[neighbour] - ranges_[i];
    if (std::abs(further) <= near) return Sides::kNear;
    const float depth_squared = further * further;
    const float across_squared =
        (cloud_.points[neighbour] - cloud_.points[i]).squaredNorm() - depth_squared;
    if (depth_squared <= slope_squared_ * across_squared) return Sides::kNear;
    return further < 0.0F ? Sides::kBefore : Sides::kBehind;
  }

  const Cloud& cloud_;
  RangeNoise::Floats noise_;
  const std::vector<float>& ranges_;
  float separation_;
  float slope_squared_;
};

}  // namespace

void FlyingPixelFilter::describe(ParameterTable& table) {
  table.add("flying_pixel_separation_m", &separation_m, "m", {0.0, 10.0},
            "a point of an organised cloud further than this and six times the noise from its "
            "neighbours on both sides is a flying pixel; 0: no filter");
  table.add("flying_pixel_slope_max", &slope_max, "", {0.0, 1000.0},
            "unless it lies with them on a surface that recedes by less than so many metres a "
            "metre across");
}

void FlyingPixelFilter::apply(const Cloud& cloud, const RangeNoise& noise,
                              CloudState& state) const {
  for (std::size_t row = 0; row < cloud.height; ++row) applyToRow(cloud, noise, row, state);
}

void FlyingPixelFilter::applyToRow(const Cloud& cloud, const RangeNoise& noise, std::size_t row,
                                   CloudState& state) const {
  constexpr std::size_t kRun = Neighbourhood::kRun;
  if (separation_m == 0.0 || !cloud.organised()) return;
  // A row without returns, as a thinned one, has nothing to judge.
  const auto kinds = state.kinds.begin() + static_cast<std::ptrdiff_t>(row * cloud.width);
  const auto kinds_end = kinds + static_cast<std::ptrdiff_t>(cloud.width);
  if (std::find(kinds, kinds_end, BeamKind::kReturn) == kinds_end) return;
  const Neighbourhood neighbours(*this, cloud, noise, state.ranges);
  const auto ask = [&](std::size_t column) {
    BeamKind& kind = state.kinds[row * cloud.width + column];
    if (kind == BeamKind::kReturn && neighbours.isFlying(row, column)) kind = BeamKind::kMixedPixel;
  };
  if (row == 0 || row + 1 == cloud.height || cloud.width < kRun + 2) {
    for (std::size_t column = 0; column < cloud.width; ++column) ask(column);
    return;
  }
  ask(0);
  std::size_t column = 1;
  for (; column + kRun < cloud.width; column += kRun) {
    bool are_near[kRun];
    neighbours.tellNear(row * cloud.width + column, are_near);
    if (std::memchr(are_near, 0, kRun) == nullptr) continue;
    for (std::size_t i = 0; i < kRun; ++i) {
      if (!are_near[i]) ask(column + i);
    }
  }
  for (; column < cloud.width; ++column) ask(column);
}

void Thinning::describe(ParameterTable& table) {
  table.add(
      "thinned_spacing_m", &spacing_m, "m", {0.0, 1.0},
      "every other row and column of an organised cloud is left out of the map where those "
      "that remain lie nearer together than this across the beams; a look still tells of all; "
      "0: none is");
}

void Thinning::applyToRow(const Cloud& cloud, float step_rad, std::size_t row,
                          CloudState& state) const {
  if (!(step_rad > 0.0F) || !cloud.organised()) return;
  const float furthest = static_cast<float>(0.5 * spacing_m) / step_rad;
  // The last row and column are taken: a look's block may have no other.
  const bool is_taken = row % 2 == 0 || row + 1 == cloud.height;
  const std::size_t first = row * cloud.width, step = is_taken ? 2 : 1;
  for (std::size_t i = first + step - 1; i + step <= first + cloud.width; i += step) {
    BeamKind& kind = state.kinds[i];
    const bool is_dense = kind == BeamKind::kReturn && state.ranges[i] <= furthest;
    kind = is_dense ? BeamKind::kThinned : kind;
  }
}

void SupportFilter::Config::describe(ParameterTable& table) {
  table.add("support_voxel_m", &voxel_m, "m", {0.01, 10.0},
            "points of a cloud that is not organised are counted in voxels of this edge");
  table.add("support_points_min", &points_min, "points", {0.0, 100.0},
            "where fewer lie in a point's voxel and the 26 around it, itself included, it is "
            "dropped; 0: no filter");
}

std::uint64_t SupportFilter::keyOf(const Eigen::Vector3f& point) const {
  constexpr float kMost = 1e6F;  // voxels, in 21 bits with a border to step over
  constexpr int kMiddle = 1 << 20;
  const float per_metre = 1.0F / static_cast<float>(config_.voxel_m);
  std::uint64_t key = 0;
  for (int k = 0; k < 3; ++k) {
    const float at = std::clamp(point[k] * per_metre, -kMost, kMost);
    const int truncated = static_cast<int>(at);  // std::floor is a call, and takes longer than all
    const int voxel = truncated - (static_cast<float>(truncated) > at ? 1 : 0);
    key = key << 21 | static_cast<std::uint64_t>(voxel + kMiddle);
  }
  return key;
}

SupportFilter::Voxel& SupportFilter::find(std::uint64_t key) {
  std::size_t slot = (key * 0x9E3779B97F4A7C15ULL) >> 32 & mask_;
  while (voxels_[slot].key != 0 && voxels_[slot].key != key) slot = (slot + 1) & mask_;
  return voxels_[slot];
}

bool SupportFilter::isSupported(std::uint64_t key) {
  std::size_t points = find(key).points;
  if (points >= config_.points_min) return true;
  for (const std::uint64_t x : {0ULL, 1ULL << 42, -1ULL << 42}) {
    for (const std::uint64_t y : {0ULL, 1ULL << 21, -1ULL << 21}) {
      for (const std::uint64_t z : {0ULL, 1ULL, -1ULL}) {
        if (x == 0 && y == 0 && z == 0) continue;
        points += find(key + x + y + z).points;
        if (points >= config_.points_min) return true;
      }
    }
  }
  return false;
}

SupportFilter::Voxel& SupportFilter::insert(std::uint64_t key) {
  Voxel* voxel = &find(key);
  if (voxel->key != 0) return *voxel;
  if (2 * (occupied_ + 1) > voxels_.size()) {
    grow();
    voxel = &find(key);
  }
  ++occupied_;
  voxel->key = key;
  return *voxel;
}

/// As large as any cloud needed so far: a cloud like those before allocates nothing.
void SupportFilter::grow() {
  constexpr std::size_t kFirst = 4096;
  const std::vector<Voxel> old = std::move(voxels_);
  voxels_.assign(std::max(kFirst, 2 * old.size()), Voxel());
  mask_ = voxels_.size() - 1;
  for (const Voxel& voxel : old) {
    if (voxel.key != 0) find(voxel.key) = voxel;
  }
}

void SupportFilter::apply(const Cloud& cloud, CloudState& state) {
  if (config_.points_min == 0 || cloud.organised()) return;
  if (voxels_.empty()) grow();
  std::fill(voxels_.begin(), voxels_.end(), Voxel());
  occupied_ = 0;
  // Points that follow one another often share a voxel.
  std::uint64_t last = 0;
  Voxel* voxel = nullptr;
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    if (state.kinds[i] != BeamKind::kReturn) continue;
    const std::uint64_t key = keyOf(cloud.points[i]);
    if (key != last) voxel = &insert(key);
    last = key;
    ++voxel->points;
  }
  last = 0;
  bool is_supported = false;
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    if (state.kinds[i] != BeamKind::kReturn) continue;
    const std::uint64_t key = keyOf(cloud.points[i]);
    if (key != last) is_supported = isSupported(key);
    last = key;
    if (!is_supported) state.kinds[i] = BeamKind::kMixedPixel;
  }
}

}  // namespace tccm
