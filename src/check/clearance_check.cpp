#include "check/clearance_check.h"

#include <algorithm>
#include <limits>

#include "check/nearest_cuboid.h"

namespace tccm {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace

ClearanceCheck::ClearanceCheck(std::shared_ptr<const RobotModel> model,
                               const LinkUse& collision_use,
                               const CollisionCheck::Config& collision, double radius_m)
    : model_(std::move(model)),
      shapes_(model_->shapesFor(collision_use, kCollisionKeys).shapes),
      collision_(collision),
      kinematics_(model_),
      radius_m_(radius_m) {
  for (const std::size_t shape : shapes_) {
    const std::size_t link = model_->shapes()[shape].link;
    const auto found = std::find_if(result_.begin(), result_.end(),
                                    [link](const auto& entry) { return entry.link == link; });
    slot_of_shape_.push_back(static_cast<std::size_t>(found - result_.begin()));
    if (found == result_.end()) result_.push_back({link});
  }
}

std::optional<NearestCuboid> ClearanceCheck::nearest(const CuboidMap& map, const Shape& shape,
                                                     const Pose& T_fixed_shape,
                                                     double nearer_than_m) const {
  NearestCuboidSearch search(map, shape, T_fixed_shape, nearer_than_m);
  return search.find([&](const Cuboid& cuboid) { return collision_.hasSupport(map, cuboid); });
}

const std::vector<LinkClearance>& ClearanceCheck::find(const CuboidMap& map,
                                                       const std::vector<double>& positions,
                                                       const std::vector<Pose>& T_fixed_roots) {
  kinematics_.update(positions, T_fixed_roots);
  for (LinkClearance& entry : result_) entry = {entry.link};
  for (std::size_t i = 0; i < shapes_.size(); ++i) {
    LinkClearance& entry = result_[slot_of_shape_[i]];
    const auto found =
        nearest(map, model_->shapes()[shapes_[i]].shape, kinematics_.shapePoses()[shapes_[i]],
                std::min(radius_m_, entry.distance_m));
    if (!found) continue;
    entry.distance_m = found->distance_m;
    entry.cuboid = found->cuboid;
  }
  return result_;
}

double ClearanceCheck::least(const CuboidMap& map, const std::vector<double>& positions,
                             const std::vector<Pose>& T_fixed_roots) {
  kinematics_.update(positions, T_fixed_roots);
  double least = radius_m_;
  bool any = false;
  for (const std::size_t shape : shapes_) {
    const auto found =
        nearest(map, model_->shapes()[shape].shape, kinematics_.shapePoses()[shape], least);
    if (!found) continue;
    least = found->distance_m;
    any = true;
    if (least == 0.0) break;
  }
  return any ? least : kInfinity;
}

}  // namespace tccm
