#pragma once

#include <trajectory_msgs/JointTrajectory.h>

#include <optional>
#include <string>

#include "goal_path.h"
#include "permission_gate.h"

namespace tccm::example {

/// @throws std::invalid_argument naming the key, unless value is finite and inside.
void requireInRange(const std::string& key, double value, double lowest, double highest);

/// A motion that goes on only as long as it is permitted, and once held never goes on by itself.
/// Reads no clock and knows no topic: what is to be published comes back from each call.
class GuardedMotion {
 public:
  struct Config {
    double lookahead_s = 0.04;        ///< setpoints are to be reached so much later
    double scale_change_per_s = 4.0;  ///< how fast the scale of the speed may rise and fall
    double retime_s = 0.05;  ///< the commanded trajectory is published anew when it is off by this
    double dt_max_s = 0.05;  ///< a cycle that comes later does not catch up

    /// @throws std::invalid_argument naming the parameter.
    void validate() const;
  };
  enum class State {
    kIdle,      ///< no goal yet, or the last one was reached
    kChecking,  ///< check_trajectory is being asked
    kMoving,
    kHeld,     ///< the motion was cancelled
    kRefused,  ///< the goal was never begun
  };
  /// An empty trajectory cancels.
  struct Output {
    std::optional<trajectory_msgs::JointTrajectory> command;     ///< for the arm's controller
    std::optional<trajectory_msgs::JointTrajectory> trajectory;  ///< for the monitor
  };

  /// @throws std::invalid_argument
  explicit GuardedMotion(const Config& config);

  [[nodiscard]] Output hear(const tccm_monitor::MotionPermission& permission, const Instant& now);
  /// To be called in each cycle.
  [[nodiscard]] Output step(const Instant& now);
  /// The operator's own stop; nothing where nothing moves or is about to.
  [[nodiscard]] Output cancel();

  /// A goal has come and is to be checked. @pre not busy()
  void beginCheck();
  /// The goal is not free, or cannot be followed. @pre state() is kChecking
  void refuse(const std::string& reason);
  /// The goal is free: sets off where that is permitted. @pre state() is kChecking
  [[nodiscard]] Output start(GoalPath path, const Instant& now);

  [[nodiscard]] State state() const { return state_; }
  [[nodiscard]] bool busy() const { return state_ == State::kMoving || state_ == State::kChecking; }
  /// "MOVING", "HELD: not permitted: ...": one line for people and programs.
  [[nodiscard]] std::string stateText() const;

 private:
  void enter(State state, const std::string& reason);
  [[nodiscard]] Output hold(const std::string& reason);
  [[nodiscard]] Output holdUnlessPermitted(const Instant& now);
  void advance(const Instant& now);
  [[nodiscard]] bool trajectoryIsOff(const ros::Time& now) const;
  [[nodiscard]] trajectory_msgs::JointTrajectory announce(const ros::Time& now);
  [[nodiscard]] trajectory_msgs::JointTrajectory nothing() const;

  Config config_;
  PermissionGate gate_;
  State state_ = State::kIdle;
  std::string reason_;
  std::optional<GoalPath> path_;     ///< only while moving
  std::vector<std::string> joints_;  ///< that were moved last
  double time_ = 0.0;                ///< along the path [s]
  double scale_ = 0.0;               ///< of the speed
  ros::Time last_;                   ///< the cycle before
  ros::Time announced_;  ///< when the trajectory was published, from where, at what scale
  double announced_time_ = 0.0;
  double announced_scale_ = 1.0;
};

}  // namespace tccm::example
