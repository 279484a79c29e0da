#pragma once

#include <string>
#include <vector>

#include "tccm_monitor/robot_model.h"

namespace tccm {

constexpr double kJointLargest = 1e6;  ///< [rad, m, 1/s]; beyond it is no joint's position or speed

/// What may be published of one joint of a healthy robot.
struct JointRule {
  JointVariable variable;
  bool slides = false;           ///< in metres, else in radians
  double limit_tolerance = 0.0;  ///< so far beyond a limit is a sloppy robot, further a wrong unit
  double speed_believed = 0.0;   ///< [rad/s or m/s]; a faster one is a wrong unit
  double speed_permitted = 0.0;  ///< [rad/s or m/s] that joins two positions

  /// How far a position lies beyond the limits; 0 within. Some drivers publish within half a turn
  /// of zero: of these a position that lies within the limits after one whole turn is.
  [[nodiscard]] double beyond(double position) const;
  [[nodiscard]] const char* unit() const { return slides ? "m" : "rad"; }
  /// "joint 'a' is published at 90 rad, its limits are -3.1 and 3.1 rad: are these degrees?"
  [[nodiscard]] std::string textOfPosition(double position) const;
  [[nodiscard]] std::string textOfSpeed(const char* how, double speed) const;
};

/// One for each of the model's variables.
/// @param limit_tolerance [rad], a tenth of it in metres; a tenth of a joint's range where that is
/// more.
[[nodiscard]] std::vector<JointRule> rulesOf(const RobotModel& model, double limit_tolerance);

/// A joint that follows another: what its position is by its rule.
struct MimicRule {
  std::string name;
  std::size_t variable = 0;  ///< that it follows
  double multiplier = 1.0;
  double offset = 0.0;
  bool slides = false;

  /// The difference of a position to that by the rule; whole turns do not count.
  [[nodiscard]] double deviation(double position, double of_variable) const;
};

[[nodiscard]] std::vector<MimicRule> mimicsOf(const RobotModel& model);

}  // namespace tccm
