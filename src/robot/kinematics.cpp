#include "robot/kinematics.h"

#include <algorithm>
#include <cassert>
#include <cstring>

namespace tccm {
namespace {

/// To the bit: a NaN is the same as itself, and 0 is not the same as -0.
bool isSame(const double* one, const double* other, std::size_t count) {
  return std::memcmp(one, other, count * sizeof(double)) == 0;
}

bool isSame(const Pose& one, const Pose& other) { return isSame(one.data(), other.data(), 16); }

}  // namespace

bool JointStand::moveTo(double position, const Vector3& axis, bool turns) {
  if (is_known_ && isSame(&position_, &position, 1)) return false;
  position_ = position;
  turns_ = turns;
  if (turns) turn_ = Eigen::AngleAxisd(position, axis).toRotationMatrix();
  is_known_ = true;
  return true;
}

void JointStand::apply(const Vector3& axis, Pose& T_fixed_joint) const {
  if (turns_) {
    T_fixed_joint.rotate(turn_);
  } else {
    T_fixed_joint.translate(position_ * axis);
  }
}

Kinematics::Kinematics(std::shared_ptr<const RobotModel> model)
    : model_(std::move(model)),
      posture_{std::vector<double>(model_->variables().size(), 0.0),
               std::vector<Pose>(model_->roots().size(), Pose::Identity()),
               std::vector<Pose>(model_->links().size(), Pose::Identity()),
               std::vector<Pose>(model_->shapes().size(), Pose::Identity())},
      stands_(model_->joints().size()),
      has_moved_(model_->links().size()) {}

const Posture& Kinematics::update(const std::vector<double>& positions,
                                  const std::vector<Pose>& T_fixed_roots) {
  assert(positions.size() == model_->variables().size());
  assert(T_fixed_roots.size() == model_->roots().size());
  posture_.positions = positions;
  posture_.T_fixed_roots = T_fixed_roots;
  std::vector<Pose>& link_poses = posture_.T_fixed_links;
  for (std::size_t i = 0; i < T_fixed_roots.size(); ++i) {
    const std::size_t link = model_->roots()[i];
    has_moved_[link] = !is_placed_ || !isSame(link_poses[link], T_fixed_roots[i]);
    link_poses[link] = T_fixed_roots[i];
  }
  for (std::size_t i = 0; i < stands_.size(); ++i) {
    const RobotJoint& joint = model_->joints()[i];
    const bool is_fixed = joint.motion == RobotJoint::Motion::kFixed;
    const bool is_moved =
        !is_fixed && stands_[i].moveTo(joint.multiplier * positions[joint.variable] + joint.offset,
                                       joint.axis, joint.motion == RobotJoint::Motion::kRotation);
    has_moved_[joint.child] = !is_placed_ || is_moved || has_moved_[joint.parent];
    if (!has_moved_[joint.child]) continue;
    Pose& T_fixed_child = link_poses[joint.child];
    T_fixed_child = link_poses[joint.parent] * joint.T_parent_joint;
    if (!is_fixed) stands_[i].apply(joint.axis, T_fixed_child);
  }
  const auto& shapes = model_->shapes();
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    if (!has_moved_[shapes[i].link]) continue;
    posture_.T_fixed_shapes[i] = link_poses[shapes[i].link] * shapes[i].T_link_shape;
  }
  is_placed_ = true;
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
                      const std::vector<Pose>& T_fixed_roots) {
  bool has_moved = !isSame(T_fixed_root_, T_fixed_roots[root_]);
  T_fixed_root_ = T_fixed_roots[root_];
  const Pose* T_fixed_parent = &T_fixed_root_;
  for (Step& step : steps_) {
    const double position = step.multiplier * positions[step.variable] + step.offset;
    has_moved = step.stand.moveTo(position, step.axis, step.turns) || has_moved;
    if (has_moved) {
      step.T_fixed_joint = *T_fixed_parent * step.T_parent_joint;
      step.stand.apply(step.axis, step.T_fixed_joint);
    }
    T_fixed_parent = &step.T_fixed_joint;
  }
  return *T_fixed_parent * T_last_link_;
}

}  // namespace tccm
