#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "tccm_monitor/robot_model.h"

namespace tccm {

/// A way through joint space: straight between points at rising times. Keeps its memory when it is
/// cleared.
class JointPath {
 public:
  /// @param variables how many a point has.
  explicit JointPath(std::size_t variables) : variables_(variables) {}

  void clear();
  void reserve(std::size_t points);
  /// @param time_s not before that of the point before. @param positions [rad or m]
  void add(double time_s, const std::vector<double>& positions);

  [[nodiscard]] std::size_t size() const { return times_.size(); }
  [[nodiscard]] bool empty() const { return times_.empty(); }
  [[nodiscard]] double time(std::size_t point) const { return times_[point]; }
  [[nodiscard]] double begin() const { return times_.front(); }
  [[nodiscard]] double end() const { return times_.back(); }

  /// One for each variable [rad or m]. Valid until the path changes.
  [[nodiscard]] const double* positions(std::size_t point) const {
    return positions_.data() + point * variables_;
  }
  /// How far each variable travels from the path's begin to a point, there and back added up.
  [[nodiscard]] const double* travel(std::size_t point) const {
    return travel_.data() + point * variables_;
  }
  [[nodiscard]] std::size_t variables() const { return variables_; }

  /// The positions at an instant; beyond the ends those of the ends. @pre not empty
  void positionsAt(double time_s, std::vector<double>& positions) const;
  /// How far each variable travels, there and back added up, from the path's begin to an instant.
  /// @pre not empty
  void travelUntil(double time_s, std::vector<double>& travel) const;

 private:
  void interpolate(const std::vector<double>& rows, double time_s,
                   std::vector<double>& result) const;

  std::size_t variables_;
  std::vector<double> times_;
  std::vector<double> positions_;  ///< points by variables
  std::vector<double> travel_;     ///< likewise, since the first point
};

/// Empty, or in one line what is wrong with it: joints that are not the robot's to move, points
/// that are incomplete, not finite or beyond a limit, times that do not rise or are below 0.
/// @param measured where the robot is, one for each variable; may be empty.
[[nodiscard]] std::string defectOf(const JointTrajectory& trajectory, const RobotModel& model,
                                   const std::vector<double>& measured = {});

/// The one rule for positions that are asked about: empty, or what is wrong with one, as "is at 7
/// rad, beyond its limits of -3 and 3". @param measured where the joint is, if that is known: it
/// may be asked to go as far beyond its limit as it is.
[[nodiscard]] std::string defectOfPosition(const RobotModel& model, const std::string& joint,
                                           double position, std::optional<double> measured);

/// The variables that the trajectory's joints are, in the order of its names.
/// @pre defectOf() is empty
[[nodiscard]] std::vector<std::size_t> variablesOf(const JointTrajectory& trajectory,
                                                   const RobotModel& model);

/// The way as ros_controllers' JointTrajectoryController takes it: a straight line between points
/// without velocities, a cubic or quintic spline between such with velocities or accelerations; the
/// same on the way to a first point that is later than the start.
/// Splines are cut into straight pieces that stay within tolerance of them, 128 a stretch at most.
/// @param from where all of the model's variables are at the trajectory's start; those that the
/// trajectory does not name stay there. Rotations without limits take the short way to the first
/// point.
/// @param path is cleared before.
/// @param tolerance [rad or m]
/// @param velocities of all variables at the start [rad/s or m/s]; empty: at rest.
/// @pre defectOf() is empty
/// @return false where it would have more than 65,536 points: nothing can be done with it in time.
bool makePath(const JointTrajectory& trajectory, const RobotModel& model,
              const std::vector<double>& from, double tolerance, JointPath& path,
              const std::vector<double>& velocities = {});

}  // namespace tccm
