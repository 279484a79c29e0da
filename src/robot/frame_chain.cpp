#include "robot/frame_chain.h"

#include <algorithm>

namespace tccm {

FrameChain::FrameChain(const JointTree& tree, std::size_t link) : root_(link) {
  const auto above = [&tree](std::size_t child) {
    return std::find_if(tree.joints.begin(), tree.joints.end(),
                        [child](const RobotJoint& joint) { return joint.child == child; });
  };
  for (auto joint = above(link); joint != tree.joints.end(); joint = above(root_)) {
    joints_.push_back(*joint);
    root_ = joint->parent;
    if (joint->motion == RobotJoint::Motion::kFixed) continue;
    const bool is_known =
        std::find(variables_.begin(), variables_.end(), joint->variable) != variables_.end();
    if (!is_known) variables_.push_back(joint->variable);
  }
  std::reverse(joints_.begin(), joints_.end());
}

Pose FrameChain::at(const std::vector<double>& positions) const {
  Pose T_root_link = Pose::Identity();
  for (const RobotJoint& joint : joints_) {
    T_root_link = T_root_link * joint.T_parent_joint;
    if (joint.motion == RobotJoint::Motion::kFixed) continue;
    const double position = joint.multiplier * positions[joint.variable] + joint.offset;
    if (joint.motion == RobotJoint::Motion::kRotation) {
      T_root_link.rotate(Eigen::AngleAxisd(position, joint.axis));
    } else {
      T_root_link.translate(position * joint.axis);
    }
  }
  return T_root_link;
}

Displacement worstDisplacement(const Pose& from, const Pose& to,
                               const std::vector<Vector3>& points) {
  const Eigen::Matrix3d turned = to.linear() - from.linear();
  const Vector3 moved = to.translation() - from.translation();
  Displacement worst;
  for (const Vector3& p_link : points) {
    const Vector3 offset = turned * p_link + moved;
    if (offset.norm() > worst.distance_m) worst = {offset.norm(), offset};
  }
  return worst;
}

std::vector<Vector3> farPointsOf(const RobotModel& model, std::size_t link) {
  std::vector<Vector3> points;
  for (const LinkShape& shape : model.shapes()) {
    if (shape.link != link || !shape.object.empty()) continue;
    const UprightBox box = bounds(shape.shape, Pose::Identity());
    for (int corner = 0; corner < 8; ++corner) {
      points.push_back(shape.T_link_shape *
                       box.corner(static_cast<UprightBox::CornerType>(corner)));
    }
  }
  return points;
}

}  // namespace tccm
