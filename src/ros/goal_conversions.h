#pragma once

#include <control_msgs/FollowJointTrajectoryGoal.h>
#include <tccm_monitor/MotionPermission.h>
#include <trajectory_msgs/JointTrajectory.h>

#include <cstdint>

#include "gate/goal_rules.h"
#include "gate/permission_gate.h"

namespace tccm {

/// A trajectory without a stamp starts now. Joints' tolerances are left empty.
[[nodiscard]] TrajectoryGoal toGoal(const trajectory_msgs::JointTrajectory& message);
[[nodiscard]] TrajectoryGoal toGoal(const control_msgs::FollowJointTrajectoryGoal& message);

/// Its stamp stays empty: it starts when it is heard.
[[nodiscard]] trajectory_msgs::JointTrajectory toMessage(const JointTrajectory& trajectory);

/// @param heard reused: nothing is allocated after a while.
void fromMessage(const tccm_monitor::MotionPermission& message, HeardPermission& heard);

/// Of this process's clocks.
[[nodiscard]] Instant now();

/// That of control_msgs/FollowJointTrajectoryResult.
[[nodiscard]] std::int32_t errorCode(JudgedGoal::Fault fault);

}  // namespace tccm
