#include "check/commanded_trajectories.h"

#include <algorithm>
#include <cmath>

namespace tccm {
namespace {

constexpr double kSplineTolerance = 1e-3;  // [rad or m]
constexpr double kSearchBack = 0.5;        // [s] along the trajectory
constexpr double kSearchAhead = 0.5;
constexpr double kSearchStep = 0.01;
constexpr double kAsGood = 1e-3;  // [rad or m]
constexpr double kBetter = 1e-6;
constexpr double kRidge = 0.02;
constexpr double kDone = 0.01;            // [rad or m] left to travel
constexpr double kArrived = 0.05;         // [rad or m] from its end
constexpr std::size_t kWayPoints = 4096;  // a way with more corners makes for allocation
constexpr double kTurn = 2.0 * 3.14159265358979323846;

bool isSet(const std::vector<bool>& flags, std::size_t v) { return v < flags.size() && flags[v]; }

/// What ends a joint's way in the direction that it moves in; nothing where it was measured beyond
/// that limit before, which does not hold therefore.
std::optional<double> limitAhead(const JointVariable& variable, const JointSnapshot& joints,
                                 std::size_t v, double velocity) {
  if (velocity > 0.0) return isSet(joints.beyond_upper, v) ? std::nullopt : variable.upper;
  return isSet(joints.beyond_lower, v) ? std::nullopt : variable.lower;
}

/// Where a joint is after that time at its velocity.
double positionAfter(const std::optional<double>& limit, double position, double velocity,
                     double time_s) {
  const double ahead = position + time_s * velocity;
  if (!limit) return ahead;
  // What drivers round to beyond a limit stays: a clamp must not move it back in.
  return velocity > 0.0 ? std::min(ahead, std::max(*limit, position))
                        : std::max(ahead, std::min(*limit, position));
}

bool shareAny(const std::vector<std::string>& a, const std::vector<std::string>& b) {
  return std::find_first_of(a.begin(), a.end(), b.begin(), b.end()) != a.end();
}

}  // namespace

void CommandedTrajectories::Config::describe(ParameterTable& table) {
  table.add("trajectory_deviation_max", &deviation_max, "rad, m", {1e-3, 10.0},
            "a robot that is further from its commanded trajectory does not follow it");
  table.add("trajectory_points_max", &points_max, "points", {1.0, 1e6},
            "a longer one is not understood");
}

CommandedTrajectories::CommandedTrajectories(std::shared_ptr<const RobotModel> model,
                                             const Config& config)
    : model_(std::move(model)),
      config_(validated(config)),
      ways_{JointPath(model_->variables().size()),
            JointPath(model_->variables().size()),
            JointPath(model_->variables().size()),
            false,
            false,
            {}},
      positions_(model_->variables().size()),
      way_point_(model_->variables().size()),
      limits_ahead_(model_->variables().size()) {
  ways_.measured.reserve(model_->variables().size() + 2);
  ways_.contrary.reserve(model_->variables().size() + 2);
  ways_.commanded.reserve(kWayPoints);
  times_s_.reserve(kWayPoints);
  for (std::size_t v = 0; v < model_->variables().size(); ++v) {
    turning_.push_back(model_->turnsFreely(v));
  }
}

void CommandedTrajectories::clear() {
  active_.clear();
  defects_.clear();
}

/// What was said of any of these joints before is out of date; all is where none is named.
void CommandedTrajectories::forget(const std::vector<std::string>& names) {
  const auto concerns = [&names](const auto& entry) {
    return names.empty() || entry.names.empty() || shareAny(entry.names, names);
  };
  active_.erase(std::remove_if(active_.begin(), active_.end(), concerns), active_.end());
  defects_.erase(std::remove_if(defects_.begin(), defects_.end(), concerns), defects_.end());
}

std::string CommandedTrajectories::command(Time now, const JointTrajectory& trajectory,
                                           const std::vector<double>& positions,
                                           const std::vector<double>& velocities) {
  forget(trajectory.names);
  if (trajectory.points.empty()) return {};
  std::string defect = trajectory.points.size() > config_.points_max
                           ? "it has more than trajectory_points_max points"
                           : defectOf(trajectory, *model_, positions);
  if (defect.empty() && positions.empty()) {
    defect = "where the robot is when it starts is not known";
  }
  if (defect.empty()) {
    Active active{trajectory.names, variablesOf(trajectory, *model_), JointPath(positions.size()),
                  0.0, now};
    if (!makePath(trajectory, *model_, positions, kSplineTolerance, active.path, velocities)) {
      defect = "it is too long to judge in time";
    } else if (deviation(active, 0.0, positions) <= config_.deviation_max) {
      active_.push_back(std::move(active));
      return {};
    } else {
      defect = "it starts elsewhere than the robot is";
    }
  }
  defects_.push_back({trajectory.names, defect});
  return defect;
}

double CommandedTrajectories::deviation(const Active& active, double time_s,
                                        const std::vector<double>& positions) {
  active.path.positionsAt(time_s, positions_);
  double largest = 0.0;
  for (const std::size_t v : active.variables) {
    double difference = positions_[v] - positions[v];
    if (turning_[v]) difference = std::remainder(difference, kTurn);
    largest = std::max(largest, std::abs(difference));
  }
  return largest;
}

bool CommandedTrajectories::isDone(const Active& active) {
  active.path.travelUntil(active.path.end(), way_point_);
  active.path.travelUntil(active.at_s, positions_);
  return std::all_of(active.variables.begin(), active.variables.end(),
                     [this](std::size_t v) { return way_point_[v] - positions_[v] <= kDone; });
}

bool CommandedTrajectories::moveOn(Active& active, Time now, const std::vector<double>& positions) {
  const double begin = std::max(active.path.begin(), active.at_s - kSearchBack);
  const double end = std::min(active.path.end(), active.at_s + kSearchAhead);
  // Of the first valley that is reached from where it was, the lowest place.
  double best_s = active.at_s;
  double least = deviation(active, active.at_s, positions);
  const auto search = [&](double limit, double step) {
    for (double s = active.at_s + step; step > 0.0 ? s <= limit : s >= limit; s += step) {
      const double here = deviation(active, s, positions);
      if (here > least + kRidge) break;  // a later place on the same way back is no better
      if (here < least - kBetter) {
        least = here;
        best_s = s;
      }
    }
  };
  search(end, kSearchStep);
  search(begin, -kSearchStep);
  // Where it makes no difference, as during a pause, time goes on.
  const double by_clock = std::min(end, active.at_s + std::max(0.0, toSeconds(now - active.asked)));
  active.asked = now;
  if (by_clock > best_s && deviation(active, by_clock, positions) <= least + kAsGood) {
    best_s = by_clock;
  }
  active.at_s = best_s;
  if (least > config_.deviation_max) {
    defects_.push_back({active.names, "the robot does not follow it"});
    return false;
  }
  return least > kArrived || !isDone(active);
}

void CommandedTrajectories::follow(Time now, const std::vector<double>& positions) {
  active_.erase(std::remove_if(active_.begin(), active_.end(),
                               [&](Active& active) { return !moveOn(active, now, positions); }),
                active_.end());
}

/// A joint that turns without limits may be published a whole turn off the trajectory.
void CommandedTrajectories::findShift(Active& active, const std::vector<double>& positions) {
  active.path.positionsAt(active.at_s, positions_);
  active.shift.assign(positions.size(), 0.0);
  for (const std::size_t v : active.variables) {
    if (!turning_[v]) continue;
    active.shift[v] = kTurn * std::round((positions[v] - positions_[v]) / kTurn);
  }
}

void CommandedTrajectories::makeWay(const JointSnapshot& joints,
                                    const std::vector<double>& velocities, double horizon_s,
                                    std::vector<Active>& followed, JointPath& path) {
  times_s_.clear();
  const auto addTime = [&](double time_s) {
    if (time_s > 0.0 && time_s < horizon_s) times_s_.push_back(time_s);
  };
  // The instants at which joints come to their limits, and those of the trajectories' points.
  for (std::size_t v = 0; v < joints.positions.size(); ++v) {
    limits_ahead_[v] = limitAhead(model_->variables()[v], joints, v, velocities[v]);
    if (!limits_ahead_[v] || velocities[v] == 0.0) continue;
    addTime((*limits_ahead_[v] - joints.positions[v]) / velocities[v]);
  }
  for (Active& active : followed) {
    for (std::size_t i = 0; i < active.path.size(); ++i) {
      addTime(active.path.time(i) - active.at_s);
    }
    findShift(active, joints.positions);
  }
  if (horizon_s > 0.0) times_s_.push_back(horizon_s);
  std::sort(times_s_.begin(), times_s_.end());
  times_s_.erase(std::unique(times_s_.begin(), times_s_.end()), times_s_.end());
  path.clear();
  path.add(0.0, joints.positions);
  for (const double time_s : times_s_) {
    for (std::size_t v = 0; v < way_point_.size(); ++v) {
      way_point_[v] = positionAfter(limits_ahead_[v], joints.positions[v], velocities[v], time_s);
    }
    for (const Active& active : followed) {
      active.path.positionsAt(active.at_s + time_s, positions_);
      for (const std::size_t v : active.variables) way_point_[v] = positions_[v] + active.shift[v];
    }
    path.add(time_s, way_point_);
  }
}

void CommandedTrajectories::makeMeasuredWay(const JointSnapshot& joints, double horizon_s,
                                            JointPath& path) {
  std::vector<Active> none;
  makeWay(joints, joints.velocities, horizon_s, none, path);
}

void CommandedTrajectories::makeWay(const JointSnapshot& joints, double horizon_s,
                                    JointPath& path) {
  makeWay(joints, joints.velocities, horizon_s, active_, path);
}

void CommandedTrajectories::lengthenWays(const JointSnapshot& joints, double until_s) {
  makeMeasuredWay(joints, until_s, ways_.measured);
  if (ways_.has_contrary) {
    std::vector<Active> none;
    makeWay(joints, joints.contrary_velocities, until_s, none, ways_.contrary);
  }
  if (ways_.follows_trajectory) makeWay(joints, until_s, ways_.commanded);
}

const Ways& CommandedTrajectories::findWays(const JointSnapshot& joints, double horizon_s) {
  ways_.has_contrary = !joints.contrary_velocities.empty();
  ways_.follows_trajectory = active();
  lengthenWays(joints, horizon_s);
  (ways_.follows_trajectory ? ways_.commanded : ways_.measured).positionsAt(horizon_s, ways_.end);
  return ways_;
}

}  // namespace tccm
