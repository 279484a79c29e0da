#pragma once

#include <cstddef>
#include <vector>

#include "tccm_monitor/cuboid_map.h"

namespace tccm {

/// What one sensor looked at, and when.
struct SensorView {
  const CuboidMap* map = nullptr;
  /// Nothing that is to be relied on comes of it any more: what it saw counts for as long as that
  /// is not old, and it will not look again.
  bool is_out = false;
};

/// What all sensors say of the surroundings at one instant: what is occupied, and, sensor by
/// sensor, where each looked. A view; the maps have to outlive it.
class Surroundings {
 public:
  /// Of one sensor its map says both.
  Surroundings(const CuboidMap& one) : map(one), one_{&one} {}  // NOLINT(google-explicit-*)
  /// @param all what is occupied.
  Surroundings(const CuboidMap& all, const std::vector<SensorView>& sensors)
      : map(all), many_(&sensors) {}

  const CuboidMap& map;

  [[nodiscard]] const SensorView* begin() const { return many_ ? many_->data() : &one_; }
  [[nodiscard]] const SensorView* end() const { return begin() + size(); }
  [[nodiscard]] std::size_t size() const { return many_ ? many_->size() : 1; }

 private:
  SensorView one_;
  const std::vector<SensorView>* many_ = nullptr;
};

}  // namespace tccm
