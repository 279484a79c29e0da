#include "sight/newest_looks.h"

#include <algorithm>
#include <cmath>

namespace tccm {
namespace {

constexpr std::uint32_t kNeighbours = 3;  // scans before one that pass beside it
constexpr double kSwing = 0.02;           // [m] that a sensor's origin moves at most within a scan

bool isAfter(std::uint32_t serial, std::uint32_t other) {
  return static_cast<std::int32_t>(serial - other) > 0;  // they may wrap
}

}  // namespace

NewestLooks::NewestLooks(double angle_rad, double outline_rad)
    : grid_(angle_rad),
      angle_(angle_rad),
      cosine_(std::cos(angle_rad)),
      looking_(grid_.around(angle_rad)),
      beside_(grid_.around(outline_rad)),
      lines_(grid_.pixels()),
      outlines_(grid_.pixels()) {
  looking_.rows = 1;
}

void NewestLooks::clear() {
  std::fill(lines_.begin(), lines_.end(), Line());
  std::fill(outlines_.begin(), outlines_.end(), Outline());
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
    band_ = std::max(band_, std::abs(direction(i).dot(normal_)));  // which passes over NaN
  }
}

void NewestLooks::add(std::uint32_t serial, const std::vector<Look>& looks,
                      std::uint32_t outline_scans) {
  serial_ = serial;
  enclose(looks);
  addOutlines(serial, looks);
  addLines(serial, looks, outline_scans);
}

/// Neighbouring beams are nearer to each other than pixels: those that follow one another in a
/// pixel are added as one.
void NewestLooks::addOutlines(std::uint32_t serial, const std::vector<Look>& looks) {
  std::size_t pixel = grid_.pixels();
  float nearest = kNone;
  for (const Look& look : looks) {
    if (look.what != Seen::kRobot) continue;
    const Vector3 sight = look.end - look.viewpoint;
    const double distance = sight.norm();
    if (!(distance > kNearestLook)) continue;  // NaN, too
    const std::size_t own = grid_.pixelOf(sight);
    if (own != pixel) {
      if (nearest != kNone) addOutline(pixel, nearest, serial);
      pixel = own;
      nearest = kNone;
    }
    nearest = std::min(nearest, static_cast<float>(distance));
  }
  if (nearest != kNone) addOutline(pixel, nearest, serial);
}

void NewestLooks::addOutline(std::size_t pixel, float distance, std::uint32_t serial) {
  grid_.visitAround(pixel, beside_, [&](int row, int column) {
    const std::size_t beside = grid_.index(row, column);
    Outline& outline = outlines_[beside];
    if (outline.serial != serial || distance < outline.distance) outline = {distance, serial};
    // The scan lines just before passed as near by.
    Line& line = lines_[beside];
    if (serial - line.serial <= kNeighbours) line.outline = std::min(line.outline, distance);
    return false;
  });
}

void NewestLooks::addLines(std::uint32_t serial, const std::vector<Look>& looks,
                           std::uint32_t outline_scans) {
  for (const Look& look : looks) {
    if (look.what == Seen::kRobot || look.what == Seen::kUnclear) continue;
    const Vector3 sight = look.end - look.viewpoint;
    const double range = sight.norm();
    if (!(range > kNearestLook)) continue;  // NaN, too
    const std::size_t pixel = grid_.pixelOf(sight);
    Line& line = lines_[pixel];
    // Of one scan the look that saw the farthest.
    if (line.serial == serial && line.range >= static_cast<float>(range)) continue;
    const Outline& outline = outlines_[pixel];
    const bool stands = outline.serial != 0 && serial - outline.serial <= outline_scans;
    line = {look.viewpoint.cast<float>(), (sight / range).cast<float>(), static_cast<float>(range),
            serial, stands ? outline.distance : kNone};
  }
}

bool NewestLooks::sawSince(std::uint32_t serial, const Vector3& p_fixed, const Vector3& viewpoint,
                           double short_m) const {
  const Vector3 sight = p_fixed - viewpoint;
  if (!(sight.squaredNorm() > kNearestLook * kNearestLook)) return false;
  return grid_.visitAround(grid_.pixelOf(sight), looking_, [&](int row, int column) {
    const Line& line = lines_[grid_.index(row, column)];
    if (line.range < 0.0F || !isAfter(line.serial, serial)) return false;
    const Eigen::Vector3f to_place = p_fixed.cast<float>() - line.viewpoint;
    const double along = static_cast<double>(to_place.dot(line.direction));
    const double distance = static_cast<double>(to_place.norm());
    return along >= cosine_ * distance && static_cast<double>(line.range) >= distance - short_m &&
           static_cast<double>(line.outline) > distance;
  });
}

bool NewestLooks::sawLast(const Vector3& p_fixed, const Vector3& viewpoint, double short_m) const {
  const Vector3 sight = p_fixed - viewpoint;
  const double range = sight.norm();
  if (!(range > kNearestLook)) return false;
  // Twice the swing, as angles: of the place's direction and of the looks'.
  const double reach = band_ + angle_ + 2.0 * kSwing / range;
  if (std::abs(sight.dot(normal_)) > reach * range) return false;
  return sawSince(serial_ - 1, p_fixed, viewpoint, short_m);
}

}  // namespace tccm
