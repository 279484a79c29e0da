#include "tccm_monitor/robot/motion_bound.h"

#include <algorithm>
#include <cmath>

namespace tccm {
namespace {

constexpr double kTravelUnlimited = 2.0;  // [m] of a translation without limits, or beyond them

/// How far a joint's translation can take its child from where it is at position 0.
double translationMax(const RobotModel& model, const RobotJoint& joint) {
  if (joint.motion != RobotJoint::Motion::kTranslation) return 0.0;
  const JointVariable& variable = model.variables()[joint.variable];
  if (!variable.lower || !variable.upper) return kTravelUnlimited;
  const double at_lower = joint.multiplier * *variable.lower + joint.offset;
  const double at_upper = joint.multiplier * *variable.upper + joint.offset;
  return std::max(std::abs(at_lower), std::abs(at_upper));
}

/// Distance from the joint's axis to the point; both in the child's frame.
double distanceToAxis(const RobotJoint& joint, const Vector3& p_child) {
  return joint.axis.cross(p_child).norm();
}

}  // namespace

MotionBound::MotionBound(const RobotModel& model, const std::vector<std::size_t>& shapes,
                         const std::vector<double>& radii_m)
    : variables_(model.variables().size()), lever_arms_(shapes.size() * variables_, 0.0) {
  std::vector<const RobotJoint*> joint_to(model.links().size(), nullptr);
  for (const RobotJoint& joint : model.joints()) joint_to[joint.child] = &joint;
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    const LinkShape& shape = model.shapes()[shapes[i]];
    // From the link up to the root: where the shape's middle is in the link reached, as long as
    // only fixed joints were passed; beyond them how far from the link's origin it can be.
    Vector3 p_link = shape.T_link_shape.translation();
    bool is_fixed = true;
    double reach = p_link.norm();
    for (const RobotJoint* joint = joint_to[shape.link]; joint; joint = joint_to[joint->parent]) {
      double* arm = joint->motion == RobotJoint::Motion::kFixed
                        ? nullptr
                        : &lever_arms_[i * variables_ + joint->variable];
      if (arm && joint->motion == RobotJoint::Motion::kRotation) {
        const double lever = is_fixed ? distanceToAxis(*joint, p_link) : reach;
        *arm += std::abs(joint->multiplier) * (lever + radii_m[i]);
      } else if (arm) {
        *arm += std::abs(joint->multiplier);
      }
      is_fixed = is_fixed && !arm;
      if (is_fixed) {
        p_link = joint->T_parent_joint * p_link;
        reach = p_link.norm();
      } else {
        reach += joint->T_parent_joint.translation().norm() + translationMax(model, *joint);
      }
    }
  }
}

double MotionBound::displacement(std::size_t shape, const std::vector<double>& travel) const {
  const double* arms = &lever_arms_[shape * variables_];
  double sum = 0.0;
  for (std::size_t v = 0; v < variables_; ++v) sum += arms[v] * travel[v];
  return sum;
}

}  // namespace tccm
