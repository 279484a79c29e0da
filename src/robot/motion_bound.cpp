#include "robot/motion_bound.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace tccm {
namespace {

/// The least and the largest position of a slide within its limits, or those of what it mimics.
std::pair<double, double> rangeOf(const RobotModel& model, const RobotJoint& joint) {
  const JointVariable& variable = model.variables()[joint.variable];
  if (!variable.lower || !variable.upper) return {0.0, 0.0};
  return std::minmax({joint.multiplier * *variable.lower + joint.offset,
                      joint.multiplier * *variable.upper + joint.offset});
}

bool isSlide(const RobotJoint& joint) { return joint.motion == RobotJoint::Motion::kTranslation; }

}  // namespace

MotionBound::MotionBound(const RobotModel& model, const std::vector<std::size_t>& shapes,
                         const std::vector<double>& radii_m)
    : variables_(model.variables().size()), within_limits_(shapes.size() * variables_, 0.0) {
  for (const RobotJoint& joint : model.joints()) {
    if (!isSlide(joint)) continue;
    const auto [low, high] = rangeOf(model, joint);
    slides_.push_back({joint.variable, joint.multiplier, joint.offset, low, high});
  }
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    addArms(model, i, model.shapes()[shapes[i]], radii_m[i]);
  }
  lever_arms_ = within_limits_;
}

std::size_t MotionBound::slideOf(const RobotModel& model, const RobotJoint& joint) const {
  std::size_t slide = 0;
  for (const RobotJoint& other : model.joints()) {
    if (&other == &joint) break;
    if (isSlide(other)) ++slide;
  }
  return slide;
}

/// From the link up to the root: a ball in the frame reached that the shape never leaves, whatever
/// the joints passed do.
void MotionBound::addArms(const RobotModel& model, std::size_t i, const LinkShape& shape,
                          double radius_m) {
  std::vector<const RobotJoint*> joint_to(model.links().size(), nullptr);
  for (const RobotJoint& joint : model.joints()) joint_to[joint.child] = &joint;
  std::vector<std::size_t> passed;  // slides
  Vector3 centre = shape.T_link_shape.translation();
  for (const RobotJoint* joint = joint_to[shape.link]; joint; joint = joint_to[joint->parent]) {
    const std::size_t arm = i * variables_ + joint->variable;
    const double multiplier = std::abs(joint->multiplier);
    if (joint->motion == RobotJoint::Motion::kRotation) {
      const Vector3 on_axis = joint->axis.dot(centre) * joint->axis;
      radius_m += (centre - on_axis).norm();
      within_limits_[arm] += multiplier * radius_m;
      for (const std::size_t slide : passed) lengthenings_.push_back({arm, slide, multiplier});
      centre = on_axis;
    } else if (isSlide(*joint)) {
      passed.push_back(slideOf(model, *joint));
      const Slide& slide = slides_[passed.back()];
      radius_m += 0.5 * (slide.high - slide.low);
      within_limits_[arm] += multiplier;
      centre += 0.5 * (slide.low + slide.high) * joint->axis;
    }
    centre = joint->T_parent_joint * centre;
  }
}

double MotionBound::beyond(const Slide& slide, const JointPath& way) {
  double furthest = 0.0;
  for (std::size_t point = 0; point < way.size(); ++point) {
    const double position = slide.multiplier * way.positions(point)[slide.variable] + slide.offset;
    furthest = std::max({furthest, slide.low - position, position - slide.high});
  }
  return furthest;
}

void MotionBound::cover(const JointPath& way) {
  bool is_other = false;
  for (Slide& slide : slides_) {
    const double beyond_m = beyond(slide, way);
    is_other = is_other || beyond_m != slide.beyond_m;
    slide.beyond_m = beyond_m;
  }
  if (!is_other) return;
  lever_arms_ = within_limits_;
  for (const Lengthening& longer : lengthenings_) {
    lever_arms_[longer.arm] += longer.share * slides_[longer.slide].beyond_m;
  }
}

double MotionBound::displacement(std::size_t shape, const std::vector<double>& travel) const {
  const double* arms = leverArms(shape);
  double sum = 0.0;
  for (std::size_t v = 0; v < variables_; ++v) sum += arms[v] * travel[v];
  return sum;
}

}  // namespace tccm
