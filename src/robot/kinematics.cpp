#include "robot/kinematics.h"

#include <cassert>

namespace tccm {

Kinematics::Kinematics(std::shared_ptr<const RobotModel> model)
    : model_(std::move(model)),
      link_poses_(model_->links().size(), Pose::Identity()),
      shape_poses_(model_->shapes().size(), Pose::Identity()) {}

void Kinematics::update(const std::vector<double>& positions,
                        const std::vector<Pose>& T_fixed_roots) {
  assert(positions.size() == model_->variables().size());
  assert(T_fixed_roots.size() == model_->roots().size());
  for (std::size_t i = 0; i < T_fixed_roots.size(); ++i) {
    link_poses_[model_->roots()[i]] = T_fixed_roots[i];
  }
  for (const RobotJoint& joint : model_->joints()) {
    Pose& T_fixed_child = link_poses_[joint.child];
    T_fixed_child = link_poses_[joint.parent] * joint.T_parent_joint;
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
    shape_poses_[i] = link_poses_[shapes[i].link] * shapes[i].T_link_shape;
  }
}

}  // namespace tccm
