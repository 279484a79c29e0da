#pragma once

#include <string>
#include <vector>

#include "robot/joint_path.h"
#include "tccm_monitor/robot_model.h"

namespace tccm {

/// Empty, or in one line what is wrong with it: no joints or points, a joint that is named twice,
/// that the robot does not have, that moves no monitored link, that follows another or is fixed; a
/// point that lacks positions, or lies beyond a joint's limits; numbers that are none; times that
/// do not rise or are below 0.
[[nodiscard]] std::string defectOf(const JointTrajectory& trajectory, const RobotModel& model);

/// The variables that the trajectory's joints are, in the order of its names.
/// @pre defectOf() is empty
[[nodiscard]] std::vector<std::size_t> variablesOf(const JointTrajectory& trajectory,
                                                   const RobotModel& model);

/// The way as ros_controllers' JointTrajectoryController takes it: a straight line between points
/// without velocities, a cubic or quintic spline between such with velocities or accelerations; the
/// same on the way to a first point that is later than the start.
/// Splines are cut into straight pieces that stay within tolerance of them, 128 a stretch at most.
/// @param from where all of the model's variables are at the trajectory's start; those that the
/// trajectory does not name stay there. Where the first point's time is above 0, the way from there
/// to it comes first. Rotations without limits take the short way to the first point.
/// @param path is cleared before.
/// @param tolerance [rad or m]
/// @param velocities of all variables at the start [rad/s or m/s]; empty: at rest.
/// @pre defectOf() is empty
void makePath(const JointTrajectory& trajectory, const RobotModel& model,
              const std::vector<double>& from, double tolerance, JointPath& path,
              const std::vector<double>& velocities = {});

}  // namespace tccm
