#include "experiments/robot_part.h"

#include <utility>

#include "robot/link_use.h"

namespace tccm::simulation {
namespace {

std::vector<std::size_t> shapesOf(const RobotModel& model, const std::vector<std::string>& links) {
  LinkUse use;
  use.links = links;
  return model.shapesFor(use, kCollisionKeys).shapes;
}

Body bodyOf(const RobotModel& model, const std::vector<std::size_t>& shapes) {
  Body body;
  for (const std::size_t shape : shapes) body.shapes.push_back(model.shapes()[shape].shape);
  body.poses.resize(shapes.size(), Pose::Identity());
  return body;
}

}  // namespace

RobotPart::RobotPart(std::shared_ptr<const RobotModel> model, const std::vector<std::string>& links,
                     double spacing)
    : model_(std::move(model)),
      shapes_(shapesOf(*model_, links)),
      poses_(shapes_.size()),
      body_(bodyOf(*model_, shapes_), spacing) {}

void RobotPart::moveTo(const std::vector<Pose>& link_poses) {
  for (std::size_t i = 0; i < shapes_.size(); ++i) {
    const LinkShape& shape = model_->shapes()[shapes_[i]];
    poses_[i] = link_poses[shape.link] * shape.T_link_shape;
  }
  body_.moveTo(poses_);
}

}  // namespace tccm::simulation
