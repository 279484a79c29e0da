#pragma once

#include <optional>
#include <string>
#include <vector>

#include "config/parameter_table.h"
#include "gate/goal_path.h"
#include "gate/goal_rules.h"
#include "gate/permission_gate.h"

namespace tccm {

/// A motion along a goal's way that goes on only as long as it is permitted, and as fast. Once it
/// is over, however it ended, it never goes on by itself. Reads no clock; a step allocates nothing.
class GatedMotion {
 public:
  /// What tells the arm how fast to go.
  enum class Pace {
    kSetpoints,  ///< where the joints are to be next, in each cycle
    kPlans,      ///< all that is left, anew where the scale changes: plan() tells it
    kMeasured,   ///< something else does: how far it has come is told from where the joints are
  };
  struct Config {
    double lookahead_s = 0.04;
    double stop_duration_s = 0.0;
    double scale_rise_per_s = 4.0;
    double retime_s = 0.05;
    double dt_max_s = 0.05;
    double settle_s = 1.0;
    double deviation_max = 0.3;
    Pace pace = Pace::kSetpoints;

    void describe(ParameterTable& table);
  };
  enum class End {
    kNone,  ///< it goes on
    kReached,
    kNotPermitted,
    kTimeJumped,
    kOffPath,  ///< beyond a tolerance on the way
    kOffGoal,  ///< beyond one at the end
  };
  struct Step {
    End end = End::kNone;
    std::string text = {};  ///< why, in one line
    /// Where the joints are to be lookahead_s after now, and their speed then; none before the
    /// start and at an end.
    const GoalPath::Sample* setpoint = nullptr;
    /// What is left goes otherwise in time than was told last: rest() tells it.
    bool is_retimed = false;
    /// The arm is to go otherwise than its last plan(). Not where it is paced by setpoints.
    bool is_replanned = false;
  };

  explicit GatedMotion(const Config& config) : config_(config) {}

  /// Sets off at the way's start. @pre the goal is free, the arm is where the way begins, and the
  /// gate has no objection.
  void begin(const JudgedGoal& goal, const Instant& now, const PermissionGate& gate);
  /// It is over, for whatever reason.
  void forget() { path_.reset(); }
  [[nodiscard]] bool active() const { return path_.has_value(); }

  /// One cycle. @param positions, velocities where the joints are, in the way's order; velocities
  /// may be empty: not known. @pre active()
  [[nodiscard]] const Step& step(const Instant& now, const PermissionGate& gate,
                                 const std::vector<double>& positions,
                                 const std::vector<double>& velocities);
  /// What is left from now on, at the scale that is aimed at; counts as told.
  [[nodiscard]] JointTrajectory rest(const Instant& now);
  /// The same as the arm is to go it: the scale changes no faster than it may.
  [[nodiscard]] JointTrajectory plan() const;
  /// All of the way at full speed. @pre active()
  [[nodiscard]] const JointTrajectory& whole() const { return path_->way(); }

  /// Where the joints are to be now, and their speed. @pre active()
  [[nodiscard]] const GoalPath::Sample& desired() const { return desired_; }
  [[nodiscard]] double timeAlong() const { return time_s_; }  ///< [s]
  [[nodiscard]] double scale() const { return scale_; }       ///< of the speed, at present
  [[nodiscard]] double aim() const { return aim_; }           ///< the scale that it goes to
  /// Not before this.
  [[nodiscard]] Time start() const { return start_; }

 private:
  /// @return whether the scale that is aimed at is another one now.
  [[nodiscard]] bool aimAt(const Instant& now, double permitted_scale);
  [[nodiscard]] double fallDuration() const;  ///< [s]
  void advance(const Instant& now, const std::vector<double>& positions);
  /// How far the joints have come, from where they had.
  [[nodiscard]] double findTimeAlong(const std::vector<double>& positions);
  void findSetpoint();
  /// Where a joint is further from where it is to be than it ever may; empty where none is.
  [[nodiscard]] std::string astray(const std::vector<double>& positions) const;
  [[nodiscard]] const Step& finish(End end, std::string text);
  /// The first joint beyond a tolerance, in one line; empty where there is none.
  [[nodiscard]] std::string beyond(const std::vector<JointTolerance>& tolerances,
                                   const std::vector<double>& positions,
                                   const std::vector<double>& velocities) const;
  [[nodiscard]] const Step& settle(const Instant& now, const std::vector<double>& positions,
                                   const std::vector<double>& velocities);

  Config config_;
  std::optional<GoalPath> path_;  ///< while it is active
  GoalTolerances tolerances_;
  Time start_;
  Time last_;            ///< the cycle before
  double time_s_ = 0.0;  ///< along the path
  double scale_ = 0.0;
  double aim_ = 0.0;
  Time aimed_;                   ///< since when
  std::optional<Time> arrived_;  ///< when its end was reached in time
  Time told_;                    ///< when rest() was, from where, at what scale
  double told_time_s_ = 0.0;
  double told_scale_ = 1.0;
  GoalPath::Sample desired_, setpoint_, searched_;
  Step step_;
};

}  // namespace tccm
