#include "simulation/trajectory_controller.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/line_of.h"
#include "tccm_monitor/config_error.h"

namespace tccm::simulation {
namespace {

using Point = JointTrajectory::Point;

Point pointOf(double time_s, const JointSpline::State& state) {
  return {time_s, {state.position}, {state.velocity}, {state.acceleration}};
}

}  // namespace

void TrajectoryController::Config::validate() const {
  requireInRange("stop_trajectory_duration", stop_duration_s, 0.0, 60.0);
}

TrajectoryController::JointState TrajectoryController::Segment::at(Time now) const {
  if (over(now)) return {spline.position(duration_s), 0.0, 0.0};
  return spline.at(std::max(0.0, since(now)));
}

TrajectoryController::TrajectoryController(const Config& config, std::vector<double> positions,
                                           Time now)
    : config_((config.validate(), config)),
      rules_(config.rules),
      tracks_(positions.size()),
      positions_(std::move(positions)),
      velocities_(positions_.size(), 0.0),
      now_(now) {
  config_.rules.turn_freely.resize(positions_.size(), false);
  for (const double position : positions_) desired_.push_back({position, 0.0, 0.0});
  stop(false);
  for (Track& track : tracks_) track.back().duration_s = 0.0;
  stopping_since_.reset();
}

std::string TrajectoryController::command(const TrajectoryGoal& command) {
  if (!command.trajectory.points.empty()) return take(command, false).text;
  forgetGoal();
  stop(false);
  return {};
}

JudgedGoal TrajectoryController::accept(const TrajectoryGoal& goal) { return take(goal, true); }

void TrajectoryController::cancel() {
  if (!hasGoal()) return;
  forgetGoal();
  stop(false);
}

JudgedGoal TrajectoryController::take(const TrajectoryGoal& goal, bool as_goal) {
  const std::vector<JointState> from = desiredAt(std::max(now_, goal.start.value_or(now_)));
  std::vector<double> positions, velocities;
  for (const JointState& state : from) {
    positions.push_back(state.position);
    velocities.push_back(state.velocity);
  }
  JudgedGoal judged = rules_.judge(goal, now_, positions, velocities);
  if (judged.fault != JudgedGoal::Fault::kNone) return judged;
  forgetGoal();
  if (judged.way.points.empty()) {
    judged.tolerances = {std::vector<JointTolerance>(tracks_.size()),
                         std::vector<JointTolerance>(tracks_.size()), 0.0};
    stop(as_goal);
  } else {
    std::vector<double>& accelerations = judged.way.points.front().accelerations;
    for (std::size_t j = 0; j < accelerations.size(); ++j) accelerations[j] = from[j].acceleration;
    follow(judged, goal.trajectory.names, as_goal);
  }
  if (as_goal) tolerances_ = judged.tolerances;
  return judged;
}

void TrajectoryController::follow(const JudgedGoal& judged, const std::vector<std::string>& names,
                                  bool as_goal) {
  stopping_since_.reset();
  const std::vector<Point>& points = judged.way.points;
  for (std::size_t j = 0; j < tracks_.size(); ++j) {
    if (std::find(names.begin(), names.end(), judged.way.names[j]) == names.end()) continue;
    Track& track = tracks_[j];
    const auto replaced =
        std::find_if(track.begin(), track.end(),
                     [&judged](const Segment& segment) { return segment.start >= judged.start; });
    track.erase(replaced, track.end());
    for (std::size_t i = 0; i + 1 < points.size(); ++i) {
      track.push_back({judged.start + fromSeconds(points[i].time_s),
                       points[i + 1].time_s - points[i].time_s,
                       JointSpline(points[i], points[i + 1], j), as_goal});
    }
  }
}

void TrajectoryController::stop(bool as_goal) {
  const double T = config_.stop_duration_s;
  for (std::size_t j = 0; j < tracks_.size(); ++j) {
    JointState from{positions_[j], 0.0, 0.0};
    JointState back = from;
    if (T > 0.0) {
      from = {desired_[j].position, desired_[j].velocity, 0.0};
      back = {from.position, -from.velocity, 0.0};
    }
    // There and back in twice the time: half of that is the stop.
    const double there_and_back_s = T > 0.0 ? 2.0 * T : 1.0;
    const JointSpline spline(pointOf(0.0, from), pointOf(there_and_back_s, back), 0);
    tracks_[j].assign(1, {now_, T, spline, as_goal});
  }
  stopping_since_ = now_;
}

/// It ends no more by itself.
void TrajectoryController::forgetGoal() {
  tolerances_.reset();
  end_.reset();
  for (Track& track : tracks_) {
    for (Segment& segment : track) segment.of_goal = false;
  }
}

void TrajectoryController::step(Time now, const std::vector<double>& positions,
                                const std::vector<double>& velocities) {
  now_ = now;
  positions_ = positions;
  velocities_ = velocities;
  for (Track& track : tracks_) {
    const auto first = std::find_if(track.begin() + 1, track.end(),
                                    [now](const Segment& segment) { return segment.start > now; });
    track.erase(track.begin(), first - 1);  // what is over, but for the newest
  }
  desired_ = desiredAt(now);
  if (hasGoal()) watchGoal();
}

const TrajectoryController::Segment& TrajectoryController::active(const Track& track, Time now) {
  return *(std::find_if(track.begin() + 1, track.end(),
                        [now](const Segment& segment) { return segment.start > now; }) -
           1);
}

std::vector<TrajectoryController::JointState> TrajectoryController::desiredAt(Time to) const {
  std::vector<JointState> desired;
  for (const Track& track : tracks_) desired.push_back(active(track, to).at(to));
  return desired;
}

double TrajectoryController::positionError(std::size_t joint) const {
  const double error = desired_[joint].position - positions_[joint];
  return config_.rules.turn_freely[joint] ? std::remainder(error, 2.0 * M_PI) : error;
}

double TrajectoryController::velocityError(std::size_t joint) const {
  return desired_[joint].velocity - velocities_[joint];
}

bool TrajectoryController::keeps(std::size_t joint, const JointTolerance& tolerance) const {
  const auto within = [](double error, double allowed) {
    return !(allowed > 0.0) || std::abs(error) <= allowed;
  };
  return within(positionError(joint), tolerance.position) &&
         within(velocityError(joint), tolerance.velocity);
}

void TrajectoryController::watchGoal() {
  const auto off = [this](std::size_t j, const char* what) {
    return lineOf("%.100s: %s, by %.4g, its velocity by %.4g", joints()[j].c_str(), what,
                  positionError(j), velocityError(j));
  };
  bool reached = true;
  for (std::size_t j = 0; j < tracks_.size(); ++j) {
    const Segment& segment = active(tracks_[j], now_);
    const bool is_last = &segment == &tracks_[j].back();
    const bool ended = is_last && segment.since(now_) >= segment.duration_s;
    reached = reached && ended;
    if (!segment.of_goal) continue;
    if (!ended && !keeps(j, tolerances_->path[j])) {
      return endGoal(GoalEnd::Kind::kOffPath, off(j, "off its path"));
    }
    if (!ended || keeps(j, tolerances_->end[j])) continue;
    reached = false;
    if (segment.since(now_) >= segment.duration_s + tolerances_->end_time_s) {
      return endGoal(GoalEnd::Kind::kOffGoal, off(j, "off its goal"));
    }
  }
  if (reached) endGoal(GoalEnd::Kind::kReached, {});
}

void TrajectoryController::endGoal(GoalEnd::Kind kind, std::string text) {
  forgetGoal();
  end_ = GoalEnd{kind, std::move(text)};
}

std::optional<TrajectoryController::GoalEnd> TrajectoryController::takeEnd() {
  return std::exchange(end_, std::nullopt);
}

bool TrajectoryController::follows() const {
  if (stopping_since_) return false;
  return std::any_of(tracks_.begin(), tracks_.end(), [this](const Track& track) {
    return track.back().since(now_) < track.back().duration_s;
  });
}

}  // namespace tccm::simulation
