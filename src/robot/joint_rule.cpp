#include "robot/joint_rule.h"

#include <algorithm>
#include <cmath>

#include "base/line_of.h"

namespace tccm {
namespace {

constexpr double kTurn = 2.0 * M_PI;
constexpr double kMetresPerRadian = 0.1;  // by which a tolerance in rad is one in m
constexpr double kRangeShare = 0.1;       // of a joint's range that it may lie beyond it
constexpr double kSpeedFactor = 5.0;      // above a limit that is believed
constexpr double kTurningMax = 100.0;     // [rad/s] believed of a joint without a limit
constexpr double kSlidingMax = 10.0;      // [m/s]
constexpr double kTurningSlow = 0.5;      // [rad/s] always believed: some URDFs' limits are tiny
constexpr double kSlidingSlow = 0.1;      // [m/s]
constexpr double kUsualShare = 0.1;       // of these that joins two positions

double distanceBeyond(const JointVariable& variable, double position) {
  return std::max({0.0, variable.lower.value_or(position) - position,
                   position - variable.upper.value_or(position)});
}

}  // namespace

double JointRule::beyond(double position) const {
  double least = distanceBeyond(variable, position);
  if (slides || std::abs(position) > 0.5 * kTurn) return least;
  for (const double turned : {position - kTurn, position + kTurn}) {
    if (distanceBeyond(variable, turned) == 0.0) least = 0.0;
  }
  return least;
}

std::string JointRule::textOfPosition(double position) const {
  const char* question = slides ? "are these millimetres?" : "are these degrees?";
  if (!variable.lower || !variable.upper) {
    return lineOf("joint '%.100s' is published at %.4g %s, which is no joint's position: %s",
                  variable.name.c_str(), position, unit(), question);
  }
  return lineOf("joint '%.100s' is published at %.4g %s, its limits are %.4g and %.4g %s: %s",
                variable.name.c_str(), position, unit(), *variable.lower, *variable.upper, unit(),
                question);
}

std::string JointRule::textOfSpeed(const char* how, double speed) const {
  return lineOf("joint '%.100s' %s %.4g %s/s, at most %.4g are believed: %s", variable.name.c_str(),
                how, speed, unit(), speed_believed,
                slides ? "are these millimetres?" : "are these degrees, or an encoder's ticks?");
}

std::vector<JointRule> rulesOf(const RobotModel& model, double limit_tolerance) {
  std::vector<JointRule> rules;
  for (std::size_t v = 0; v < model.variables().size(); ++v) {
    JointRule rule;
    rule.variable = model.variables()[v];
    rule.slides = model.slides(v);
    rule.limit_tolerance = rule.slides ? kMetresPerRadian * limit_tolerance : limit_tolerance;
    if (rule.variable.lower && rule.variable.upper) {
      const double range = *rule.variable.upper - *rule.variable.lower;
      rule.limit_tolerance = std::max(rule.limit_tolerance, kRangeShare * range);
    }
    const double most = rule.slides ? kSlidingMax : kTurningMax;
    const auto& limit = rule.variable.speed_max;
    rule.speed_believed = limit
                              ? std::clamp(kSpeedFactor * *limit,
                                           rule.slides ? kSlidingSlow : kTurningSlow, kJointLargest)
                              : most;
    rule.speed_permitted = limit.value_or(kUsualShare * most);
    rules.push_back(rule);
  }
  return rules;
}

double MimicRule::deviation(double position, double of_variable) const {
  const double difference = position - (multiplier * of_variable + offset);
  return slides ? difference : std::remainder(difference, kTurn);
}

std::vector<MimicRule> mimicsOf(const RobotModel& model) {
  std::vector<MimicRule> mimics;
  for (const RobotJoint& joint : model.joints()) {
    if (joint.motion == RobotJoint::Motion::kFixed) continue;
    if (joint.name == model.variables()[joint.variable].name) continue;
    mimics.push_back({joint.name, joint.variable, joint.multiplier, joint.offset,
                      joint.motion == RobotJoint::Motion::kTranslation});
  }
  return mimics;
}

}  // namespace tccm
