#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tccm_monitor/robot_model.h"
#include "tccm_monitor/time.h"

namespace tccm {

/// How far a joint may be from where its trajectory has it; 0: as far as it likes.
struct JointTolerance {
  double position = 0.0;      ///< [rad or m]
  double velocity = 0.0;      ///< per second
  double acceleration = 0.0;  ///< per second squared
};

/// What a goal asks of the joints, each for one of the controller's joints.
struct GoalTolerances {
  std::vector<JointTolerance> path;  ///< on the way
  std::vector<JointTolerance> end;   ///< once it is over
  double end_time_s = 0.0;           ///< that they may take longer to come so near
};

/// A goal as a client sends it: control_msgs/FollowJointTrajectoryGoal.
struct TrajectoryGoal {
  struct Named {
    std::string joint;
    JointTolerance tolerance;  ///< 0: the controller's own; below 0: none
  };

  JointTrajectory trajectory;
  std::optional<Time> start;  ///< nothing: now
  std::vector<Named> path, end;
  double end_time_s = 0.0;  ///< the same
};

/// What became of it.
struct JudgedGoal {
  enum class Fault { kNone, kInvalidGoal, kInvalidJoints };

  Fault fault = Fault::kNone;
  std::string text = {};  ///< what is wrong, in one line
  /// From where the joints are at 0 s, all of the controller's joints in its order; no points: the
  /// arm is to be held.
  JointTrajectory way = {};
  Time start = {};  ///< of the way; not before now
  GoalTolerances tolerances = {};
};

/// Which goals an arm's controller takes and what it makes of them. The rules are those of
/// ros_controllers' JointTrajectoryController: names in any order, parts of the joints where these
/// are allowed, points that are over left out, the short way to where continuous joints are to go,
/// tolerances by name. What it takes that would fail later on, as numbers that are not finite, is
/// refused.
class GoalRules {
 public:
  struct Config {
    std::vector<std::string> joints;
    std::vector<bool> turn_freely;  ///< one for each joint: continuous, without limits
    bool allow_partial_joints_goal = false;
    GoalTolerances tolerances;  ///< the controller's own
  };

  /// @throws ConfigError where joints are none or named twice, or a list is of another length.
  explicit GoalRules(Config config);

  [[nodiscard]] const std::vector<std::string>& joints() const { return config_.joints; }
  /// @param positions, velocities where the joints are, in the controller's order; velocities may
  /// be empty: at rest.
  [[nodiscard]] JudgedGoal judge(const TrajectoryGoal& goal, Time now,
                                 const std::vector<double>& positions,
                                 const std::vector<double>& velocities) const;

 private:
  /// For each of the goal's joints its place among the controller's.
  [[nodiscard]] std::string findPlaces(const JointTrajectory& trajectory,
                                       std::vector<std::size_t>& places) const;
  [[nodiscard]] GoalTolerances tolerancesOf(const TrajectoryGoal& goal) const;

  Config config_;
};

}  // namespace tccm
