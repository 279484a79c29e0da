#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "check/commanded_trajectories.h"
#include "fuzz/fuzzed_checker.h"
#include "robot/joint_path.h"

/// What the fuzz target of trajectories and the test of its corpus do with an input: a map, where
/// the robot is, and trajectories that it is commanded, and asked about.
namespace tccm::test {

inline std::vector<double> fuzzedNumbers(ByteReader& bytes, std::size_t count, double reach) {
  std::vector<double> numbers;
  for (std::size_t i = 0; i < count; ++i) numbers.push_back(bytes.number(-reach, reach));
  return numbers;
}

inline JointTrajectory fuzzedTrajectory(ByteReader& bytes) {
  JointTrajectory trajectory;
  const std::uint8_t kind = bytes.byte();
  trajectory.names = {"slide", "turn"};
  if ((kind & 3U) == 1) trajectory.names = {"slide"};
  if (kind >= 0xf0U) {
    trajectory.names.clear();
    for (std::size_t i = bytes.count(3); i > 0; --i) {
      trajectory.names.push_back(bytes.oneOf<const char*>({"turn", "slide", "follow"}));
      if (bytes.seldom()) trajectory.names.back() = bytes.text(4);
    }
  }
  const std::size_t joints = trajectory.names.size();
  double time_s = (kind & 4U) != 0 ? bytes.number(0.0, 1.0) : 0.0;
  for (std::size_t i = bytes.count(8); i > 0; --i) {
    JointTrajectory::Point point;
    point.time_s = time_s;
    point.positions = fuzzedNumbers(bytes, bytes.seldom() ? bytes.count(3) : joints, 0.9);
    if ((kind & 8U) != 0) point.velocities = fuzzedNumbers(bytes, joints, 1.0);
    if ((kind & 16U) != 0) point.accelerations = fuzzedNumbers(bytes, joints, 2.0);
    if (bytes.seldom()) point.velocities.clear();
    if (bytes.seldom()) point.accelerations.push_back(0.0);
    trajectory.points.push_back(point);
    time_s += bytes.number(0.05, 1.0);
  }
  return trajectory;
}

/// The rules of what is understood, in plain words. @param slide where that joint is.
inline bool isUnderstood(const JointTrajectory& trajectory, double slide) {
  const std::set<std::string> names(trajectory.names.begin(), trajectory.names.end());
  if (names.empty() || names.size() != trajectory.names.size()) return false;
  if (names.size() > names.count("slide") + names.count("turn")) return false;
  if (trajectory.points.empty()) return false;
  double before_s = 0.0;
  for (const JointTrajectory::Point& point : trajectory.points) {
    if (point.positions.size() != names.size()) return false;
    for (const auto* numbers : {&point.velocities, &point.accelerations}) {
      if (!numbers->empty() && numbers->size() != names.size()) return false;
    }
    for (const auto* numbers : {&point.positions, &point.velocities, &point.accelerations}) {
      for (const double number : *numbers) {
        if (!(std::abs(number) <= 1e6)) return false;
      }
    }
    const bool is_first = &point == &trajectory.points.front();
    const bool rises =
        is_first ? point.time_s == 0.0 || point.time_s >= 1e-12 : point.time_s - before_s >= 1e-12;
    if (!(rises && point.time_s <= 1e6)) return false;
    before_s = point.time_s;
    for (std::size_t j = 0; j < names.size(); ++j) {
      if (trajectory.names[j] != "slide") continue;
      const double position = point.positions[j];
      if (position < std::min(-0.5, slide) - 0.01 || position > std::max(1.0, slide) + 0.01) {
        return false;
      }
    }
  }
  return true;
}

/// Where one joint is between two points, by Hermite's basis.
inline double betweenPoints(const JointTrajectory::Point& a, const JointTrajectory::Point& b,
                            std::size_t j, double u) {
  const double T = b.time_s - a.time_s, p = a.positions[j], q = b.positions[j];
  if (a.velocities.empty() || b.velocities.empty()) return (1.0 - u) * p + u * q;
  const double v = a.velocities[j] * T, w = b.velocities[j] * T, r = 1.0 - u;
  if (a.accelerations.empty() || b.accelerations.empty()) {
    return r * r * (1.0 + 2.0 * u) * p + u * u * (3.0 - 2.0 * u) * q + r * r * u * v -
           u * u * r * w;
  }
  const double f = a.accelerations[j] * T * T, g = b.accelerations[j] * T * T;
  const double r3 = r * r * r, u3 = u * u * u;
  return r3 * (1.0 + 3.0 * u + 6.0 * u * u) * p + u3 * (1.0 + 3.0 * r + 6.0 * r * r) * q +
         r3 * u * (1.0 + 3.0 * u) * v - u3 * r * (1.0 + 3.0 * r) * w + 0.5 * r3 * u * u * f +
         0.5 * u3 * r * r * g;
}

/// What rounding may be in that.
inline double roundingBetween(const JointTrajectory::Point& a, const JointTrajectory::Point& b,
                              std::size_t j) {
  const double T = b.time_s - a.time_s;
  const auto at = [j](const std::vector<double>& values) {
    return values.empty() ? 0.0 : std::abs(values[j]);
  };
  return 1e-9 *
         (1.0 + at(a.positions) + at(b.positions) + T * (at(a.velocities) + at(b.velocities)) +
          T * T * (at(a.accelerations) + at(b.accelerations)));
}

/// The path goes through each point, and between them stays near the spline.
inline void requirePath(const JointTrajectory& trajectory,
                        const std::vector<std::size_t>& variables, const JointPath& path,
                        double tolerance) {
  const auto& points = trajectory.points;
  promise(path.begin() == 0.0, "the path does not begin at 0");
  promise(std::abs(path.end() - points.back().time_s) <= 1e-15 * path.end(),
          "the path does not end where the trajectory does");
  for (std::size_t k = 1; k < path.size(); ++k) {
    promise(path.time(k) >= path.time(k - 1), "the path goes back in time");
  }
  std::vector<double> positions, shift(variables.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    path.positionsAt(points[i].time_s, positions);
    for (std::size_t j = 0; j < variables.size(); ++j) {
      const double beyond = positions.at(variables[j]) - points[i].positions[j];
      if (i == 0) shift[j] = beyond;
      const double turns = shift[j] / (2.0 * M_PI);
      // Of times too.
      const double before_s = i == 0 ? 0.0 : points[i - 1].time_s;
      const double steep =
          std::abs(points[i].positions[j] - points[i - (i == 0 ? 0 : 1)].positions[j]) /
          std::max(1e-12, points[i].time_s - before_s);
      const double allowed = 1e-9 * (1.0 + std::abs(points[i].positions[j]) + std::abs(shift[j])) +
                             4e-16 * points[i].time_s * steep;
      promise(std::abs(shift[j]) <= allowed ||
                  (trajectory.names[j] == "turn" && std::abs(turns - std::round(turns)) <= allowed),
              "a point is not on the path");
      promise(std::abs(beyond - shift[j]) <= allowed, "the path leaves out a point");
    }
  }
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    std::size_t pieces = 0;
    for (std::size_t k = 0; k < path.size(); ++k) {
      pieces += path.time(k) > points[i].time_s && path.time(k) <= points[i + 1].time_s ? 1 : 0;
    }
    if (pieces >= 128) continue;
    for (const double u : {0.125, 0.5, 0.8}) {
      path.positionsAt((1.0 - u) * points[i].time_s + u * points[i + 1].time_s, positions);
      for (std::size_t j = 0; j < variables.size(); ++j) {
        const double expected = betweenPoints(points[i], points[i + 1], j, u) + shift[j];
        const double rounding = roundingBetween(points[i], points[i + 1], j);
        promise(std::abs(positions.at(variables[j]) - expected) <=
                    tolerance + rounding + 1e-9 * std::abs(shift[j]),
                "the path is off its spline");
      }
    }
  }
}

/// Whatever was commanded, the ways go from where the robot is to the horizon.
inline void requireWays(CommandedTrajectories& commanded, Time now, const RobotModel& robot,
                        const std::vector<double>& positions) {
  commanded.follow(now, positions);
  JointSnapshot joints;
  joints.positions = positions;
  joints.velocities.assign(robot.variables().size(), 0.3);
  const Ways& ways = commanded.findWays(joints, 0.5);
  for (const JointPath* path : {&ways.measured, &ways.commanded}) {
    if (path == &ways.commanded && !ways.follows_trajectory) continue;
    promise(path->begin() == 0.0 && path->end() == 0.5, "a way does not go to the horizon");
    for (std::size_t k = 0; k < path->size(); ++k) {
      for (std::size_t v = 0; v < path->variables(); ++v) {
        promise(std::isfinite(path->positions(k)[v]), "a way is not finite");
        promise(k > 0 || path->positions(k)[v] == positions.at(v), "a way begins elsewhere");
      }
    }
  }
  promise(ways.end.size() == positions.size(), "a way has no end");
}

/// An answer is bounded, and what it calls clear touches nothing.
inline void requireAnswer(const TrajectoryAnswer& answer, const JointTrajectory& trajectory,
                          const RobotModel& robot, const std::vector<double>& from,
                          const CuboidMap& map) {
  constexpr double kPassedOver = 0.0025;  // [m]; half of trajectory_step_m, and rounding
  if (!answer.cause.detail.empty()) requireOneLine(answer.cause.detail);
  const Reason reason = answer.cause.reason;
  const bool is_judged = reason != Reason::kBadQuestion && reason != Reason::kCheckLate;
  promise(!answer.index || *answer.index < trajectory.points.size(), "no such waypoint");
  if (!is_judged) return;
  promise(answer.clearances_m.size() == trajectory.points.size(), "a clearance is missing");
  promise(answer.time_s >= 0.0 && answer.time_s <= trajectory.points.back().time_s,
          "it ends at no time of the trajectory");
  JointPath path(from.size());
  promise(makePath(trajectory, robot, from, 5e-4, path), "a path that is too long is judged");
  std::vector<double> positions;
  if (reason == Reason::kCollision) {
    CuboidMap any = map;
    for (Cuboid& cuboid : any.cuboids) cuboid.points = 3;
    path.positionsAt(answer.time_s, positions);
    promise(nearestOf(any, ballsAt(robot, positions)) <= kFuzzedPadding + kPassedOver,
            "what is said to touch does not");
  }
  if (reason != Reason::kClear) return;
  for (std::size_t k = 0; k < std::min<std::size_t>(path.size(), 200); ++k) {
    positions.assign(path.positions(k), path.positions(k) + path.variables());
    promise(nearestOf(map, ballsAt(robot, positions)) > kFuzzedPadding - kPassedOver,
            "a clear trajectory touches the map");
  }
}

/// Where the robot is, and what it goes by.
struct TrajectoryScene {
  explicit TrajectoryScene(ByteReader& bytes) : checker(robot, fuzzedChecker()) {
    map = fuzzedMap();
    addCuboids(bytes, 5, map);
    from.resize(robot->variables().size());
    from[variableOf(*robot, "slide")] = bytes.uniform(-0.5, 1.0);
    from[variableOf(*robot, "turn")] = bytes.uniform(-20.0, 20.0);
    checker.setRootPose(0, Time(), Pose::Identity(), true);
  }
  const Verdict& check() {
    now += std::chrono::milliseconds(10);
    checker.setMap(now, seenAt(map, now, ++serial));
    checker.addJoints(now, now, {"slide", "turn"},
                      {from[variableOf(*robot, "slide")], from[variableOf(*robot, "turn")]},
                      {0.0, 0.0});
    const Verdict& verdict = checker.check(now);
    requireVerdict(verdict);
    return verdict;
  }
  std::shared_ptr<const RobotModel> robot = fuzzedRobot();
  Checker checker;
  CuboidMap map;
  std::vector<double> from;
  Time now{std::chrono::seconds(100)};
  std::uint32_t serial = 0;
};

inline void runTrajectory(const JointTrajectory& trajectory, TrajectoryScene& scene,
                          CommandedTrajectories& commanded) {
  const RobotModel& robot = *scene.robot;
  const bool understood = isUnderstood(trajectory, scene.from[variableOf(robot, "slide")]);
  const std::string defect = defectOf(trajectory, robot, scene.from);
  promise(defect.empty() == understood,
          understood ? "refused: " + defect : "taken though it cannot be understood");
  if (!defect.empty()) requireOneLine(defect);
  scene.check();
  const TrajectoryAnswer answer = scene.checker.checkTrajectory(scene.now, trajectory);
  promise(understood || answer.cause.reason == Reason::kBadQuestion || trajectory.points.empty(),
          "what cannot be understood is answered");
  promise(understood || answer.cause.reason != Reason::kClear, "it is clear without sense");
  if (understood) {
    JointPath path(scene.from.size());
    if (makePath(trajectory, robot, scene.from, 1e-3, path)) {
      requirePath(trajectory, variablesOf(trajectory, robot), path, 1e-3);
    }
    requireAnswer(answer, trajectory, robot, scene.from, *scene.checker.map());
  }
  const std::string refused = scene.checker.command(scene.now, trajectory);
  if (!refused.empty()) requireOneLine(refused);
  promise(understood || trajectory.points.empty() || !refused.empty(),
          "it is commanded without sense");
  promise(refused.empty() || scene.check().stop, "it goes though nobody knows where to");
  promise(commanded.command(scene.now, trajectory, scene.from) == refused, "it is told otherwise");
  promise(refused.empty() || !commanded.defect().empty(), "the defect is forgotten");
  requireWays(commanded, scene.now, robot, scene.from);
}

inline void runTrajectories(const std::string& input) {
  ByteReader bytes(input);
  TrajectoryScene scene(bytes);
  CommandedTrajectories commanded(scene.robot, {});
  for (int i = 0; i < 3 && !bytes.isEmpty(); ++i) {
    runTrajectory(fuzzedTrajectory(bytes), scene, commanded);
  }
  static_cast<void>(scene.checker.command(scene.now, {}));
  promise(scene.check().reason != Reason::kBadTrajectory, "a cancelled trajectory stops it");
}

/// What trajectories and the answers to them broke of their promises, or nothing.
inline std::string trajectoriesDefect(const std::string& input) {
  return brokenPromise([&] { runTrajectories(input); });
}

}  // namespace tccm::test
