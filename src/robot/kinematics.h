#pragma once

#include <memory>
#include <vector>

#include "tccm_monitor/robot_model.h"

namespace tccm {

/// A robot at one pose: computed once, and handed on to whoever asks.
struct Posture {
  std::vector<double> positions;     ///< [rad] or [m], one for each of the model's variables
  std::vector<Pose> T_fixed_roots;   ///< one for each of the model's roots
  std::vector<Pose> T_fixed_links;   ///< one for each of the model's links
  std::vector<Pose> T_fixed_shapes;  ///< one for each of the model's shapes
};

/// Forward kinematics of the whole tree. Keeps its result between calls, so each thread needs its
/// own.
class Kinematics {
 public:
  explicit Kinematics(std::shared_ptr<const RobotModel> model);

  /// @param positions [rad] or [m], one for each of the model's variables, in their order.
  /// @param T_fixed_roots one for each of the model's roots, in their order.
  /// The result is valid until the next call.
  const Posture& update(const std::vector<double>& positions,
                        const std::vector<Pose>& T_fixed_roots);

  [[nodiscard]] const Posture& posture() const { return posture_; }
  [[nodiscard]] const std::vector<Pose>& linkPoses() const { return posture_.T_fixed_links; }
  [[nodiscard]] const std::vector<Pose>& shapePoses() const { return posture_.T_fixed_shapes; }

 private:
  std::shared_ptr<const RobotModel> model_;
  Posture posture_;
};

}  // namespace tccm
