#include "tccm_monitor/check/collision_check.h"

#include "tccm_monitor/config_error.h"
#include "tccm_monitor/geometry/overlap.h"

namespace tccm {

void CollisionCheck::Config::validate() const {
  requireInRange("support_points", support_points, 1, 20);
  requireInRange("support_height_m", support_height_m, 0.0, 1.0);
  requireInRange("contacts_max", contacts_max, 1, 100000);
}

CollisionCheck::CollisionCheck(const Config& config) : config_((config.validate(), config)) {
  contacts_.reserve(static_cast<std::size_t>(config_.contacts_max));
}

const std::vector<Contact>& CollisionCheck::find(const CuboidMap& map, const Body& body) {
  contacts_.clear();
  for (std::uint32_t i = 0; i < body.shapes.size(); ++i) findOf(map, body, i);
  return contacts_;
}

void CollisionCheck::findOf(const CuboidMap& map, const Body& body, std::uint32_t shape) {
  const UprightBox around = bounds(body.shapes[shape], body.poses[shape]);
  const Grid::Footprint footprint = map.grid.footprint(around);
  const Height low = map.grid.heightFloor(around.min().z());
  const Height high = map.grid.heightCeil(around.max().z());
  for (CellIndex y = footprint.y_begin; y < footprint.y_end; ++y) {
    const std::uint32_t* cell_begin = &map.cell_begin[y * map.grid.cellsX()];
    const std::uint32_t end = cell_begin[footprint.x_end];
    for (std::uint32_t k = cell_begin[footprint.x_begin]; k < end; ++k) {
      const Cuboid& cuboid = map.cuboids[k];
      if (cuboid.top < low || cuboid.bottom > high) continue;
      if (!overlaps(body.shapes[shape], body.poses[shape], map.box(cuboid))) continue;
      // Its own returns are most of the support, and mostly enough.
      const auto needed = static_cast<std::uint32_t>(config_.support_points);
      if (cuboid.points < needed && needed > 1 &&
          supportOf(map, cuboid, config_.support_height_m) < needed) {
        continue;
      }
      if (contacts_.size() == static_cast<std::size_t>(config_.contacts_max)) return;
      contacts_.push_back({shape, k});
    }
  }
}

}  // namespace tccm
