#include "robot/motion_bound.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace tccm {
namespace {

constexpr double kTravelUnlimited = 2.0;  // [m] of a translation without limits, or beyond them

/// The least and the largest position of a translation.
std::pair<double, double> rangeOf(const RobotModel& model, const RobotJoint& joint) {
  const JointVariable& variable = model.variables()[joint.variable];
  if (!variable.lower || !variable.upper) return {-kTravelUnlimited, kTravelUnlimited};
  return std::minmax({joint.multiplier * *variable.lower + joint.offset,
                      joint.multiplier * *variable.upper + joint.offset});
}

}  // namespace

MotionBound::MotionBound(const RobotModel& model, const std::vector<std::size_t>& shapes,
                         const std::vector<double>& radii_m)
    : variables_(model.variables().size()), lever_arms_(shapes.size() * variables_, 0.0) {
  std::vector<const RobotJoint*> joint_to(model.links().size(), nullptr);
  for (const RobotJoint& joint : model.joints()) joint_to[joint.child] = &joint;
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    const LinkShape& shape = model.shapes()[shapes[i]];
    // From the link up to the root: a ball in the frame reached that the shape never leaves,
    // whatever the joints passed do.
    Vector3 centre = shape.T_link_shape.translation();
    double radius = radii_m[i];
    for (const RobotJoint* joint = joint_to[shape.link]; joint; joint = joint_to[joint->parent]) {
      const std::size_t arm = i * variables_ + joint->variable;
      if (joint->motion == RobotJoint::Motion::kRotation) {
        const Vector3 on_axis = joint->axis.dot(centre) * joint->axis;
        radius += (centre - on_axis).norm();
        lever_arms_[arm] += std::abs(joint->multiplier) * radius;
        centre = on_axis;
      } else if (joint->motion == RobotJoint::Motion::kTranslation) {
        const auto [low, high] = rangeOf(model, *joint);
        radius += 0.5 * (high - low);
        lever_arms_[arm] += std::abs(joint->multiplier);
        centre += 0.5 * (low + high) * joint->axis;
      }
      centre = joint->T_parent_joint * centre;
    }
  }
}

double MotionBound::displacement(std::size_t shape, const std::vector<double>& travel) const {
  const double* arms = lever_arms_.data() + shape * variables_;
  double sum = 0.0;
  for (std::size_t v = 0; v < variables_; ++v) sum += arms[v] * travel[v];
  return sum;
}

}  // namespace tccm
