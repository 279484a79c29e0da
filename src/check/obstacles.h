#pragma once

#include <cstdint>

#include "check/keep_out.h"
#include "geometry/distance.h"
#include "geometry/overlap.h"
#include "tccm_monitor/cuboid_map.h"

namespace tccm {

/// What a primitive must not touch: a map's cuboids, or the regions to keep out of, each by its
/// number. A view.
class Obstacles {
 public:
  Obstacles(const CuboidMap& map) : map_(&map) {}               // NOLINT(google-explicit-*)
  Obstacles(const KeepOut& keep_out) : keep_out_(&keep_out) {}  // NOLINT(google-explicit-*)

  /// Null where they are regions.
  [[nodiscard]] const CuboidMap* map() const { return map_; }
  /// Null where they are cuboids.
  [[nodiscard]] const KeepOut* keepOut() const { return keep_out_; }

  /// As tccm::distance() and tccm::overlaps() tell it of boxes.
  [[nodiscard]] double distanceTo(std::uint32_t obstacle, const Shape& shape,
                                  const Pose& T_fixed_shape) const {
    if (keep_out_) return keep_out_->distanceTo(obstacle, shape, T_fixed_shape);
    return distance(shape, T_fixed_shape, map_->box(map_->cuboids[obstacle]));
  }
  [[nodiscard]] bool touches(std::uint32_t obstacle, const Shape& shape,
                             const Pose& T_fixed_shape) const {
    if (keep_out_) return keep_out_->touches(obstacle, shape, T_fixed_shape);
    return overlaps(shape, T_fixed_shape, map_->box(map_->cuboids[obstacle]));
  }

 private:
  const CuboidMap* map_ = nullptr;
  const KeepOut* keep_out_ = nullptr;
};

}  // namespace tccm
