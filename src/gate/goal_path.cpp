#include "gate/goal_path.h"

#include <algorithm>
#include <cassert>
#include <utility>

namespace tccm {
namespace {

void scale(JointTrajectory::Point& point, double scale) {
  for (double& velocity : point.velocities) velocity *= scale;
  for (double& acceleration : point.accelerations) acceleration *= scale * scale;
}

}  // namespace

GoalPath::GoalPath(JointTrajectory way) : way_(std::move(way)) {
  assert(way_.points.size() > 1 && way_.points.front().time_s == 0.0);
  splines_.reserve((way_.points.size() - 1) * way_.names.size());
  for (std::size_t i = 0; i + 1 < way_.points.size(); ++i) {
    for (std::size_t joint = 0; joint < way_.names.size(); ++joint) {
      splines_.emplace_back(way_.points[i], way_.points[i + 1], joint);
    }
  }
}

std::size_t GoalPath::stretchAt(double time_s) const {
  const auto after = std::upper_bound(
      way_.points.begin() + 1, way_.points.end(), time_s,
      [](double time, const JointTrajectory::Point& point) { return time < point.time_s; });
  return static_cast<std::size_t>(after - way_.points.begin()) - 1;
}

void GoalPath::at(double time_s, Sample& sample) const {
  if (time_s >= duration()) {
    sample.positions = way_.points.back().positions;
    sample.velocities.assign(way_.names.size(), 0.0);
    return;
  }
  sample.positions.resize(way_.names.size());
  sample.velocities.resize(way_.names.size());
  const std::size_t stretch = stretchAt(time_s);
  const double since = std::max(0.0, time_s - way_.points[stretch].time_s);
  for (std::size_t joint = 0; joint < way_.names.size(); ++joint) {
    const JointSpline::State state = spline(stretch, joint).at(since);
    sample.positions[joint] = state.position;
    sample.velocities[joint] = state.velocity;
  }
}

JointTrajectory GoalPath::rest(double time_s, double speed_scale) const {
  JointTrajectory rest;
  rest.names = way_.names;
  const double time = std::clamp(time_s, 0.0, duration());
  if (time >= duration()) {
    rest.points.push_back(way_.points.back());
    rest.points.back().time_s = 0.0;
    return rest;
  }
  const std::size_t stretch = stretchAt(time);
  const JointTrajectory::Point &a = way_.points[stretch], &b = way_.points[stretch + 1];
  // With all that makes the same curve of what is left of the stretch, and no more.
  const bool is_curved = !a.velocities.empty() && !b.velocities.empty();
  const bool is_quintic = is_curved && !a.accelerations.empty() && !b.accelerations.empty();
  JointTrajectory::Point here;
  for (std::size_t joint = 0; joint < way_.names.size(); ++joint) {
    const JointSpline::State state = spline(stretch, joint).at(time - a.time_s);
    here.positions.push_back(state.position);
    if (is_curved) here.velocities.push_back(state.velocity);
    if (is_quintic) here.accelerations.push_back(state.acceleration);
  }
  scale(here, speed_scale);
  rest.points.push_back(std::move(here));
  for (std::size_t i = stretch + 1; i < way_.points.size(); ++i) {
    rest.points.push_back(way_.points[i]);
    rest.points.back().time_s = (way_.points[i].time_s - time) / speed_scale;
    scale(rest.points.back(), speed_scale);
  }
  return rest;
}

}  // namespace tccm
