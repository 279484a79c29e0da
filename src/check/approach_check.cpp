#include "check/approach_check.h"

#include <utility>

#include "base/line_of.h"
#include "check/contact_judge.h"

namespace tccm {

void ApproachCheck::Config::describe(ParameterTable& table) {
  table.add("approach_distance_m", &distance_m, "m", {0.0, 1.0},
            "what has appeared in the sight of a camera or lidar stops the robot so far from a "
            "link (see `appeared_s`); 0: as contacts do",
            Tunable::kYes);
}

ApproachCheck::ApproachCheck(std::shared_ptr<const CheckedRobot> robot, const Config& config)
    : robot_(std::move(robot)), distance_m_(config.distance_m) {
  for (const std::size_t shape : robot_->collision_body.shapes) {
    reach_.push_back(expanded(robot_->model->shapes()[shape].shape, {1.0, distance_m_}));
  }
}

std::optional<Contact> ApproachCheck::judge(const Situation& situation, Causes& causes) const {
  const CuboidMap& map = situation.around.map;
  if (distance_m_ == 0.0 || map.appeared == 0) return std::nullopt;
  const std::vector<std::size_t>& shapes = robot_->collision_body.shapes;
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    const Posture& here = situation.check_here.posture();
    const auto cuboid =
        robot_->collision.firstAppeared(map, reach_[i], here.T_fixed_shapes[shapes[i]],
                                        static_cast<std::uint32_t>(i), &here.T_fixed_links);
    if (!cuboid) continue;
    const auto shape = static_cast<std::uint32_t>(shapes[i]);
    const std::string what =
        lineOf(": something that has appeared is within %.0f mm", 1e3 * distance_m_);
    causes.emplace_back(Reason::kApproached, textOfContact(*robot_->model, shape, what),
                        robot_->model->linkOf(shape));
    return Contact{shape, *cuboid};
  }
  return std::nullopt;
}

}  // namespace tccm
