#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "simulation/trajectory_controller.h"

namespace tccm::simulation::driven {

using Kind = TrajectoryController::GoalEnd::Kind;
using Fault = JudgedGoal::Fault;
using Values = std::vector<double>;
using Point = JointTrajectory::Point;

constexpr Duration kStep = std::chrono::milliseconds(1);
inline const Time kStart{std::chrono::seconds(1000)};
inline const std::vector<std::string> kJoints = {"a", "b", "c"};

inline TrajectoryController::Config threeJoints() {
  TrajectoryController::Config config;
  config.rules.joints = kJoints;
  config.rules.tolerances.end.assign(3, {0.0, 0.01, 0.0});
  config.stop_duration_s = 0.4;
  return config;
}

inline Point point(double time_s, const Values& positions, const Values& velocities = {},
                   const Values& accelerations = {}) {
  return {time_s, positions, velocities, accelerations};
}

inline TrajectoryGoal goalOf(const std::vector<Point>& points,
                             const std::vector<std::string>& names = kJoints) {
  TrajectoryGoal goal;
  goal.trajectory = {names, points};
  return goal;
}

/// A controller, and joints that are where it had them a step ago, or aside.
class Driven {
 public:
  explicit Driven(const TrajectoryController::Config& config = threeJoints(),
                  const Values& positions = {0.1, 0.2, 0.3})
      : controller(config, positions, kStart), positions_(positions), velocities_(3, 0.0) {}

  /// @return how a goal ended meanwhile.
  std::optional<TrajectoryController::GoalEnd> run(double seconds) {
    std::optional<TrajectoryController::GoalEnd> end;
    const Time until = now + fromSeconds(seconds);
    while (now < until) {
      now += kStep;
      Values positions = positions_;
      for (std::size_t j = 0; j < 3; ++j) positions[j] += aside[j];
      controller.step(now, positions, velocities_);
      for (std::size_t j = 0; j < 3; ++j) {
        positions_[j] = controller.desired()[j].position;
        velocities_[j] = controller.desired()[j].velocity + fast[j];
      }
      if (auto its = controller.takeEnd()) end = its;
    }
    return end;
  }
  [[nodiscard]] double position(std::size_t j) const { return controller.desired()[j].position; }
  [[nodiscard]] double velocity(std::size_t j) const { return controller.desired()[j].velocity; }
  [[nodiscard]] double elapsed() const { return toSeconds(now - kStart); }

  TrajectoryController controller;
  Time now = kStart;
  Values aside = {0.0, 0.0, 0.0};  ///< where the joints are instead
  Values fast = {0.0, 0.0, 0.0};   ///< and how much faster

 private:
  Values positions_, velocities_;
};

}  // namespace tccm::simulation::driven
