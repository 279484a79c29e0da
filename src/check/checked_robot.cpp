#include "check/checked_robot.h"

namespace tccm {

UsedBody::UsedBody(const RobotModel& model, const LinkUse& use, const LinkUse::Keys& keys) {
  const UsedShapes used = model.shapesFor(use, keys);
  shapes = used.shapes;
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    const LinkShape& bare = model.shapes()[shapes[i]];
    links.push_back(static_cast<std::uint32_t>(bare.link));
    body.shapes.push_back(expanded(bare.shape, used.expansions[i]));
  }
  body.poses.resize(shapes.size(), Pose::Identity());
}

std::vector<double> UsedBody::radii(double growth_m) const {
  std::vector<double> radii;
  for (const Shape& shape : body.shapes) {
    radii.push_back(boundingRadius(expanded(shape, {1.0, growth_m})));
  }
  return radii;
}

void CheckedRobot::Config::describe(ParameterTable& table) {
  collision_use.describe(table, kCollisionKeys, Tunable::kYes);
  collision.describe(table);
  table.add("check_occlusion", &check_occlusion,
            "whether hidden links stop the robot; not switched off while it moves", Tunable::kYes);
  occlusion_use.describe(table, kOcclusionKeys);
  occlusion.describe(table);
}

void CheckedRobot::Config::validate() const {
  collision_use.validate(kCollisionKeys);
  occlusion_use.validate(kOcclusionKeys);
}

CheckedRobot::CheckedRobot(std::shared_ptr<const RobotModel> model, const Config& config)
    : model_(std::move(model)),
      config_(validated(config)),
      collision_body_(*model_, config.collision_use, kCollisionKeys),
      occlusion_body_(*model_, config.occlusion_use, kOcclusionKeys),
      collision_(config.collision) {}

}  // namespace tccm
