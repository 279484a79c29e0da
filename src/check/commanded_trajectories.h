#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "config/parameter_table.h"
#include "robot/joint_path.h"
#include "robot/joint_states.h"
#include "tccm_monitor/robot_model.h"
#include "tccm_monitor/time.h"

namespace tccm {

/// Where the robot goes until the horizon.
struct Ways {
  JointPath measured;   ///< where its velocities lead
  JointPath commanded;  ///< where it was told to go; only where it follows a trajectory
  /// Where reported and differentiated velocities lead that differ in direction from those of the
  /// measured way; only where has_contrary.
  JointPath contrary;
  bool follows_trajectory;
  bool has_contrary;
  std::vector<double> end;  ///< where it is at the horizon: as commanded, where it is that
};

/// What the arms' controllers were told to do, and how far they have come. Where a robot is on its
/// trajectory is told from its joints, not from the clock: a controller may go slower than it was
/// told, or wait.
class CommandedTrajectories {
 public:
  struct Config {
    double deviation_max = 0.3;  ///< [rad or m]
    std::size_t points_max = 10000;

    void describe(ParameterTable& table);
  };

  /// @throws ConfigError
  CommandedTrajectories(std::shared_ptr<const RobotModel> model, const Config& config);

  /// Takes the place of those that move one of the same joints. One without points cancels: those
  /// that move one of its joints, or all where it names none.
  /// @param positions where the robot is, one for each variable; empty: not known, and then only a
  /// cancellation is understood. @param velocities as makePath() takes them.
  /// @return what is wrong with it, in one line. What its joints do is not known then, until the
  /// next one for any of them.
  std::string command(Time now, const JointTrajectory& trajectory,
                      const std::vector<double>& positions,
                      const std::vector<double>& velocities = {});
  void clear();

  /// Moves on to where the robot is; those that are done or not followed are forgotten.
  void follow(Time now, const std::vector<double>& positions);

  [[nodiscard]] bool active() const { return !active_.empty(); }
  /// What is wrong with what was commanded, also that the robot does not follow it; empty where
  /// nothing is.
  [[nodiscard]] std::string defect() const {
    return defects_.empty() ? std::string() : defects_.front().text;
  }

  /// The way that measured velocities lead, each joint no further than its limits, unless it was
  /// measured beyond them.
  /// @param path is cleared before; from 0 s to horizon_s.
  void makeMeasuredWay(const JointSnapshot& joints, double horizon_s, JointPath& path);
  /// The same for joints that no trajectory moves, the others along their trajectories.
  void makeWay(const JointSnapshot& joints, double horizon_s, JointPath& path);
  /// @pre it has followed the robot.
  const Ways& findWays(const JointSnapshot& joints, double horizon_s);
  /// Makes the ways longer; their end stays where it was at the horizon.
  void lengthenWays(const JointSnapshot& joints, double until_s);
  /// What the last findWays() found.
  [[nodiscard]] const Ways& ways() const { return ways_; }

 private:
  struct Active {
    std::vector<std::string> names;
    std::vector<std::size_t> variables;
    JointPath path;
    double at_s = 0.0;               ///< how far the robot has come
    Time asked;                      ///< when that was found
    std::vector<double> shift = {};  ///< of the variables: whole turns
  };
  struct Defect {
    std::vector<std::string> names;
    std::string text;
  };
  void forget(const std::vector<std::string>& names);
  /// The largest difference of any of its joints.
  [[nodiscard]] double deviation(const Active& active, double time_s,
                                 const std::vector<double>& positions);
  /// @return false where it is done, or not followed.
  [[nodiscard]] bool moveOn(Active& active, Time now, const std::vector<double>& positions);
  [[nodiscard]] bool isDone(const Active& active);
  void findShift(Active& active, const std::vector<double>& positions);
  void makeWay(const JointSnapshot& joints, const std::vector<double>& velocities, double horizon_s,
               std::vector<Active>& followed, JointPath& path);

  std::shared_ptr<const RobotModel> model_;
  Config config_;
  std::vector<Active> active_;
  std::vector<Defect> defects_;
  Ways ways_;
  std::vector<bool> turning_;                        ///< by variable
  std::vector<double> times_s_;                      ///< reused
  std::vector<double> positions_;                    ///< reused
  std::vector<double> way_point_;                    ///< reused
  std::vector<std::optional<double>> limits_ahead_;  ///< reused, by variable
};

}  // namespace tccm
