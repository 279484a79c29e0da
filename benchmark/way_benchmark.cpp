/// How long a whole check takes, the way ahead, occlusion at both of its ends, clearances and the
/// permission included, and how long a trajectory of 100 waypoints: the dual-arm robot's 26
/// primitives over the table of check_benchmark.

#include <benchmark/benchmark.h>

#include <cmath>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "check/checker_config.h"
#include "latencies.h"
#include "support/table_scene.h"

namespace tccm {
namespace {

constexpr double kCycle = 0.025;  // [s] between two scans

/// Both arms at a pose, each with one joint at a velocity.
struct Motion {
  std::optional<double> shoulder;  ///< as armsAhead() takes it; nothing: the arms hang down
  const char* joint;               ///< of each arm
  double left, right;              ///< [rad/s]
  bool is_commanded;               ///< a trajectory says so as well
};

/// The arms swing apart over the table; they do not come into contact.
constexpr Motion kFree{-0.75, "shoulder_roll_joint", 0.6, -0.6, false};
constexpr Motion kFreeCommanded{-0.75, "shoulder_roll_joint", 0.6, -0.6, true};
/// They come down and touch after some 0.3 s.
constexpr Motion kNear{-0.75, "shoulder_pitch_joint", 0.2, 0.2, false};
constexpr Motion kNearCommanded{-0.75, "shoulder_pitch_joint", 0.2, 0.2, true};
/// They touch, and are lifted.
constexpr Motion kInContact{-0.57, "shoulder_pitch_joint", -0.4, -0.4, false};
constexpr Motion kInContactCommanded{-0.57, "shoulder_pitch_joint", -0.4, -0.4, true};

/// A robot that is measured and checked again and again.
class Running {
 public:
  /// @param regions to keep out of, posts around the hands, that nothing touches.
  explicit Running(const Motion& motion, int regions = 0)
      : positions_(model_->variables().size(), 0.0),
        velocities_(positions_.size(), 0.0),
        map_(test::tableMap()),
        checker_(model_, Checker::Config()) {
    if (motion.shoulder) positions_ = test::armsAhead(*model_, *motion.shoulder);
    for (const JointVariable& variable : model_->variables()) names_.push_back(variable.name);
    velocityOf("left_", motion.joint) = motion.left;
    velocityOf("right_", motion.joint) = motion.right;
    checker_.setRootPose(0, now_, Pose::Identity(), true);
    for (int i = 0; i < regions; ++i) addPost(i);
    feed();
    if (motion.is_commanded) command();
  }

  /// A new map, and joint states that shiver a little.
  void feed() {
    now_ = now_ + fromSeconds(kCycle);
    auto map = std::make_shared<CuboidMap>(map_);
    map->stamp = now_;
    ++map->serial;
    test::refreshLooks(*map);
    std::vector<double> measured = positions_;
    std::uniform_real_distribution<double> noise(-1e-3, 1e-3);
    for (double& position : measured) position += noise(engine_);
    checker_.setMap(now_, std::move(map));
    checker_.addJoints(now_, now_, names_, measured, velocities_);
  }

  const Verdict& check() { return checker_.check(now_); }
  [[nodiscard]] const CheckTimes& times() const { return checker_.times(); }

  /// There and back again and again: no link moves by more than 50 mm between two waypoints.
  /// @param swing of the motion's joints, to one side and back [s].
  [[nodiscard]] JointTrajectory trajectory(int points, double swing) const {
    JointTrajectory trajectory;
    trajectory.names = names_;
    for (int k = 0; k < points; ++k) {
      const double time_s = 0.1 * k;
      const double along_s = std::abs(std::remainder(time_s, 2.0 * swing));
      JointTrajectory::Point point{time_s, positions_, {}, {}};
      for (std::size_t v = 0; v < names_.size(); ++v) {
        point.positions[v] += along_s * velocities_[v];
      }
      trajectory.points.push_back(point);
    }
    return trajectory;
  }
  TrajectoryAnswer check(const JointTrajectory& trajectory) {
    return checker_.checkTrajectory(now_, trajectory);
  }

 private:
  void addPost(int i) {
    KeepOutRegion post{"post " + std::to_string(i), "", Box{Vector3(0.03, 0.03, 0.5)}};
    post.T_frame_box.translation() = Vector3(0.95, 0.2 * (i - 3.5), 1.0);
    post.T_frame_box.rotate(Eigen::AngleAxisd(0.2 * i, Vector3::UnitZ()));
    checker_.setKeepOut(post);
  }

  double& velocityOf(const std::string& side, const std::string& joint) {
    return velocities_[simulation::variableIndex(*model_, side + joint)];
  }

  /// On along the velocities for a second, as splines.
  void command() {
    JointTrajectory commanded = trajectory(11, 10.0);
    for (JointTrajectory::Point& point : commanded.points) point.velocities = velocities_;
    checker_.command(now_, commanded);
  }

  std::shared_ptr<const RobotModel> model_ = simulation::dualArm();
  std::vector<std::string> names_;
  std::vector<double> positions_, velocities_;
  CuboidMap map_;
  Checker checker_;
  Time now_{fromSeconds(100.0)};
  std::mt19937 engine_{1};
};

void checkWay(benchmark::State& state, const Motion& motion, int regions = 0) {
  Running robot(motion, regions);
  Latencies latencies;
  const Verdict* verdict = &robot.check();
  double poses = 0.0, way_us = 0.0, clearance_us = 0.0, occlusion_us = 0.0;
  for (auto _ : state) {
    state.PauseTiming();
    robot.feed();
    state.ResumeTiming();
    latencies.time([&] { verdict = &robot.check(); });
    poses += static_cast<double>(verdict->way_poses);
    way_us += robot.times().way_us;
    clearance_us += robot.times().clearance_us;
    occlusion_us += robot.times().occlusion_us;
  }
  latencies.report(state);
  const auto mean = [&state](double sum) { return sum / static_cast<double>(state.iterations()); };
  state.counters["poses"] = mean(poses);
  state.counters["way_us"] = mean(way_us);
  state.counters["clearance_us"] = mean(clearance_us);
  state.counters["occlusion_us"] = mean(occlusion_us);
  state.SetLabel(name(verdict->reason));
}

/// The arms hang down and swing to the back, nothing within 0.2 m of them.
constexpr Motion kBehind{std::nullopt, "shoulder_pitch_joint", 0.4, 0.4, false};
/// The hands swing apart and back, some 30 mm of air under their padding.
constexpr Motion kOverTheTable{-0.75, "shoulder_roll_joint", 0.4, -0.4, false};

void checkTrajectory(benchmark::State& state, const Motion& motion) {
  constexpr int kWaypoints = 100;
  Running robot(motion);
  const JointTrajectory trajectory = robot.trajectory(kWaypoints, 1.0);
  Latencies latencies;
  TrajectoryAnswer answer;
  for (auto _ : state) latencies.time([&] { answer = robot.check(trajectory); });
  latencies.report(state);
  state.SetLabel(name(answer.cause.reason));
}

BENCHMARK_CAPTURE(checkWay, free, kFree);
BENCHMARK_CAPTURE(checkWay, free_8_regions, kFree, 8);
BENCHMARK_CAPTURE(checkWay, free_commanded, kFreeCommanded);
BENCHMARK_CAPTURE(checkWay, near, kNear);
BENCHMARK_CAPTURE(checkWay, near_8_regions, kNear, 8);
BENCHMARK_CAPTURE(checkWay, near_commanded, kNearCommanded);
BENCHMARK_CAPTURE(checkWay, in_contact, kInContact);
BENCHMARK_CAPTURE(checkWay, in_contact_commanded, kInContactCommanded);
BENCHMARK_CAPTURE(checkTrajectory, free, kBehind);
BENCHMARK_CAPTURE(checkTrajectory, near, kOverTheTable);

}  // namespace
}  // namespace tccm

BENCHMARK_MAIN();
