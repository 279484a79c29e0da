#include "tccm_monitor/map/look_image.h"

#include <algorithm>

#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

constexpr double kNearest = 1e-3;  // [m]; what is this near has no direction

double validated(double resolution_rad) {
  requireInRange("look_resolution_rad", resolution_rad, 0.01, 0.2);
  return resolution_rad;
}

}  // namespace

LookImage::LookImage(double resolution_rad)
    : grid_(validated(resolution_rad)), passes_(grid_.pixels()), row_begin_(grid_.rows()) {}

LookImage::Sight LookImage::at(const Vector3& p_fixed, double margin_m) const {
  const Vector3 sight = p_fixed - viewpoint_;
  const double range = sight.norm();
  if (!(range > kNearest)) return {Sight::Kind::kNeverLooked, epoch_, epoch_};
  return at(grid_.pixelOf(sight), range, margin_m);
}

LookImage::Sight LookImage::at(std::size_t pixel, double range_m, double margin_m) const {
  Sight sight{Sight::Kind::kNeverLooked, epoch_, epoch_};
  const Passes& passes = passes_[pixel];
  if (passes.front().end == End::kNever) return sight;
  sight.looked = timeOf(passes.front().last);
  for (const Pass& pass : passes) {
    if (pass.end == End::kNever) break;
    const bool reaches = pass.range() >= range_m - margin_m;
    if (reaches || pass.end != End::kRobot) {
      sight.kind = reaches ? Sight::Kind::kSeen : Sight::Kind::kBehind;
      sight.stamp = timeOf(pass.last);
      return sight;
    }
    if (sight.kind == Sight::Kind::kBehindRobot) continue;
    sight.kind = Sight::Kind::kBehindRobot;
    sight.stamp = timeOf(pass.last);
  }
  return sight;
}

void LookImage::clear() {
  std::fill(passes_.begin(), passes_.end(), Passes());
  row_begin_ = grid_.rows();
  row_end_ = 0;
}

void LookImage::begin(Time epoch, const Vector3& viewpoint) {
  clear();
  epoch_ = epoch;
  viewpoint_ = viewpoint;
}

void LookImage::copyFrom(const LookImage& other) {
  if (grid_.rows() != other.grid_.rows()) {
    *this = other;
    return;
  }
  // With the rows that only this one has, to forget what was in them.
  const int from = std::min(row_begin_, other.row_begin_);
  const int to = std::max(row_end_, other.row_end_);
  if (from < to) {
    const auto begin = static_cast<std::ptrdiff_t>(grid_.index(from, 0));
    const auto end = static_cast<std::ptrdiff_t>(grid_.index(to, 0));
    std::copy(other.passes_.begin() + begin, other.passes_.begin() + end, passes_.begin() + begin);
  }
  epoch_ = other.epoch_;
  viewpoint_ = other.viewpoint_;
  row_begin_ = other.row_begin_;
  row_end_ = other.row_end_;
}

}  // namespace tccm
