#include "sight/newest_looks.h"

#include <algorithm>
#include <cmath>

namespace tccm {
namespace {

constexpr std::uint32_t kNeighbours = 3;  // scans before one that pass beside it
constexpr double kRounding = 1e-3;        // [rad] and [m], of single precision; plenty
constexpr double kSwing = 0.02;           // [m] that a sensor's origin moves at most within a scan

bool isAfter(std::uint32_t serial, std::uint32_t other) {
  return static_cast<std::int32_t>(serial - other) > 0;  // they may wrap
}

}  // namespace

NewestLooks::NewestLooks(double angle_rad, double outline_rad)
    : grid_(angle_rad),
      angle_(angle_rad),
      cosine_(std::cos(angle_rad)),
      looked_(grid_.pixels()),
      looking_(grid_.around(angle_rad)),
      beside_(grid_.around(outline_rad)),
      lines_(grid_.pixels()),
      serials_(grid_.pixels(), 0),
      outlines_(grid_.pixels()) {
  looking_.rows = 1;
}

void NewestLooks::clear() {
  std::fill(lines_.begin(), lines_.end(), Line());
  std::fill(serials_.begin(), serials_.end(), 0U);
  std::fill(outlines_.begin(), outlines_.end(), Outline());
  looked_.clear();
  beginBand({});
}

void NewestLooks::add(std::uint32_t serial, const std::vector<Look>& looks,
                      std::uint32_t outline_scans) {
  looked_.clear();
  beginBand(looks);
  addOutlines(serial, looks);
  addLines(serial, looks, outline_scans);
  finishBand();
}

void NewestLooks::beginBand(const std::vector<Look>& looks) {
  const auto direction = [&looks](std::size_t i) {
    return Vector3((looks[i].end - looks[i].viewpoint).normalized());
  };
  band_ = 1.0;
  swing_ = 0.0;
  normal_.setZero();
  has_band_ = false;
  if (looks.empty()) return;
  viewpoint_ = looks[looks.size() / 2].viewpoint;
  normal_ = direction(looks.size() / 4).cross(direction(3 * looks.size() / 4));
  has_band_ = normal_.norm() > 0.1;
  if (!has_band_) return;
  normal_.normalize();
  band_ = 0.0;
}

void NewestLooks::widenBand(const Vector3& viewpoint, const Vector3& direction) {
  if (!has_band_) return;
  band_ = std::max(band_, std::abs(direction.dot(normal_)));  // which passes over NaN
  swing_ = std::max(swing_, (viewpoint - viewpoint_).squaredNorm());
}

/// A look's end is seen by it where its angle from the plane and the look's add up; from the one
/// viewpoint it is off by the look's own.
void NewestLooks::finishBand() {
  last_ = Last();
  if (!has_band_) return;
  const double angles = band_ + angle_ + kRounding;
  const double swing = (1.0 + angles) * std::sqrt(swing_) + kRounding;
  last_ = {viewpoint_.cast<float>(), normal_.cast<float>(), static_cast<float>(swing),
           static_cast<float>(angles)};
}

void NewestLooks::maySeeLast(const float* x, const float* y, const float* z, std::size_t count,
                             std::uint32_t* may) const {
  const Last last = last_;
  for (std::size_t i = 0; i < count; ++i) may[i] = last.mayHave(x[i], y[i], z[i]) ? 1 : 0;
}

/// Neighbouring beams are nearer to each other than pixels: those that follow one another in a
/// pixel are added as one.
void NewestLooks::addOutlines(std::uint32_t serial, const std::vector<Look>& looks) {
  PixelFollower follower(grid_);
  std::size_t pixel = grid_.pixels();
  RobotPixel before, at, next;
  for (const Look& look : looks) {
    if (look.what != Seen::kRobot) continue;
    const Vector3 sight = look.end - look.viewpoint;
    const double distance = sight.norm();
    if (!(distance > kNearestLook)) continue;  // NaN, too
    widenBand(look.viewpoint, sight / distance);
    follower.follow(sight);
    if (follower.pixel() != pixel) {
      pixel = follower.pixel();
      addOutline(before, at, next, serial);
      before = at;
      at = next;
      next.row = grid_.rowOfPixel(pixel);
      next.column = grid_.columnOfPixel(pixel, next.row);
      next.distance = kNone;
    }
    next.distance = std::min(next.distance, static_cast<float>(distance));
  }
  addOutline(before, at, next, serial);
  addOutline(at, next, RobotPixel(), serial);
}

void NewestLooks::addOutline(const RobotPixel& before, const RobotPixel& at,
                             const RobotPixel& after, std::uint32_t serial) {
  if (at.distance == kNone) return;
  const bool leaves_before = before.distance <= at.distance;
  const bool leaves_after = after.distance < at.distance;
  const int last = std::min(grid_.rows() - 1, at.row + beside_.rows);
  for (int row = std::max(0, at.row - beside_.rows); row <= last; ++row) {
    const int reach = beside_.columns[static_cast<std::size_t>(row)];
    const auto isBeside = [&](const RobotPixel& other, int column) {
      return std::abs(row - other.row) <= beside_.rows && std::abs(column - other.column) <= reach;
    };
    for (int column = at.column - reach; column <= at.column + reach; ++column) {
      if ((leaves_before && isBeside(before, column)) || (leaves_after && isBeside(after, column)))
        continue;
      addOutline(grid_.index(row, grid_.wrapped(column)), at.distance, serial);
    }
  }
}

void NewestLooks::addOutline(std::size_t beside, float distance, std::uint32_t serial) {
  Outline& outline = outlines_[beside];
  if (outline.serial != serial || distance < outline.distance) outline = {distance, serial};
  // The scan lines just before passed as near by.
  if (serial - serials_[beside] <= kNeighbours) {
    lines_[beside].outline = std::min(lines_[beside].outline, distance);
  }
}

void NewestLooks::addLines(std::uint32_t serial, const std::vector<Look>& looks,
                           std::uint32_t outline_scans) {
  PixelFollower follower(grid_);
  for (const Look& look : looks) {
    if (look.what == Seen::kRobot) continue;
    const Vector3 sight = look.end - look.viewpoint;
    const double range = sight.norm();
    if (!(range > kNearestLook)) continue;  // NaN, too
    const Vector3 direction = sight / range;
    widenBand(look.viewpoint, direction);
    if (look.what == Seen::kUnclear) continue;
    follower.follow(sight);
    const std::size_t pixel = follower.pixel();
    looked_.insert(pixel);
    Line& line = lines_[pixel];
    // Of one scan the look that saw the farthest.
    if (serials_[pixel] == serial && line.range >= static_cast<float>(range)) continue;
    const Outline& outline = outlines_[pixel];
    const bool stands = outline.serial != 0 && serial - outline.serial <= outline_scans;
    serials_[pixel] = serial;
    line = {look.viewpoint.cast<float>(), direction.cast<float>(), static_cast<float>(range),
            stands ? outline.distance : kNone};
  }
}

bool NewestLooks::sees(const Line& line, const Vector3& p_fixed, double short_m) const {
  const Eigen::Vector3f to_place = p_fixed.cast<float>() - line.viewpoint;
  const double along = static_cast<double>(to_place.dot(line.direction));
  const double distance = static_cast<double>(to_place.norm());
  return line.range >= 0.0F && along >= cosine_ * distance &&
         static_cast<double>(line.range) >= distance - short_m &&
         static_cast<double>(line.outline) > distance;
}

bool NewestLooks::sawSince(std::uint32_t serial, const Vector3& p_fixed, const Vector3& viewpoint,
                           double short_m) const {
  const Vector3 sight = p_fixed - viewpoint;
  if (!(sight.squaredNorm() > kNearestLook * kNearestLook)) return false;
  return grid_.visitAround(grid_.pixelOf(sight), looking_, [&](int row, int column) {
    const std::size_t pixel = grid_.index(row, column);
    return isAfter(serials_[pixel], serial) && sees(lines_[pixel], p_fixed, short_m);
  });
}

bool NewestLooks::sawLast(const Vector3& p_fixed, const Vector3& viewpoint, double short_m) const {
  const Vector3 sight = p_fixed - viewpoint;
  const double range = sight.norm();
  if (!(range > kNearestLook)) return false;
  // Twice the swing, as angles: of the place's direction and of the looks'.
  const double reach = band_ + angle_ + 2.0 * kSwing / range;
  if (std::abs(sight.dot(normal_)) > reach * range) return false;
  return grid_.visitAround(grid_.pixelOf(sight), looking_, [&](int row, int column) {
    const std::size_t pixel = grid_.index(row, column);
    return looked_.has(pixel) && sees(lines_[pixel], p_fixed, short_m);
  });
}

}  // namespace tccm
