#pragma once

#include <memory>
#include <vector>

#include "robot/robot_model.h"

namespace tccm {

/// Forward kinematics of the whole tree. Keeps its results between calls, so each thread needs its
/// own.
class Kinematics {
 public:
  explicit Kinematics(std::shared_ptr<const RobotModel> model);

  /// @param positions [rad] or [m], one for each of the model's variables, in their order.
  /// @param T_fixed_roots one for each of the model's roots, in their order.
  void update(const std::vector<double>& positions, const std::vector<Pose>& T_fixed_roots);

  /// T_fixed_link, one for each of the model's links.
  [[nodiscard]] const std::vector<Pose>& linkPoses() const { return link_poses_; }
  /// T_fixed_shape, one for each of the model's shapes.
  [[nodiscard]] const std::vector<Pose>& shapePoses() const { return shape_poses_; }

 private:
  std::shared_ptr<const RobotModel> model_;
  std::vector<Pose> link_poses_;
  std::vector<Pose> shape_poses_;
};

}  // namespace tccm
