#include "gate/goal_rules.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "base/line_of.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

using Point = JointTrajectory::Point;

constexpr double kLongest_s = 1e6;  // at the least speed, the times of messages still hold it

bool allFinite(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
}

std::string defectOf(const JointTrajectory& trajectory) {
  const std::size_t joints = trajectory.names.size();
  const auto fits = [joints](const std::vector<double>& v) {
    return v.empty() || v.size() == joints;
  };
  for (std::size_t i = 0; i < trajectory.points.size(); ++i) {
    const Point& point = trajectory.points[i];
    if (point.positions.size() != joints) {
      return lineOf("point %zu has %zu positions for %zu joints", i, point.positions.size(),
                    joints);
    }
    if (!fits(point.velocities) || !fits(point.accelerations)) {
      return lineOf("point %zu has not one velocity or acceleration for each joint, nor none", i);
    }
    if (!allFinite(point.positions) || !allFinite(point.velocities) ||
        !allFinite(point.accelerations) || !std::isfinite(point.time_s)) {
      return lineOf("point %zu has a number that is not finite", i);
    }
    if (point.time_s < 0.0) return lineOf("point %zu lies before the start", i);
    if (point.time_s > kLongest_s) {
      return lineOf("point %zu lies %.3g s after the start, at most %.3g s are allowed", i,
                    point.time_s, kLongest_s);
    }
    if (i > 0 && point.time_s <= trajectory.points[i - 1].time_s) {
      return lineOf("point %zu is not after the one before it", i);
    }
  }
  return {};
}

void update(double asked, double& value) {
  if (asked > 0.0) value = asked;
  if (asked < 0.0) value = 0.0;
}

void update(const std::vector<TrajectoryGoal::Named>& asked, const std::string& joint,
            JointTolerance& tolerance) {
  for (const TrajectoryGoal::Named& named : asked) {
    if (named.joint != joint) continue;
    update(named.tolerance.position, tolerance.position);
    update(named.tolerance.velocity, tolerance.velocity);
    update(named.tolerance.acceleration, tolerance.acceleration);
  }
}

}  // namespace

GoalRules::GoalRules(Config config) : config_(std::move(config)) {
  const std::size_t joints = config_.joints.size();
  const std::set<std::string> names(config_.joints.begin(), config_.joints.end());
  if (joints == 0 || names.size() != joints || names.count("") > 0) {
    throw ConfigError("joints: a controller's joints have to be named, each once");
  }
  config_.turn_freely.resize(joints, false);
  config_.tolerances.path.resize(joints);
  config_.tolerances.end.resize(joints);
}

std::string GoalRules::findPlaces(const JointTrajectory& trajectory,
                                  std::vector<std::size_t>& places) const {
  for (const std::string& name : trajectory.names) {
    const auto found = std::find(config_.joints.begin(), config_.joints.end(), name);
    if (found == config_.joints.end()) {
      return lineOf("joint '%.100s' is not one of the controller's", name.c_str());
    }
    places.push_back(static_cast<std::size_t>(found - config_.joints.begin()));
  }
  const std::set<std::size_t> different(places.begin(), places.end());
  if (different.size() != places.size()) return "a joint is named twice";
  if (places.empty()) return "no joint is named";
  if (config_.allow_partial_joints_goal || places.size() == config_.joints.size()) return {};
  return lineOf(
      "%zu of the controller's %zu joints are named, and allow_partial_joints_goal is "
      "false",
      places.size(), config_.joints.size());
}

GoalTolerances GoalRules::tolerancesOf(const TrajectoryGoal& goal) const {
  GoalTolerances tolerances = config_.tolerances;
  for (std::size_t joint = 0; joint < config_.joints.size(); ++joint) {
    update(goal.path, config_.joints[joint], tolerances.path[joint]);
    update(goal.end, config_.joints[joint], tolerances.end[joint]);
  }
  update(goal.end_time_s, tolerances.end_time_s);
  return tolerances;
}

JudgedGoal GoalRules::judge(const TrajectoryGoal& goal, Time now,
                            const std::vector<double>& positions,
                            const std::vector<double>& velocities) const {
  JudgedGoal judged;
  std::vector<std::size_t> places;
  const auto refuse = [&judged](JudgedGoal::Fault fault, std::string text) {
    judged.fault = fault;
    judged.text = std::move(text);
    return judged;
  };
  const std::string unfit = findPlaces(goal.trajectory, places);
  if (!unfit.empty()) return refuse(JudgedGoal::Fault::kInvalidJoints, unfit);
  const std::string defect = defectOf(goal.trajectory);
  if (!defect.empty()) return refuse(JudgedGoal::Fault::kInvalidGoal, defect);
  judged.tolerances = tolerancesOf(goal);
  judged.way.names = config_.joints;
  judged.start = std::max(now, goal.start.value_or(now));
  const std::vector<Point>& points = goal.trajectory.points;
  if (points.empty()) return judged;
  // Points up to now are over.
  const double over_s = goal.start && *goal.start < now ? toSeconds(now - *goal.start) : 0.0;
  const auto first = std::find_if(points.begin(), points.end(),
                                  [over_s](const Point& point) { return point.time_s > over_s; });
  if (first == points.end()) {
    return refuse(
        JudgedGoal::Fault::kInvalidGoal,
        lineOf("its last point is %.3f s in the past, or now", over_s - points.back().time_s));
  }
  Point here;
  here.positions = positions;
  if (!first->velocities.empty()) here.velocities = velocities;
  here.velocities.resize(first->velocities.empty() ? 0 : positions.size(), 0.0);
  if (!first->accelerations.empty()) here.accelerations.assign(positions.size(), 0.0);
  judged.way.points.push_back(std::move(here));
  std::vector<double> turns(places.size(), 0.0);
  for (std::size_t j = 0; j < places.size(); ++j) {
    if (!config_.turn_freely[places[j]]) continue;
    turns[j] = 2.0 * M_PI * std::round((positions[places[j]] - first->positions[j]) / (2.0 * M_PI));
  }
  for (auto point = first; point != points.end(); ++point) {
    Point all;
    all.time_s = point->time_s - over_s;
    all.positions = positions;
    all.velocities.assign(point->velocities.empty() ? 0 : positions.size(), 0.0);
    all.accelerations.assign(point->accelerations.empty() ? 0 : positions.size(), 0.0);
    for (std::size_t j = 0; j < places.size(); ++j) {
      all.positions[places[j]] = point->positions[j] + turns[j];
      if (!point->velocities.empty()) all.velocities[places[j]] = point->velocities[j];
      if (!point->accelerations.empty()) all.accelerations[places[j]] = point->accelerations[j];
    }
    judged.way.points.push_back(std::move(all));
  }
  return judged;
}

}  // namespace tccm
