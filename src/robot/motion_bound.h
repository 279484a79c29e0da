#pragma once

#include <cstddef>
#include <vector>

#include "tccm_monitor/robot_model.h"

namespace tccm {

/// How far any point of a primitive can move at most when the joints travel by given amounts: the
/// sum over the joints of travel times lever arm, whatever the pose (as in Schwarzer, Saha,
/// Latombe: Adaptive dynamic collision checking, IEEE T-RO 2005).
class MotionBound {
 public:
  /// @param shapes indices into the model's shapes. @param radii_m of each the radius around its
  /// frame's origin that contains it, with whatever it grows by.
  MotionBound(const RobotModel& model, const std::vector<std::size_t>& shapes,
              const std::vector<double>& radii_m);

  /// @param shape index into the shapes handed over. @param travel of each of the model's variables
  /// [rad or m], not negative.
  /// @return [m]
  [[nodiscard]] double displacement(std::size_t shape, const std::vector<double>& travel) const;
  /// Metres a shape moves by at most for each unit of a variable's travel; 0 where it does not move
  /// it.
  [[nodiscard]] double leverArm(std::size_t shape, std::size_t variable) const {
    return lever_arms_[shape * variables_ + variable];
  }

 private:
  std::size_t variables_;
  std::vector<double> lever_arms_;  ///< shapes by variables
};

}  // namespace tccm
