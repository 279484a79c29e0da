#include "robot/joint_trajectory.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

namespace tccm {
namespace {

constexpr double kLargest = 1e6;
constexpr double kLimitTolerance = 0.01;  // [rad or m]
constexpr double kPi = 3.14159265358979323846;

/// The coefficients of a joint's polynomial over one stretch, from the lowest power.
using Spline = std::array<double, 6>;

struct End {
  double position, velocity, acceleration;
};

Spline cubic(const End& a, const End& b, double T) {
  const double d = b.position - a.position;
  return {a.position,
          a.velocity,
          (3.0 * d - (2.0 * a.velocity + b.velocity) * T) / (T * T),
          (-2.0 * d + (a.velocity + b.velocity) * T) / (T * T * T),
          0.0,
          0.0};
}

Spline quintic(const End& a, const End& b, double T) {
  const double d = b.position - a.position, T2 = T * T, T3 = T2 * T;
  return {
      a.position,
      a.velocity,
      0.5 * a.acceleration,
      (20.0 * d - (8.0 * b.velocity + 12.0 * a.velocity) * T -
       (3.0 * a.acceleration - b.acceleration) * T2) /
          (2.0 * T3),
      (-30.0 * d + (14.0 * b.velocity + 16.0 * a.velocity) * T +
       (3.0 * a.acceleration - 2.0 * b.acceleration) * T2) /
          (2.0 * T3 * T),
      (12.0 * d - 6.0 * (b.velocity + a.velocity) * T + (b.acceleration - a.acceleration) * T2) /
          (2.0 * T3 * T2)};
}

double valueOf(const Spline& c, double t) {
  return c[0] + t * (c[1] + t * (c[2] + t * (c[3] + t * (c[4] + t * c[5]))));
}

/// No second derivative on [0, T] is larger: that of its Bernstein coefficients.
double curvatureMax(const Spline& c, double T) {
  const double a = 2.0 * c[2], b = 6.0 * c[3] * T;
  const double d = 12.0 * c[4] * T * T, e = 20.0 * c[5] * T * T * T;
  return std::max({std::abs(a), std::abs(a + b / 3.0), std::abs(a + (2.0 * b + d) / 3.0),
                   std::abs(a + b + d + e)});
}

bool allFinite(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(),
                     [](double value) { return std::abs(value) <= kLargest; });
}

std::string defectOfPoint(const JointTrajectory::Point& point, std::size_t joints) {
  if (point.positions.size() != joints) return "has not one position for each joint";
  const auto fits = [joints](const std::vector<double>& v) {
    return v.empty() || v.size() == joints;
  };
  if (!fits(point.velocities)) return "has not one velocity for each joint";
  if (!fits(point.accelerations)) return "has not one acceleration for each joint";
  if (!allFinite(point.positions) || !allFinite(point.velocities) ||
      !allFinite(point.accelerations) || !(std::abs(point.time_s) <= kLargest)) {
    return "has a number that is not finite";
  }
  return {};
}

std::string defectOfJoint(const std::string& name, const RobotModel& model) {
  const std::string joint = "joint '" + name + "' ";
  if (!model.hasJoint(name)) return joint + "is not one of the robot's";
  if (model.fixedJoints().count(name) > 0) return joint + "is one of fixed_joints";
  const auto& variables = model.variables();
  const bool moves = std::any_of(variables.begin(), variables.end(),
                                 [&name](const auto& variable) { return variable.name == name; });
  return moves ? "" : joint + "moves no monitored link of its own: nothing watches what it does";
}

/// Everything that is known of one joint at both ends of a stretch.
Spline splineOf(const JointTrajectory::Point& a, const JointTrajectory::Point& b, std::size_t j,
                double T) {
  const auto at = [j](const std::vector<double>& values) {
    return values.empty() ? 0.0 : values[j];
  };
  const End from{a.positions[j], at(a.velocities), at(a.accelerations)};
  const End to{b.positions[j], at(b.velocities), at(b.accelerations)};
  if (a.velocities.empty() || b.velocities.empty()) {
    return {from.position, (to.position - from.position) / T, 0.0, 0.0, 0.0, 0.0};
  }
  const bool has_accelerations = !a.accelerations.empty() && !b.accelerations.empty();
  return has_accelerations ? quintic(from, to, T) : cubic(from, to, T);
}

/// @param shift for joints without limits: whole turns.
void addStretch(const JointTrajectory::Point& a, const JointTrajectory::Point& b,
                const std::vector<std::size_t>& variables, const std::vector<double>& shift,
                double tolerance, std::vector<double>& positions, JointPath& path) {
  const double T = b.time_s - a.time_s;
  std::vector<Spline> splines;
  double curvature = 0.0;
  for (std::size_t j = 0; j < variables.size(); ++j) {
    splines.push_back(splineOf(a, b, j, T));
    curvature = std::max(curvature, curvatureMax(splines.back(), T));
  }
  constexpr double kPiecesMax = 128.0;
  const double pieces =
      std::clamp(std::ceil(T * std::sqrt(curvature / (8.0 * tolerance))), 1.0, kPiecesMax);
  for (double k = 1.0; k <= pieces; ++k) {
    const double t = T * k / pieces;
    for (std::size_t j = 0; j < variables.size(); ++j) {
      const double end = k == pieces ? b.positions[j] : valueOf(splines[j], t);
      positions[variables[j]] = end + shift[j];
    }
    path.add(a.time_s + t, positions);
  }
}

/// The first joint's name; empty where there is none.
std::string jointBeyondItsLimit(const JointTrajectory& trajectory,
                                const JointTrajectory::Point& point, const RobotModel& model) {
  for (std::size_t j = 0; j < trajectory.names.size(); ++j) {
    for (const JointVariable& variable : model.variables()) {
      if (variable.name != trajectory.names[j]) continue;
      const double position = point.positions[j];
      if ((variable.lower && position < *variable.lower - kLimitTolerance) ||
          (variable.upper && position > *variable.upper + kLimitTolerance)) {
        return variable.name;
      }
    }
  }
  return {};
}

}  // namespace

std::string defectOf(const JointTrajectory& trajectory, const RobotModel& model) {
  if (trajectory.names.empty()) return "it names no joint";
  if (trajectory.points.empty()) return "it has no points";
  std::set<std::string> names;
  for (const std::string& name : trajectory.names) {
    if (!names.insert(name).second) return "joint '" + name + "' is named twice";
    const std::string defect = defectOfJoint(name, model);
    if (!defect.empty()) return defect;
  }
  for (std::size_t i = 0; i < trajectory.points.size(); ++i) {
    const JointTrajectory::Point& point = trajectory.points[i];
    const std::string defect = defectOfPoint(point, trajectory.names.size());
    if (!defect.empty()) return "point " + std::to_string(i) + " " + defect;
    if (point.time_s < 0.0) return "point " + std::to_string(i) + " lies before the start";
    const std::string joint = jointBeyondItsLimit(trajectory, point, model);
    if (!joint.empty()) {
      return "point " + std::to_string(i) + " has joint '" + joint + "' beyond its limit";
    }
    if (i > 0 && !(point.time_s > trajectory.points[i - 1].time_s)) {
      return "point " + std::to_string(i) + " is not after the one before it";
    }
  }
  return {};
}

std::vector<std::size_t> variablesOf(const JointTrajectory& trajectory, const RobotModel& model) {
  std::vector<std::size_t> result;
  for (const std::string& name : trajectory.names) {
    const auto& all = model.variables();
    const auto found = std::find_if(
        all.begin(), all.end(), [&name](const auto& variable) { return variable.name == name; });
    result.push_back(static_cast<std::size_t>(found - all.begin()));
  }
  return result;
}

void makePath(const JointTrajectory& trajectory, const RobotModel& model,
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
      const double turns = (from[variables[j]] - first.positions[j]) / (2.0 * kPi);
      shift[j] = 2.0 * kPi * std::round(turns);
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
  }
}

}  // namespace tccm
