#pragma once

#include <cstddef>
#include <vector>

#include "tccm_monitor/robot_model.h"

namespace tccm {

/// What a link hangs on.
struct LinkMount {
  std::size_t root = 0;                 ///< index into the model's roots
  bool moves = false;                   ///< over a joint, against that root
  Pose T_root_link = Pose::Identity();  ///< where it does not move
};

/// One for each of the model's links.
[[nodiscard]] inline std::vector<LinkMount> linkMounts(const RobotModel& model) {
  std::vector<LinkMount> mounts(model.links().size());
  for (std::size_t i = 0; i < model.roots().size(); ++i) mounts[model.roots()[i]].root = i;
  for (const RobotJoint& joint : model.joints()) {  // parents first
    const LinkMount& parent = mounts[joint.parent];
    mounts[joint.child] = {parent.root, parent.moves || joint.motion != RobotJoint::Motion::kFixed,
                           parent.T_root_link * joint.T_parent_joint};
  }
  return mounts;
}

}  // namespace tccm
