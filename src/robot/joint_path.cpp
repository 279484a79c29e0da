#include "robot/joint_path.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <set>

#include "base/line_of.h"
#include "base/printable.h"
#include "robot/joint_rule.h"
#include "robot/joint_spline.h"

namespace tccm {
namespace {

constexpr std::size_t kPathPointsMax = 1U << 16U;
constexpr double kLimitTolerance = 0.01;  // [rad or m]
constexpr double kNearestPoints = 1e-12;  // [s]; splines between nearer ones have no coefficients

bool allFinite(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(),
                     [](double value) { return std::abs(value) <= kJointLargest; });
}

/// The number of variables where none has that name.
std::size_t variableOf(const std::string& name, const RobotModel& model) {
  const std::vector<JointVariable>& all = model.variables();
  const auto found =
      std::find_if(all.begin(), all.end(), [&](const JointVariable& v) { return v.name == name; });
  return static_cast<std::size_t>(found - all.begin());
}

std::string defectOfJoint(const std::string& name, const RobotModel& model) {
  const std::string joint = printable("joint '" + name + "' ", kLineMax);
  if (!model.hasJoint(name)) return joint + "is not one of the robot's";
  if (model.fixedJoints().count(name) > 0) return joint + "is one of fixed_joints";
  if (variableOf(name, model) < model.variables().size()) return {};
  return joint + "moves no monitored link of its own: nothing watches what it does";
}

/// @pre no joint has a defect
std::string defectOfPoint(const JointTrajectory& trajectory, std::size_t i, const RobotModel& model,
                          const std::vector<double>& measured) {
  const JointTrajectory::Point& point = trajectory.points[i];
  const std::size_t joints = trajectory.names.size();
  const auto fits = [joints](const std::vector<double>& v) {
    return v.empty() || v.size() == joints;
  };
  if (point.positions.size() != joints) return "has not one position for each joint";
  if (!fits(point.velocities)) return "has not one velocity for each joint";
  if (!fits(point.accelerations)) return "has not one acceleration for each joint";
  if (!allFinite(point.positions) || !allFinite(point.velocities) ||
      !allFinite(point.accelerations) || !allFinite({point.time_s})) {
    return "has a number that is not finite";
  }
  if (point.time_s < 0.0) return "lies before the start";
  for (std::size_t j = 0; j < joints; ++j) {
    const std::size_t v = variableOf(trajectory.names[j], model);
    const std::string defect =
        defectOfPosition(model, trajectory.names[j], point.positions[j],
                         v < measured.size() ? std::optional(measured[v]) : std::nullopt);
    if (!defect.empty()) return "has " + defect;
  }
  const double before_s = i == 0 ? 0.0 : trajectory.points[i - 1].time_s;
  const bool rises = point.time_s - before_s >= kNearestPoints || (i == 0 && point.time_s == 0.0);
  return rises ? "" : "is not after the one before it";
}

/// @param shift for joints without limits: whole turns.
void addStretch(const JointTrajectory::Point& a, const JointTrajectory::Point& b,
                const std::vector<std::size_t>& variables, const std::vector<double>& shift,
                double tolerance, std::vector<double>& positions, JointPath& path) {
  const double T = b.time_s - a.time_s;
  std::vector<JointSpline> splines;
  double curvature = 0.0;
  for (std::size_t j = 0; j < variables.size(); ++j) {
    splines.emplace_back(a, b, j);
    curvature = std::max(curvature, splines.back().curvatureMax(T));
  }
  constexpr double kPiecesMax = 128.0;
  const double pieces =
      std::clamp(std::ceil(T * std::sqrt(curvature / (8.0 * tolerance))), 1.0, kPiecesMax);
  for (double k = 1.0; k <= pieces; ++k) {
    const double t = T * k / pieces;
    for (std::size_t j = 0; j < variables.size(); ++j) {
      const double end = k == pieces ? b.positions[j] : splines[j].position(t);
      positions[variables[j]] = end + shift[j];
    }
    path.add(a.time_s + t, positions);
  }
}

}  // namespace

void JointPath::clear() {
  times_.clear();
  positions_.clear();
  travel_.clear();
}

void JointPath::reserve(std::size_t points) {
  times_.reserve(points);
  positions_.reserve(points * variables_);
  travel_.reserve(points * variables_);
}

void JointPath::add(double time_s, const std::vector<double>& positions) {
  assert(positions.size() == variables_);
  assert(times_.empty() || time_s >= times_.back());
  const std::size_t last = positions_.size() - (times_.empty() ? 0 : variables_);
  for (std::size_t v = 0; v < variables_; ++v) {
    travel_.push_back(
        times_.empty() ? 0.0 : travel_[last + v] + std::abs(positions[v] - positions_[last + v]));
  }
  positions_.insert(positions_.end(), positions.begin(), positions.end());
  times_.push_back(time_s);
}

void JointPath::interpolate(const std::vector<double>& rows, double time_s,
                            std::vector<double>& result) const {
  const auto after = std::upper_bound(times_.begin(), times_.end(), time_s);
  const auto point =
      static_cast<std::size_t>(std::max<std::ptrdiff_t>(after - times_.begin(), 1)) - 1;
  const double* row = rows.data() + point * variables_;
  result.assign(row, row + variables_);
  if (after == times_.begin() || after == times_.end()) return;
  const double share = (time_s - times_[point]) / (times_[point + 1] - times_[point]);
  const double* next = row + variables_;
  for (std::size_t v = 0; v < variables_; ++v) result[v] += share * (next[v] - row[v]);
}

void JointPath::positionsAt(double time_s, std::vector<double>& positions) const {
  interpolate(positions_, time_s, positions);
}

void JointPath::travelUntil(double time_s, std::vector<double>& travel) const {
  interpolate(travel_, time_s, travel);
}

std::string defectOfPosition(const RobotModel& model, const std::string& joint, double position,
                             std::optional<double> measured) {
  if (!(std::abs(position) <= kJointLargest)) {
    return lineOf("joint '%.100s' at %g, which is not finite, or beyond 1000 km", joint.c_str(),
                  position);
  }
  const std::size_t v = variableOf(joint, model);
  if (v == model.variables().size()) return {};
  const auto& [name, lower, upper, speed_max] = model.variables()[v];
  // Not known: the limits alone count.
  const double here = measured.value_or(lower.value_or(upper.value_or(0.0)));
  const bool is_below = lower && position < std::min(*lower, here) - kLimitTolerance;
  const bool is_above = upper && position > std::max(*upper, here) + kLimitTolerance;
  if (!is_below && !is_above) return {};
  return lineOf("joint '%.100s' at %.4g, beyond its limit of %.4g", joint.c_str(), position,
                is_below ? *lower : *upper);
}

std::string defectOf(const JointTrajectory& trajectory, const RobotModel& model,
                     const std::vector<double>& measured) {
  if (trajectory.names.empty()) return "it names no joint";
  if (trajectory.points.empty()) return "it has no points";
  std::set<std::string> names;
  for (const std::string& name : trajectory.names) {
    if (!names.insert(name).second)
      return printable("joint '" + name + "' is named twice", kLineMax);
    std::string defect = defectOfJoint(name, model);
    if (!defect.empty()) return defect;
  }
  for (std::size_t i = 0; i < trajectory.points.size(); ++i) {
    const std::string defect = defectOfPoint(trajectory, i, model, measured);
    if (!defect.empty()) return "point " + std::to_string(i) + " " + defect;
  }
  return {};
}

std::vector<std::size_t> variablesOf(const JointTrajectory& trajectory, const RobotModel& model) {
  std::vector<std::size_t> variables;
  for (const std::string& name : trajectory.names) variables.push_back(variableOf(name, model));
  return variables;
}

bool makePath(const JointTrajectory& trajectory, const RobotModel& model,
              const std::vector<double>& from, double tolerance, JointPath& path,
              const std::vector<double>& velocities) {
  const std::vector<std::size_t> variables = variablesOf(trajectory, model);
  const JointTrajectory::Point& first = trajectory.points.front();
  std::vector<double> positions = from, shift(variables.size(), 0.0);
  // Where it comes from; its velocities matter only where the first point has some.
  JointTrajectory::Point start;
  start.velocities.assign(first.velocities.size(), 0.0);
  start.accelerations.assign(first.accelerations.size(), 0.0);
  for (std::size_t j = 0; j < variables.size(); ++j) {
    if (model.turnsFreely(variables[j])) {
      const double turns = (from[variables[j]] - first.positions[j]) / (2.0 * M_PI);
      shift[j] = 2.0 * M_PI * std::round(turns);
    }
    start.positions.push_back(from[variables[j]] - shift[j]);
    if (!first.velocities.empty() && !velocities.empty()) {
      start.velocities[j] = velocities[variables[j]];
    }
  }
  path.clear();
  if (first.time_s > 0.0) {
    path.add(0.0, positions);
    addStretch(start, first, variables, shift, tolerance, positions, path);
  } else {
    for (std::size_t j = 0; j < variables.size(); ++j) {
      positions[variables[j]] = first.positions[j] + shift[j];
    }
    path.add(0.0, positions);
  }
  for (std::size_t i = 0; i + 1 < trajectory.points.size(); ++i) {
    addStretch(trajectory.points[i], trajectory.points[i + 1], variables, shift, tolerance,
               positions, path);
    if (path.size() > kPathPointsMax) return false;
  }
  return true;
}

}  // namespace tccm
