#include "robot/kinematics.h"

#include <algorithm>
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

LinkChain::LinkChain(const RobotModel& model, std::size_t link) {
  std::vector<const RobotJoint*> joint_to(model.links().size(), nullptr);
  for (const RobotJoint& joint : model.joints()) joint_to[joint.child] = &joint;
  std::vector<const RobotJoint*> chain;  // from the link to its root
  for (; joint_to[link]; link = joint_to[link]->parent) chain.push_back(joint_to[link]);
  const auto root = std::find(model.roots().begin(), model.roots().end(), link);
  root_ = static_cast<std::size_t>(root - model.roots().begin());
  for (auto joint = chain.rbegin(); joint != chain.rend(); ++joint) {
    T_last_link_ = T_last_link_ * (*joint)->T_parent_joint;
    if ((*joint)->motion == RobotJoint::Motion::kFixed) continue;
    steps_.push_back({T_last_link_, (*joint)->axis,
                      (*joint)->motion == RobotJoint::Motion::kRotation, (*joint)->variable,
                      (*joint)->multiplier, (*joint)->offset});
    T_last_link_ = Pose::Identity();
  }
}

Pose LinkChain::place(const std::vector<double>& positions,
                      const std::vector<Pose>& T_fixed_roots) const {
  Pose T_fixed_link = T_fixed_roots[root_];
  for (const Step& step : steps_) {
    const double position = step.multiplier * positions[step.variable] + step.offset;
    T_fixed_link = T_fixed_link * step.T_parent_joint;
    if (step.turns) {
      T_fixed_link.rotate(Eigen::AngleAxisd(position, step.axis));
    } else {
      T_fixed_link.translate(position * step.axis);
    }
  }
  return T_fixed_link * T_last_link_;
}

}  // namespace tccm
