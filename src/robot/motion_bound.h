#pragma once

#include <cstddef>
#include <vector>

#include "robot/joint_path.h"
#include "tccm_monitor/robot_model.h"

namespace tccm {

/// How far any point of a primitive can move at most when the joints travel by given amounts: the
/// sum over the joints of travel times lever arm, whatever the pose (as in Schwarzer, Saha,
/// Latombe: Adaptive dynamic collision checking, IEEE T-RO 2005).
///
/// A slide makes the arms of the joints before it longer. It is taken to stay within its limits, or
/// at zero where it has none, until a way is covered that leads further.
class MotionBound {
 public:
  /// @param shapes indices into the model's shapes. @param radii_m of each the radius around its
  /// frame's origin that contains it, with whatever it grows by.
  MotionBound(const RobotModel& model, const std::vector<std::size_t>& shapes,
              const std::vector<double>& radii_m);

  /// From now on the bound holds along this way, and between any positions that lie within limits.
  void cover(const JointPath& way);

  /// @param shape index into the shapes handed over. @param travel of each of the model's variables
  /// [rad or m], not negative, along the way that is covered.
  /// @return [m]
  [[nodiscard]] double displacement(std::size_t shape, const std::vector<double>& travel) const;
  /// By which a shape moves at most for each unit that a variable travels, one for each variable.
  [[nodiscard]] const double* leverArms(std::size_t shape) const {
    return lever_arms_.data() + shape * variables_;
  }

 private:
  /// A joint that slides.
  struct Slide {
    std::size_t variable;
    double multiplier, offset;
    double low, high;       ///< where it is taken to stay [m]
    double beyond_m = 0.0;  ///< by which the way that is covered leads further
  };
  /// A lever arm that is the longer the further out a slide is.
  struct Lengthening {
    std::size_t arm;    ///< index into the lever arms
    std::size_t slide;  ///< index into the slides
    double share;       ///< of what the slide is beyond
  };
  void addArms(const RobotModel& model, std::size_t i, const LinkShape& shape, double radius_m);
  /// The index of a joint among the slides.
  [[nodiscard]] std::size_t slideOf(const RobotModel& model, const RobotJoint& joint) const;
  [[nodiscard]] static double beyond(const Slide& slide, const JointPath& way);

  std::size_t variables_;
  std::vector<double> within_limits_;  ///< lever arms, shapes by variables
  std::vector<double> lever_arms_;     ///< likewise, on the way that is covered
  std::vector<Slide> slides_;          ///< in the order of the model's joints
  std::vector<Lengthening> lengthenings_;
};

}  // namespace tccm
