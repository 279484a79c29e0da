/// What a Checker is asked about poses and ways that the robot is not on.

#include <algorithm>
#include <cmath>

#include "check/checker.h"

namespace tccm {
namespace {

constexpr double kTolerance = 1e-3;  // [rad or m]

/// A mimic or fixed joint whose position, as asked about, is not what its source or the
/// configuration makes it.
std::optional<std::string> jointThatContradicts(const RobotModel& model,
                                                const std::vector<double>& variables,
                                                const std::vector<std::string>& names,
                                                const std::vector<double>& positions) {
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto fixed = model.fixedJoints().find(names[i]);
    if (fixed == model.fixedJoints().end()) continue;
    if (std::abs(positions[i] - fixed->second) > kTolerance) return names[i];
  }
  for (const RobotJoint& joint : model.joints()) {
    if (joint.motion == RobotJoint::Motion::kFixed) continue;
    const auto named = std::find(names.begin(), names.end(), joint.name);
    if (named == names.end()) continue;
    const double follows = joint.multiplier * variables[joint.variable] + joint.offset;
    const double asked = positions[static_cast<std::size_t>(named - names.begin())];
    if (std::abs(asked - follows) > kTolerance) return joint.name;
  }
  return std::nullopt;
}

}  // namespace

std::optional<Pose> Checker::linkPose(Time now, const std::string& link) {
  const auto found = std::find(model_->links().begin(), model_->links().end(), link);
  if (found == model_->links().end() || !inputs_.placesRobot(now)) return std::nullopt;
  checks_.kinematics.update(inputs_.joints()->positions, inputs_.rootPoses());
  return checks_.kinematics.linkPoses()[static_cast<std::size_t>(found - model_->links().begin())];
}

Checker::StateAnswer Checker::checkState(Time now, const std::vector<std::string>& names,
                                         const std::vector<double>& positions) {
  StateAnswer answer;
  const auto refuse = [&](Reason reason, const std::string& detail) {
    answer.reason = reason;
    answer.detail = detail;
    return answer;
  };
  if (names.empty() || names.size() != positions.size()) {
    return refuse(Reason::kBadQuestion,
                  "as many positions as joint names are needed, and one at least");
  }
  const Cause fault = std::max(inputs_.worst(now), outside_,
                               [](const Cause& a, const Cause& b) { return b.isWorseThan(a); });
  if (fault.reason != Reason::kClear) return refuse(fault.reason, fault.detail);
  std::vector<double> asked = inputs_.joints()->positions;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (!model_->hasJoint(names[i]) || !std::isfinite(positions[i])) {
      return refuse(Reason::kBadQuestion,
                    "joint '" + names[i] + "' is unknown, or its position is not finite");
    }
    for (std::size_t v = 0; v < asked.size(); ++v) {
      if (model_->variables()[v].name == names[i]) asked[v] = positions[i];
    }
  }
  if (const auto contradiction = jointThatContradicts(*model_, asked, names, positions)) {
    return refuse(Reason::kBadQuestion,
                  "joint '" + *contradiction +
                      "' is not where the joint that it mimics, or fixed_joints, puts it");
  }
  if (exemptions_.expire(now)) exempt();
  checks_.state.check(*inputs_.map(), asked, inputs_.rootPoses(), answer.findings);
  Cause found;
  if (answer.findings.collision) {
    found = contactCause(Reason::kCollision, Level::kStop, answer.findings.contacts.front().shape,
                         " touches the map");
  } else if (answer.findings.occlusion) {
    const std::string link = checks_.state.mostHiddenLink(answer.findings);
    found = {Reason::kOcclusion, link + " is hidden from the sensor", link};
  }
  answer.reason = found.reason;
  answer.detail = found.detail;
  answer.link = found.link;
  return answer;
}

TrajectoryCheck::Answer Checker::checkTrajectory(Time now, const JointTrajectory& trajectory) {
  const Cause fault = std::max(inputs_.worst(now), outside_,
                               [](const Cause& a, const Cause& b) { return b.isWorseThan(a); });
  if (fault.reason != Reason::kClear) {
    TrajectoryCheck::Answer answer;
    answer.cause = fault;
    return answer;
  }
  if (exemptions_.expire(now)) exempt();
  if (trajectory.points.size() > config_.trajectories.points_max) {
    TrajectoryCheck::Answer answer;
    answer.cause = {Reason::kBadQuestion, "it has more than trajectory_points_max points"};
    return answer;
  }
  return checks_.trajectory.check(*inputs_.map(), trajectory, inputs_.joints()->positions,
                                  inputs_.rootPoses());
}

}  // namespace tccm
