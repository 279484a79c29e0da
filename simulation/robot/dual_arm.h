#pragma once

#include <memory>
#include <string>
#include <vector>

#include "tccm_monitor/robot_model.h"

namespace tccm::simulation {

/// The text of dual_arm.urdf, compiled in.
[[nodiscard]] const std::string& dualArmUrdf();

/// Links of the arms whose cylinders are capsules.
[[nodiscard]] std::vector<std::string> dualArmCapsuleLinks();

[[nodiscard]] std::shared_ptr<const RobotModel> dualArm();

/// Index of the variable that moves the joint. @throws std::out_of_range naming the joint.
[[nodiscard]] std::size_t variableIndex(const RobotModel& model, const std::string& joint);
/// @throws std::out_of_range naming the link.
[[nodiscard]] std::size_t linkIndex(const RobotModel& model, const std::string& link);

/// Where the laser's origin is at a tilt, the head ahead, in base_link.
[[nodiscard]] Vector3 laserOrigin(const std::shared_ptr<const RobotModel>& model, double tilt_rad);

}  // namespace tccm::simulation
