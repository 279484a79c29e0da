#include "check/leaving.h"

#include <algorithm>
#include <limits>

namespace tccm {

Leaving::Leaving(std::size_t contacts_max) {
  followed_.reserve(contacts_max);
  obstacles_.reserve(contacts_max);
}

void Leaving::begin(const std::vector<std::uint32_t>& touched) {
  followed_.clear();
  obstacles_ = touched;
}

void Leaving::passEscape(const Obstacles& obstacles, const Shape& solid, const Shape& core,
                         const Pose& T_fixed_shape) {
  followed_.clear();
  for (const std::uint32_t obstacle : obstacles_) {
    if (obstacles.distanceTo(obstacle, solid, T_fixed_shape) > 0.0) continue;
    followed_.push_back(
        {obstacle, obstacles.distanceTo(obstacle, core, T_fixed_shape) - MovingOut::kNoise});
  }
}

double Leaving::update(const Obstacles& obstacles, const Shape& core, const Pose& T_fixed_shape) {
  obstacles_.clear();
  double until_ahead_m = std::numeric_limits<double>::infinity();
  for (const Followed& followed : followed_) {
    const double metres =
        obstacles.distanceTo(followed.obstacle, core, T_fixed_shape) - followed.nearest_m;
    if (metres < 0.0) continue;
    until_ahead_m = std::min(until_ahead_m, metres);
    obstacles_.push_back(followed.obstacle);
  }
  return until_ahead_m;
}

}  // namespace tccm
