/// What a Checker is asked about poses and ways that the robot is not on.

#include <algorithm>
#include <cmath>

#include "base/printable.h"
#include "check/checker_parts.h"
#include "tccm_monitor/config_error.h"

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

/// The first waypoint at which the robot has left the map's area; what comes before it goes first.
void Checker::Parts::findOutside(const JointTrajectory& trajectory, TrajectoryAnswer& answer) {
  const std::vector<std::size_t> variables = variablesOf(trajectory, model());
  std::vector<double> positions = inputs.joints()->positions;
  const std::size_t end = answer.index.value_or(trajectory.points.size());
  for (std::size_t i = 0; i < end; ++i) {
    const JointTrajectory::Point& point = trajectory.points[i];
    for (std::size_t k = 0; k < variables.size(); ++k) positions[variables[k]] = point.positions[k];
    const Cause outside = outsideArea(judges.asked.place(positions, inputs.rootPoses()));
    if (outside.reason == Reason::kClear) continue;
    answer.cause = outside;
    answer.index = i;
    answer.time_s = point.time_s;
    answer.contact.reset();
    return;
  }
}

std::optional<Pose> Checker::linkPose(Time now, const std::string& link) {
  const std::vector<std::string>& links = model()->links();
  const auto found = std::find(links.begin(), links.end(), link);
  CheckInputs& inputs = parts_->inputs;
  if (found == links.end() || !inputs.placesRobot(now)) return std::nullopt;
  const Posture& posture =
      parts_->judges.asked.place(inputs.joints()->positions, inputs.rootPoses());
  return posture.T_fixed_links[static_cast<std::size_t>(found - links.begin())];
}

PlacedShape Checker::placeOf(Time now, const AttachedObject& object) {
  const auto T_fixed_link = linkPose(now, object.link);
  if (!T_fixed_link) {
    throw ConfigError(printable("object '" + object.name + "': link '" + object.link, kLineMax) +
                      "' cannot be placed: joints or transforms are missing or too old");
  }
  return {object.primitive.shape, *T_fixed_link * object.primitive.pose};
}

StateAnswer Checker::checkState(Time now, const std::vector<std::string>& names,
                                const std::vector<double>& positions) {
  StateAnswer answer;
  const auto refuse = [&answer](const std::string& detail) {
    answer.cause = {Reason::kBadQuestion, printable(detail, kLineMax)};  // names may hold anything
    return answer;
  };
  if (names.empty() || names.size() != positions.size()) {
    return refuse("as many positions as joint names are needed, and one at least");
  }
  answer.cause = parts_->inputs.worst(now);
  answer.cause.link.clear();
  if (answer.cause.reason != Reason::kClear) return answer;
  CheckInputs& inputs = parts_->inputs;
  std::vector<double> asked = inputs.joints()->positions;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (!model()->hasJoint(names[i])) {
      return refuse("joint '" + names[i] + "' is not one of the robot's");
    }
    std::optional<double> measured;
    for (std::size_t v = 0; v < asked.size(); ++v) {
      if (model()->variables()[v].name != names[i]) continue;
      measured = inputs.joints()->positions[v];
      asked[v] = positions[i];
    }
    const std::string defect = defectOfPosition(*model(), names[i], positions[i], measured);
    if (!defect.empty()) return refuse("it has " + defect);
  }
  if (const auto contradiction = jointThatContradicts(*model(), asked, names, positions)) {
    return refuse("joint '" + *contradiction +
                  "' is not where the joint that it mimics, or fixed_joints, puts it");
  }
  parts_->updateExemptions(now);
  Judges& judges = parts_->judges;
  answer.cause = parts_->outsideArea(judges.asked.place(asked, inputs.rootPoses()));
  if (answer.cause.reason != Reason::kClear) return answer;
  judges.asked.check(parts_->around(), answer.findings);
  if (answer.findings.collision) {
    const std::uint32_t shape = answer.findings.contacts.front().shape;
    answer.cause = {Reason::kCollision, textOfContact(*model(), shape, " touches the map"),
                    model()->linkOf(shape)};
  } else if (!answer.findings.keep_out.empty()) {
    const auto [shape, region] = answer.findings.keep_out.front();
    answer.cause = {Reason::kKeepOut,
                    textOfContact(*model(), shape,
                                  " is in keep-out region '" + parts_->keep_out.name(region) + "'"),
                    model()->linkOf(shape)};
  } else if (answer.findings.occlusion) {
    const std::string link = judges.asked.mostHiddenLink(answer.findings);
    answer.cause = {Reason::kOcclusion, link + " is hidden from the sensor", link};
  }
  return answer;
}

TrajectoryAnswer Checker::checkTrajectory(Time now, const JointTrajectory& trajectory) {
  TrajectoryAnswer answer;
  answer.cause = parts_->inputs.worst(now);
  if (answer.cause.reason != Reason::kClear) return answer;
  parts_->updateExemptions(now);
  if (trajectory.points.size() > parts_->config.trajectories.points_max) {
    answer.cause = {Reason::kBadQuestion, "it has more than trajectory_points_max points"};
    return answer;
  }
  CheckInputs& inputs = parts_->inputs;
  answer = parts_->judges.trajectory.check(parts_->around(), trajectory, inputs.joints()->positions,
                                           inputs.rootPoses());
  const Reason reason = answer.cause.reason;
  const bool is_judged = reason != Reason::kBadQuestion && reason != Reason::kCheckLate;
  if (is_judged) parts_->findOutside(trajectory, answer);
  return answer;
}

}  // namespace tccm
