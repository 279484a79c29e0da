#include "check/area_check.h"

#include <algorithm>
#include <utility>

#include "base/line_of.h"
#include "geometry/overlap.h"
#include "robot/link_mounts.h"

namespace tccm {
namespace {

std::string textOf(const std::string& link, const Vector3& p_fixed, const UprightBox& area,
                   const std::string& fixed_frame) {
  return lineOf(
      "nothing of the robot that moves is inside the map's area: %.60s is at (%.2f, "
      "%.2f, %.2f) in %.60s, and the area is x %.2f to %.2f, y %.2f to %.2f, z %.2f to "
      "%.2f m; drive back, or enlarge it (area_*_m, height_*_m)",
      link.c_str(), p_fixed.x(), p_fixed.y(), p_fixed.z(), fixed_frame.c_str(), area.min().x(),
      area.max().x(), area.min().y(), area.max().y(), area.min().z(), area.max().z());
}

}  // namespace

AreaCheck::AreaCheck(std::shared_ptr<const CheckedRobot> robot) : robot_(std::move(robot)) {
  const RobotModel& model = *robot_->model;
  const std::vector<LinkMount> mounts = linkMounts(model);
  const std::vector<std::size_t>& checked = robot_->collision_body.shapes;
  std::copy_if(checked.begin(), checked.end(), std::back_inserter(moved_),
               [&](std::size_t shape) { return mounts[model.shapes()[shape].link].moves; });
}

Cause AreaCheck::judge(const Grid& grid, const Posture& posture, bool roots_move,
                       const std::string& fixed_frame) const {
  const RobotModel& model = *robot_->model;
  const UprightBox area = grid.area();
  const bool all = roots_move || moved_.empty();
  const std::vector<std::size_t>& shapes = all ? robot_->collision_body.shapes : moved_;
  const auto isInside = [&](std::size_t shape) {
    return overlaps(model.shapes()[shape].shape, posture.T_fixed_shapes[shape], area);
  };
  if (std::any_of(shapes.begin(), shapes.end(), isInside)) return {};
  const auto beyond = [&](std::size_t shape) {
    return area.squaredExteriorDistance(posture.T_fixed_shapes[shape].translation());
  };
  const std::size_t nearest =
      *std::min_element(shapes.begin(), shapes.end(),
                        [&](std::size_t a, std::size_t b) { return beyond(a) < beyond(b); });
  const std::string& link = model.linkOf(nearest);
  return {Reason::kOutsideArea,
          textOf(link, posture.T_fixed_shapes[nearest].translation(), area, fixed_frame), link};
}

}  // namespace tccm
