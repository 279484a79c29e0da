#pragma once

#include <cstddef>
#include <vector>

#include "robot/joint_spline.h"
#include "tccm_monitor/robot_model.h"

namespace tccm {

/// The way of a goal through joint space, as ros_controllers' JointTrajectoryController goes it.
class GoalPath {
 public:
  /// Of all joints.
  struct Sample {
    std::vector<double> positions, velocities;  ///< [rad or m], per second
  };

  /// @param way two points or more, the first at 0 s, where the joints are; complete, and its times
  /// rise, as GoalRules makes it.
  explicit GoalPath(JointTrajectory way);

  [[nodiscard]] const std::vector<std::string>& names() const { return way_.names; }
  [[nodiscard]] double duration() const { return way_.points.back().time_s; }  ///< [s]

  /// At a time from the start [s]; beyond the end the last point, at rest. Allocates nothing where
  /// the sample was used before.
  void at(double time_s, Sample& sample) const;
  /// What is left from a time on at that scale of the speed; begins at 0 s.
  [[nodiscard]] JointTrajectory rest(double time_s, double scale) const;
  /// The whole, at full speed.
  [[nodiscard]] const JointTrajectory& way() const { return way_; }

 private:
  /// The stretch that a time lies in, counted from 0. @pre time_s < duration()
  [[nodiscard]] std::size_t stretchAt(double time_s) const;
  [[nodiscard]] const JointSpline& spline(std::size_t stretch, std::size_t joint) const {
    return splines_[stretch * way_.names.size() + joint];
  }

  JointTrajectory way_;
  std::vector<JointSpline> splines_;  ///< stretches by joints
};

}  // namespace tccm
