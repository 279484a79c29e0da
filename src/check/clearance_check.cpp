#include "check/clearance_check.h"

#include <algorithm>
#include <limits>

#include "check/nearest_cuboid.h"

namespace tccm {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace

ClearanceCheck::ClearanceCheck(std::shared_ptr<const CheckedRobot> robot, double radius_m)
    : robot_(std::move(robot)), radius_m_(radius_m) {
  for (const std::size_t shape : robot_->collisionBody().shapes) {
    const std::size_t link = robot_->model().shapes()[shape].link;
    const auto found = std::find_if(result_.begin(), result_.end(),
                                    [link](const auto& entry) { return entry.link == link; });
    slot_of_shape_.push_back(static_cast<std::size_t>(found - result_.begin()));
    if (found == result_.end()) result_.push_back({link});
  }
}

std::optional<NearestCuboid> ClearanceCheck::nearest(const CuboidMap& map, const Posture& posture,
                                                     std::size_t shape,
                                                     double nearer_than_m) const {
  NearestCuboidSearch search(map, robot_->model().shapes()[shape].shape,
                             posture.T_fixed_shapes[shape], nearer_than_m);
  return search.find(
      [&](const Cuboid& cuboid) { return robot_->collision().hasSupport(map, cuboid); });
}

const std::vector<LinkClearance>& ClearanceCheck::find(const CuboidMap& map,
                                                       const Posture& posture) {
  const std::vector<std::size_t>& shapes = robot_->collisionBody().shapes;
  for (LinkClearance& entry : result_) entry = {entry.link};
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    LinkClearance& entry = result_[slot_of_shape_[i]];
    const auto found = nearest(map, posture, shapes[i], std::min(radius_m_, entry.distance_m));
    if (!found) continue;
    entry.distance_m = found->distance_m;
    entry.cuboid = found->cuboid;
  }
  return result_;
}

double ClearanceCheck::least(const CuboidMap& map, const Posture& posture) const {
  double least = radius_m_;
  bool any = false;
  for (const std::size_t shape : robot_->collisionBody().shapes) {
    const auto found = nearest(map, posture, shape, least);
    if (!found) continue;
    least = found->distance_m;
    any = true;
    if (least == 0.0) break;
  }
  return any ? least : kInfinity;
}

}  // namespace tccm
