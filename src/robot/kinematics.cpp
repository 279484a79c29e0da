#include "robot/kinematics.h"

#include <cassert>

namespace tccm {

Kinematics::Kinematics(std::shared_ptr<const RobotModel> model)
    : model_(std::move(model)),
      posture_{std::vector<double>(model_->variables().size(), 0.0),
               std::vector<Pose>(model_->roots().size(), Pose::Identity()),
               std::vector<Pose>(model_->links().size(), Pose::Identity()),
               std::vector<Pose>(model_->shapes().size(), Pose::Identity())} {}

const Posture& Kinematics::update(const std::vector<double>& positions,
                                  const std::vector<Pose>& T_fixed_roots) {
  assert(positions.size() == model_->variables().size());
  assert(T_fixed_roots.size() == model_->roots().size());
  posture_.positions = positions;
  posture_.T_fixed_roots = T_fixed_roots;
  std::vector<Pose>& link_poses = posture_.T_fixed_links;
  for (std::size_t i = 0; i < T_fixed_roots.size(); ++i) {
    link_poses[model_->roots()[i]] = T_fixed_roots[i];
  }
  for (const RobotJoint& joint : model_->joints()) {
    Pose& T_fixed_child = link_poses[joint.child];
    T_fixed_child = link_poses[joint.parent] * joint.T_parent_joint;
    if (joint.motion == RobotJoint::Motion::kFixed) continue;
    const double position = joint.multiplier * positions[joint.variable] + joint.offset;
    if (joint.motion == RobotJoint::Motion::kRotation) {
      T_fixed_child.rotate(Eigen::AngleAxisd(position, joint.axis));
    } else {
      T_fixed_child.translate(position * joint.axis);
    }
  }
  const auto& shapes = model_->shapes();
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    posture_.T_fixed_shapes[i] = link_poses[shapes[i].link] * shapes[i].T_link_shape;
  }
  return posture_;
}

}  // namespace tccm
