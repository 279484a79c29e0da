#pragma once

#include <vector>

#include "tccm_monitor/cuboid_map.h"

namespace tccm {

/// What all sensors say of the surroundings at one instant: what is occupied, and, sensor by
/// sensor, where each looked. A view; the maps have to outlive it.
class Surroundings {
 public:
  /// Of one sensor its map says both.
  Surroundings(const CuboidMap& one) : map(one), one_(&one) {}  // NOLINT(google-explicit-*)
  /// @param all what is occupied. @param sensors each one's own map.
  Surroundings(const CuboidMap& all, const std::vector<const CuboidMap*>& sensors)
      : map(all), many_(&sensors) {}

  const CuboidMap& map;

  /// The sensors' maps.
  [[nodiscard]] const CuboidMap* const* begin() const { return many_ ? many_->data() : &one_; }
  [[nodiscard]] const CuboidMap* const* end() const { return begin() + size(); }
  [[nodiscard]] std::size_t size() const { return many_ ? many_->size() : 1; }

 private:
  const CuboidMap* one_ = nullptr;
  const std::vector<const CuboidMap*>* many_ = nullptr;
};

}  // namespace tccm
