#include "tccm_monitor/map/newest_looks.h"

#include <algorithm>
#include <cmath>

namespace tccm {
namespace {

constexpr double kNearest = 1e-3;  // [m]; what is this near has no direction
constexpr double kSwing = 0.02;    // [m] that a sensor's origin moves at most within a scan

bool isAfter(std::uint32_t serial, std::uint32_t other) {
  return static_cast<std::int32_t>(serial - other) > 0;  // they may wrap
}

}  // namespace

NewestLooks::NewestLooks(double angle_rad)
    : grid_(angle_rad), angle_(angle_rad), cosine_(std::cos(angle_rad)), lines_(grid_.pixels()) {
  for (int row = 0; row < grid_.rows(); ++row) {
    columns_within_.push_back(grid_.columnsWithin(row, angle_rad));
  }
}

void NewestLooks::clear() {
  std::fill(lines_.begin(), lines_.end(), Line());
  band_ = 1.0;
}

void NewestLooks::enclose(const std::vector<Look>& looks) {
  const auto direction = [&looks](std::size_t i) {
    return Vector3((looks[i].end - looks[i].viewpoint).normalized());
  };
  band_ = 1.0;
  normal_.setZero();
  if (looks.empty()) return;
  normal_ = direction(looks.size() / 4).cross(direction(3 * looks.size() / 4));
  if (!(normal_.norm() > 0.1)) return;
  normal_.normalize();
  band_ = 0.0;
  for (std::size_t i = 0; i < looks.size(); ++i) {
    const double along = std::abs(direction(i).dot(normal_));
    if (along > band_) band_ = along;
  }
}

void NewestLooks::add(std::uint32_t serial, const std::vector<Look>& looks) {
  serial_ = serial;
  enclose(looks);
  for (const Look& look : looks) {
    if (look.what == Look::End::kRobot || look.what == Look::End::kUnclear) continue;
    const Vector3 sight = look.end - look.viewpoint;
    const double range = sight.norm();
    if (!(range > kNearest)) continue;  // NaN, too
    Line& line = lines_[grid_.pixelOf(sight)];
    // Of one scan the look that saw the farthest.
    if (line.serial == serial && line.range >= static_cast<float>(range)) continue;
    line = {look.viewpoint.cast<float>(), (sight / range).cast<float>(), static_cast<float>(range),
            serial};
  }
}

bool NewestLooks::sawSince(std::uint32_t serial, const Vector3& p_fixed, const Vector3& viewpoint,
                           double short_m) const {
  const Vector3 sight = p_fixed - viewpoint;
  if (!(sight.squaredNorm() > kNearest * kNearest)) return false;
  const std::size_t pixel = grid_.pixelOf(sight);
  const int middle_row = grid_.rowOfPixel(pixel);
  const int middle = static_cast<int>(pixel) - middle_row * grid_.columns();
  const int last = std::min(grid_.rows() - 1, middle_row + 1);
  for (int row = std::max(0, middle_row - 1); row <= last; ++row) {
    const int reach = columns_within_[static_cast<std::size_t>(row)];
    for (int c = middle - reach; c <= middle + reach; ++c) {
      const Line& line = lines_[grid_.index(row, grid_.wrapped(c))];
      if (line.range < 0.0F || !isAfter(line.serial, serial)) continue;
      const Eigen::Vector3f to_place = p_fixed.cast<float>() - line.viewpoint;
      const double along = static_cast<double>(to_place.dot(line.direction));
      const double distance = static_cast<double>(to_place.norm());
      if (along >= cosine_ * distance && static_cast<double>(line.range) >= distance - short_m) {
        return true;
      }
    }
  }
  return false;
}

bool NewestLooks::sawLast(const Vector3& p_fixed, const Vector3& viewpoint, double short_m) const {
  const Vector3 sight = p_fixed - viewpoint;
  const double range = sight.norm();
  if (!(range > kNearest)) return false;
  // Twice the swing, as angles: of the place's direction and of the looks'.
  const double reach = band_ + angle_ + 2.0 * kSwing / range;
  if (std::abs(sight.dot(normal_)) > reach * range) return false;
  return sawSince(serial_ - 1, p_fixed, viewpoint, short_m);
}

}  // namespace tccm
