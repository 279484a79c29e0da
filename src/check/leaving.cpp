#include "check/leaving.h"

#include <algorithm>
#include <limits>

#include "geometry/distance.h"

namespace tccm {

Leaving::Leaving(std::size_t contacts_max) {
  followed_.reserve(contacts_max);
  cuboids_.reserve(contacts_max);
}

void Leaving::begin(const std::vector<std::uint32_t>& touched) {
  followed_.clear();
  cuboids_ = touched;
}

void Leaving::passEscape(const CuboidMap& map, const Shape& solid, const Shape& core,
                         const Pose& T_fixed_shape) {
  followed_.clear();
  for (const std::uint32_t cuboid : cuboids_) {
    const UprightBox box = map.box(map.cuboids[cuboid]);
    if (distance(solid, T_fixed_shape, box) > 0.0) continue;
    followed_.push_back({cuboid, distance(core, T_fixed_shape, box) - MovingOut::kNoise});
  }
}

double Leaving::update(const CuboidMap& map, const Shape& core, const Pose& T_fixed_shape) {
  cuboids_.clear();
  double until_ahead_m = std::numeric_limits<double>::infinity();
  for (const Followed& followed : followed_) {
    const double metres =
        distance(core, T_fixed_shape, map.box(map.cuboids[followed.cuboid])) - followed.nearest_m;
    if (metres < 0.0) continue;
    until_ahead_m = std::min(until_ahead_m, metres);
    cuboids_.push_back(followed.cuboid);
  }
  return until_ahead_m;
}

}  // namespace tccm
