#include "robot/joint_track.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace tccm {
namespace {

constexpr double kTurn = 2.0 * M_PI;
constexpr std::size_t kSpeeds = 16;  // looked at for the usual speed

}  // namespace

void JointTrack::clear() {
  count_ = next_ = 0;
  jump.reset();
  fast_since.reset();
}

void JointTrack::add(const JointSample& sample) {
  ring_[next_] = sample;
  next_ = (next_ + 1) % ring_.size();
  count_ = std::min(count_ + 1, ring_.size());
}

const JointSample* JointTrack::before(Time stamp) const {
  for (std::size_t k = 0; k < count_; ++k) {
    if (newest(k).stamp <= stamp) return &newest(k);
  }
  return nullptr;
}

double JointTrack::moved(double from, double to) const {
  return turns_freely_ ? std::remainder(to - from, kTurn) : to - from;
}

JointTrack::Slope JointTrack::differentiate(double baseline_s, double gap_max_s) const {
  Slope slope;
  for (std::size_t k = 1; k < count_; ++k) {
    const double dt = toSeconds(newest(0).stamp - newest(k).stamp);
    if (dt > std::max(gap_max_s, baseline_s) && k > 1) break;
    slope = {moved(newest(k).position, newest(0).position) / dt, dt};
    if (dt >= baseline_s) break;
  }
  return slope;
}

double JointTrack::quartileOfSpeeds(std::size_t apart) const {
  std::array<double, kSpeeds> speeds;
  std::size_t many = 0;
  for (std::size_t k = 0; k + apart < count_ && many < kSpeeds; ++k) {
    const double dt = toSeconds(newest(k).stamp - newest(k + apart).stamp);
    speeds[many++] = std::abs(moved(newest(k + apart).position, newest(k).position)) / dt;
  }
  if (many == 0) return 0.0;
  const auto quartile = speeds.begin() + static_cast<std::ptrdiff_t>(many / 4);
  std::nth_element(speeds.begin(), quartile, speeds.begin() + static_cast<std::ptrdiff_t>(many));
  return *quartile;
}

double JointTrack::usualSpeed() const { return std::min(quartileOfSpeeds(1), quartileOfSpeeds(2)); }

std::optional<double> JointTrack::at(Time stamp, double gap_max_s) const {
  for (std::size_t k = 0; k < count_; ++k) {
    const JointSample& before = newest(k);
    if (before.stamp > stamp) continue;
    if (before.stamp == stamp) return before.position;
    if (k == 0) return std::nullopt;
    const JointSample& after = newest(k - 1);
    const double gap = toSeconds(after.stamp - before.stamp);
    if (gap > gap_max_s) return std::nullopt;
    const double u = toSeconds(stamp - before.stamp) / gap;
    return before.position + u * moved(before.position, after.position);
  }
  return std::nullopt;
}

}  // namespace tccm
