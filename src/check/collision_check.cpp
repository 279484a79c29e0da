#include "check/collision_check.h"

#include <algorithm>
#include <utility>

#include "geometry/overlap.h"
#include "tccm_monitor/config_error.h"

namespace tccm {

void CollisionCheck::Config::describe(ParameterTable& table) {
  table.add("support_points", &support_points, "points", {1, 20},
            "a contact counts where so many returns lie near it; 1: always", Tunable::kYes);
  table.add("support_height_m", &support_height_m, "m", {0.0, 1.0},
            "near: in the 3 x 3 cells around it, and within this height");
  table.add("contacts_max", &contacts_max, "", {1, 100000}, "contacts listed");
}

CollisionCheck::CollisionCheck(const Config& config) : config_(validated(config)) {}

bool CollisionCheck::isExempt(std::uint32_t index, const UprightBox& cuboid) const {
  if (exempt_.empty()) return false;
  return std::any_of(exempt_[index].begin(), exempt_[index].end(), [&cuboid](const auto& region) {
    const Pose T_region_fixed = region.pose.inverse();
    for (int corner = 0; corner < 8; ++corner) {
      const Vector3 p_fixed = cuboid.corner(static_cast<UprightBox::CornerType>(corner));
      if (distance(region.shape, T_region_fixed * p_fixed) > 0.0) return false;
    }
    return true;
  });
}

template <typename Visit>
void CollisionCheck::visitContacts(const CuboidMap& map, const Shape& shape,
                                   const Pose& T_fixed_shape, std::uint32_t index,
                                   Visit&& visit) const {
  const UprightBox around = bounds(shape, T_fixed_shape);
  const Grid::Footprint footprint = map.grid.footprint(around);
  const Height low = map.grid.heightFloor(around.min().z());
  const Height high = map.grid.heightCeil(around.max().z());
  for (CellIndex y = footprint.y_begin; y < footprint.y_end; ++y) {
    const std::uint32_t* cell_begin = &map.cell_begin[y * map.grid.cellsX()];
    const std::uint32_t end = cell_begin[footprint.x_end];
    for (std::uint32_t k = cell_begin[footprint.x_begin]; k < end; ++k) {
      const Cuboid& cuboid = map.cuboids[k];
      if (cuboid.top < low || cuboid.bottom > high) continue;
      const UprightBox box = map.box(cuboid);
      if (!overlaps(shape, T_fixed_shape, box)) continue;
      if (!hasSupport(map, cuboid) || isExempt(index, box)) continue;
      if (!visit(k)) return;
    }
  }
}

bool CollisionCheck::hasSupport(const CuboidMap& map, const Cuboid& cuboid) const {
  // Its own returns are most of the support, and mostly enough.
  const auto needed = static_cast<std::uint32_t>(config_.support_points);
  return cuboid.points >= needed || needed <= 1 ||
         supportOf(map, cuboid, config_.support_height_m) >= needed;
}

void CollisionCheck::find(const CuboidMap& map, const Body& body,
                          std::vector<Contact>& contacts) const {
  contacts.clear();
  const auto most = static_cast<std::size_t>(config_.contacts_max);
  contacts.reserve(most);
  for (std::uint32_t i = 0; i < body.shapes.size() && contacts.size() < most; ++i) {
    visitContacts(map, body.shapes[i], body.poses[i], i, [&](std::uint32_t cuboid) {
      contacts.push_back({i, cuboid});
      return contacts.size() < most;
    });
  }
}

std::optional<std::uint32_t> CollisionCheck::first(const CuboidMap& map, const Shape& shape,
                                                   const Pose& T_fixed_shape,
                                                   std::uint32_t index) const {
  std::optional<std::uint32_t> found;
  visitContacts(map, shape, T_fixed_shape, index, [&found](std::uint32_t cuboid) {
    found = cuboid;
    return false;
  });
  return found;
}

}  // namespace tccm
