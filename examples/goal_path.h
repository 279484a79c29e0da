#pragma once

#include <trajectory_msgs/JointTrajectory.h>

#include <map>
#include <string>
#include <vector>

namespace tccm::example {

/// A joint trajectory as a way through joint space, from where the joints are: cubic between points
/// where all of them state velocities, straight otherwise. Accelerations do not count.
class GoalPath {
 public:
  /// @param trajectory where its first point's time is 0, the joints have to be there; where it is
  /// above 0, they go there in that time.
  /// @param positions of the joints now, by name [rad] or [m]; others may be among them.
  /// @param tolerance between positions and a first point at time 0 [rad] or [m].
  /// @throws std::invalid_argument saying in one line why the trajectory cannot be followed.
  GoalPath(const trajectory_msgs::JointTrajectory& trajectory,
           const std::map<std::string, double>& positions, double tolerance);

  /// Whether the joints are at the path's first point.
  [[nodiscard]] bool startsAt(const std::map<std::string, double>& positions,
                              double tolerance) const;
  [[nodiscard]] double duration() const { return points_.back().time_from_start.toSec(); }  ///< [s]

  /// Position and velocity at a time from the start [s]; beyond the end the last point, at rest.
  [[nodiscard]] trajectory_msgs::JointTrajectoryPoint at(double time) const;

  /// Position and velocity at a time, to be reached after a delay [s].
  /// @param scale of the speed: velocities are multiplied by it.
  [[nodiscard]] trajectory_msgs::JointTrajectory setpoint(double time, double scale,
                                                          double delay) const;

  /// What is left from a time on, at that scale of the speed; begins at time 0.
  [[nodiscard]] trajectory_msgs::JointTrajectory rest(double time, double scale) const;
  [[nodiscard]] trajectory_msgs::JointTrajectory whole() const { return rest(0.0, 1.0); }

 private:
  /// Positions now, as a first point at time 0.
  void addStart(const std::map<std::string, double>& positions);
  void keepVelocitiesOnlyIfAllHaveThem();

  std::vector<std::string> names_;
  std::vector<trajectory_msgs::JointTrajectoryPoint> points_;  ///< the first at time 0
};

}  // namespace tccm::example
