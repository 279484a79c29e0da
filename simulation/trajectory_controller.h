#pragma once

#include <optional>
#include <string>
#include <vector>

#include "gate/goal_rules.h"
#include "robot/joint_spline.h"
#include "tccm_monitor/time.h"

namespace tccm::simulation {

/// Where an arm's joints are to be, as ros_controllers' JointTrajectoryController has it: for
/// trajectories from its topic and for its action's goals, of which one at most is active. What is
/// new takes the place of what was before, from where the joints are to be by then; joints that it
/// leaves out go on. A goal that is aborted leaves its trajectory under way, as there.
class TrajectoryController {
 public:
  struct Config {
    GoalRules::Config rules;
    double stop_duration_s = 0.0;  ///< `stop_trajectory_duration`; 0: held at once where they are

    /// @throws ConfigError
    void validate() const;
  };
  /// How a goal ended by itself.
  struct GoalEnd {
    enum class Kind { kReached, kOffPath, kOffGoal };
    Kind kind = Kind::kReached;
    std::string text = {};  ///< which joint is off, and how far; empty where it is reached
  };
  using JointState = JointSpline::State;

  /// @param positions of its joints, which are at rest. @throws ConfigError
  TrajectoryController(const Config& config, std::vector<double> positions, Time now);

  /// A trajectory from the topic; without points: stop. It preempts the active goal. @return empty,
  /// or in one line why it is not taken: what was before goes on then. Its tolerances do not count.
  [[nodiscard]] std::string command(const TrajectoryGoal& command);
  /// Active from now on, unless it has a fault: then what was before goes on. Without points: it is
  /// reached when the joints have stopped.
  [[nodiscard]] JudgedGoal accept(const TrajectoryGoal& goal);
  /// Of the active goal: the joints stop.
  void cancel();

  /// One cycle. @param now not before that of earlier calls. @param positions, velocities where the
  /// joints are, in their order.
  void step(Time now, const std::vector<double>& positions, const std::vector<double>& velocities);

  [[nodiscard]] const std::vector<std::string>& joints() const { return rules_.joints(); }
  [[nodiscard]] const std::vector<JointState>& desired() const { return desired_; }
  /// As of the last step.
  [[nodiscard]] const std::vector<double>& positions() const { return positions_; }
  [[nodiscard]] const std::vector<double>& velocities() const { return velocities_; }
  /// desired() without them, the short way where a joint turns freely.
  [[nodiscard]] double positionError(std::size_t joint) const;
  [[nodiscard]] double velocityError(std::size_t joint) const;

  [[nodiscard]] bool hasGoal() const { return tolerances_.has_value(); }
  /// That of a goal which was active before the last step; once.
  [[nodiscard]] std::optional<GoalEnd> takeEnd();
  /// A trajectory is under way, or will be, and no stop.
  [[nodiscard]] bool follows() const;
  /// When it was told to stop; nothing once it has a new trajectory.
  [[nodiscard]] std::optional<Time> stoppingSince() const { return stopping_since_; }

 private:
  struct Segment {
    Time start;
    double duration_s;  ///< beyond it the joint rests where it ends
    JointSpline spline;
    bool of_goal = false;  ///< of the active one

    [[nodiscard]] double since(Time now) const { return toSeconds(now - start); }
    [[nodiscard]] bool over(Time now) const { return since(now) > duration_s; }
    [[nodiscard]] JointState at(Time now) const;
  };
  /// Of one joint, rising in their starts; the last of those that have begun counts.
  using Track = std::vector<Segment>;

  [[nodiscard]] static const Segment& active(const Track& track, Time now);
  /// Also where to is in the future. @pre to is not before now_
  [[nodiscard]] std::vector<JointState> desiredAt(Time to) const;
  [[nodiscard]] JudgedGoal take(const TrajectoryGoal& goal, bool as_goal);
  void follow(const JudgedGoal& judged, const std::vector<std::string>& names, bool as_goal);
  void stop(bool as_goal);
  void forgetGoal();
  void watchGoal();
  [[nodiscard]] bool keeps(std::size_t joint, const JointTolerance& tolerance) const;
  void endGoal(GoalEnd::Kind kind, std::string text);

  Config config_;
  GoalRules rules_;
  std::vector<Track> tracks_;
  std::vector<JointState> desired_;
  std::vector<double> positions_;             ///< measured
  std::vector<double> velocities_;            ///< measured
  std::optional<GoalTolerances> tolerances_;  ///< of the active goal
  std::optional<GoalEnd> end_;
  std::optional<Time> stopping_since_;
  Time now_;
};

}  // namespace tccm::simulation
