#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "monitor_config.h"
#include "own_returns.h"
#include "tools/evaluation.h"
#include "tools/program.h"

namespace tccm {

class SetupDraft;

/// What a first run through the monitor shows of a robot and its surroundings.
struct Lessons {
  std::vector<std::optional<double>> tilt_periods_s;  ///< by sensor
  std::vector<Vector3> points;                        ///< in the fixed frame, the robot's left out
  double joint_age_s = 0.0;        ///< the largest of a check, but for those that are faults
  std::vector<double> map_ages_s;  ///< likewise, by sensor
  /// Mean visible fraction of links watched for occlusion, where they are large enough to tell.
  std::map<std::string, double> visible;
  /// By sensor: points inside the area or on the floor below it, the robot's left out.
  std::vector<std::size_t> points_in_area;
  /// By sensor: what of the returns was taken for the robot; nothing where there was none.
  std::vector<std::optional<double>> robot_shares;
};

/// A robot that was heard: its bag, and its model where that is known.
struct HeardRobot {
  std::string bag;
  std::shared_ptr<const RobotModel> model;

  /// Plays it through the monitor, and finishes.
  void play(const MonitorConfig& settings, const std::string& joint_states,
            Evaluation& evaluation) const;
};

/// @throws InputError
[[nodiscard]] Lessons learn(const HeardRobot& robot, const SetupDraft& draft);
/// How far the robot's own returns lie from its model, of a draft that has learned.
/// @pre there is a model. @throws InputError
[[nodiscard]] OwnReturns measureOwnReturns(const HeardRobot& robot, const SetupDraft& draft);

}  // namespace tccm
