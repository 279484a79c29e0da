#pragma once

#include <cstddef>
#include <vector>

#include "tccm_monitor/cuboid_map.h"

namespace tccm {

class KeepOut;

/// What one sensor looked at, and when.
struct SensorView {
  const CuboidMap* map = nullptr;
  /// Nothing that is to be relied on comes of it any more: what it saw counts for as long as that
  /// is not old, and it will not look again.
  bool is_out = false;
};

/// What all sensors say of the surroundings at one instant: what is occupied, and, sensor by
/// sensor, where each looked; and where nobody may go. A view; the maps have to outlive it.
class Surroundings {
 public:
  /// Of one sensor its map says both.
  Surroundings(const CuboidMap& one) : map(one), one_{&one} {}  // NOLINT(google-explicit-*)
  /// @param all what is occupied. @param regions null: none
  Surroundings(const CuboidMap& all, const std::vector<SensorView>& sensors,
               const KeepOut* regions = nullptr)
      : map(all), keep_out(regions), many_(&sensors) {}

  const CuboidMap& map;
  /// Regions that no link may enter; null where there are none.
  const KeepOut* keep_out = nullptr;

  [[nodiscard]] const SensorView* begin() const { return many_ ? many_->data() : &one_; }
  [[nodiscard]] const SensorView* end() const { return begin() + size(); }
  [[nodiscard]] std::size_t size() const { return many_ ? many_->size() : 1; }

 private:
  SensorView one_;
  const std::vector<SensorView>* many_ = nullptr;
};

}  // namespace tccm
