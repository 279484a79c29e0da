#include "goal_path.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

namespace tccm::example {
namespace {

using trajectory_msgs::JointTrajectory;
using Point = trajectory_msgs::JointTrajectoryPoint;

void require(bool condition, const std::string& complaint) {
  if (!condition) throw std::invalid_argument(complaint);
}

bool allFinite(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
}

void requireFollowable(const JointTrajectory& trajectory) {
  const std::size_t joints = trajectory.joint_names.size();
  const std::set<std::string> names(trajectory.joint_names.begin(), trajectory.joint_names.end());
  require(joints > 0 && names.size() == joints, "its joints have no names, or the same");
  require(!trajectory.points.empty(), "it has no points");
  double before = -1.0;
  for (const Point& point : trajectory.points) {
    const bool sized = point.positions.size() == joints &&
                       (point.velocities.empty() || point.velocities.size() == joints);
    require(sized, "a point has not as many values as there are joints");
    require(allFinite(point.positions) && allFinite(point.velocities), "a value is not finite");
    const double time = point.time_from_start.toSec();
    require(time >= 0.0 && time > before, "its points' times do not rise from 0 on");
    before = time;
  }
}

/// One coordinate between two points, u 0..1 of the way in seconds.
struct Segment {
  const Point& from;
  const Point& to;
  double seconds;
  double u;

  [[nodiscard]] bool cubic() const { return !from.velocities.empty() && !to.velocities.empty(); }
  [[nodiscard]] double position(std::size_t j) const {
    const double h01 = cubic() ? u * u * (3.0 - 2.0 * u) : u;
    const double way = from.positions[j] + h01 * (to.positions[j] - from.positions[j]);
    if (!cubic()) return way;
    return way + seconds * (u * (1.0 - u) * (1.0 - u) * from.velocities[j] +
                            u * u * (u - 1.0) * to.velocities[j]);
  }
  [[nodiscard]] double velocity(std::size_t j) const {
    const double mean = (to.positions[j] - from.positions[j]) / seconds;
    if (!cubic()) return mean;
    return 6.0 * u * (1.0 - u) * mean + (1.0 - u) * (1.0 - 3.0 * u) * from.velocities[j] +
           u * (3.0 * u - 2.0) * to.velocities[j];
  }
};

void scaleVelocities(Point& point, double scale) {
  for (double& velocity : point.velocities) velocity *= scale;
}

}  // namespace

GoalPath::GoalPath(const JointTrajectory& trajectory,
                   const std::map<std::string, double>& positions, double tolerance)
    : names_(trajectory.joint_names) {
  requireFollowable(trajectory);
  addStart(positions);
  const Point& first = trajectory.points.front();
  const bool starts_here = first.time_from_start.isZero();
  if (starts_here) points_.clear();
  if (!starts_here && !first.velocities.empty()) {
    points_.front().velocities.assign(names_.size(), 0.0);
  }
  points_.insert(points_.end(), trajectory.points.begin(), trajectory.points.end());
  keepVelocitiesOnlyIfAllHaveThem();
  require(startsAt(positions, tolerance), "it begins elsewhere than where the joints are");
}

void GoalPath::addStart(const std::map<std::string, double>& positions) {
  Point start;
  for (const std::string& name : names_) {
    const auto known = positions.find(name);
    require(known != positions.end(), "nobody publishes the position of " + name);
    start.positions.push_back(known->second);
  }
  require(allFinite(start.positions), "the joints' positions are not finite");
  points_.push_back(start);
}

void GoalPath::keepVelocitiesOnlyIfAllHaveThem() {
  const bool all = std::none_of(points_.begin(), points_.end(),
                                [](const Point& point) { return point.velocities.empty(); });
  for (Point& point : points_) {
    if (!all) point.velocities.clear();
    point.accelerations.clear();
    point.effort.clear();
  }
}

bool GoalPath::startsAt(const std::map<std::string, double>& positions, double tolerance) const {
  for (std::size_t j = 0; j < names_.size(); ++j) {
    const double apart = positions.at(names_[j]) - points_.front().positions[j];
    if (!(std::abs(apart) <= tolerance)) return false;
  }
  return true;
}

Point GoalPath::at(double time) const {
  Point result;
  const auto after = std::find_if(points_.begin(), points_.end(), [&](const Point& point) {
    return point.time_from_start.toSec() > time;
  });
  if (after == points_.end()) {
    result.positions = points_.back().positions;
    result.velocities.assign(names_.size(), 0.0);
    return result;
  }
  const Point& to = *std::max(after, points_.begin() + 1);
  const Point& from = *(&to - 1);
  const double seconds = (to.time_from_start - from.time_from_start).toSec();
  const double u = (time - from.time_from_start.toSec()) / seconds;
  const Segment segment{from, to, seconds, std::max(0.0, u)};
  for (std::size_t j = 0; j < names_.size(); ++j) {
    result.positions.push_back(segment.position(j));
    result.velocities.push_back(segment.velocity(j));
  }
  return result;
}

JointTrajectory GoalPath::setpoint(double time, double scale, double delay) const {
  JointTrajectory message;
  message.joint_names = names_;
  message.points.push_back(at(time));
  scaleVelocities(message.points.front(), scale);
  message.points.front().time_from_start = ros::Duration(delay);
  return message;
}

JointTrajectory GoalPath::rest(double time, double scale) const {
  JointTrajectory message = setpoint(time, scale, 0.0);
  if (points_.front().velocities.empty()) message.points.front().velocities.clear();
  for (const Point& point : points_) {
    const double left = point.time_from_start.toSec() - time;
    if (left <= 0.0) continue;
    message.points.push_back(point);
    message.points.back().time_from_start = ros::Duration(left / scale);
    scaleVelocities(message.points.back(), scale);
  }
  return message;
}

}  // namespace tccm::example
