#pragma once

#include <chrono>
#include <cmath>
#include <vector>

#include "geometry/ray.h"
#include "tccm_monitor/cuboid_map.h"

namespace tccm::test {

/// The image of a sensor at the map's viewpoint that has just looked in every direction, half a
/// second ago too, and met nothing but the map's cuboids. Ray by ray, cuboid by cuboid.
inline void lookAround(CuboidMap& map) {
  struct Target {
    Shape box;
    Vector3 centre;
    Vector3 direction;
    double cosine;
  };
  std::vector<Target> targets;
  for (const Cuboid& cuboid : map.cuboids) {
    const UprightBox box = map.box(cuboid);
    const Vector3 half = 0.5 * box.sizes(), to_centre = box.center() - map.viewpoint;
    const double reach = std::min(1.0, half.norm() / to_centre.norm());
    targets.push_back(
        {Box{half}, box.center(), to_centre.normalized(), std::sqrt(1.0 - reach * reach) - 1e-9});
  }
  map.looks.begin(map.stamp - std::chrono::milliseconds(500), map.viewpoint);
  const DirectionGrid& grid = map.looks.grid();
  for (int row = 0; row < grid.rows(); ++row) {
    for (int column = 0; column < grid.columns(); ++column) {
      const Vector3 direction = grid.middle(row, column);
      double range = 60.0;
      Seen end = Seen::kNothing;
      for (const Target& target : targets) {
        if (direction.dot(target.direction) < target.cosine) continue;
        const auto span = intersect(target.box, {map.viewpoint - target.centre, direction});
        if (!span || span->enter >= range) continue;
        range = span->enter;
        end = Seen::kSurface;
      }
      const auto range_mm = static_cast<std::uint16_t>(1e3 * range);
      map.looks.edit(row, column) = {LookImage::Pass{500, 500, range_mm, end},
                                     LookImage::Pass{0, 0, range_mm, end}};
    }
  }
  if (map.look_period == Duration::zero()) map.look_period = std::chrono::seconds(1);
}

/// The same looks, as if they had just been made.
inline void refreshLooks(CuboidMap& map) {
  LookImage looks(map.looks.grid().resolution());
  looks.begin(map.stamp - std::chrono::milliseconds(500), map.looks.viewpoint());
  for (int row = map.looks.rowBegin(); row < map.looks.rowEnd(); ++row) {
    for (int column = 0; column < looks.grid().columns(); ++column) {
      looks.edit(row, column) = map.looks.passes(looks.grid().index(row, column));
    }
  }
  map.looks.copyFrom(looks);
}

}  // namespace tccm::test
