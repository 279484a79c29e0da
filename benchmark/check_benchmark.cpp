/// How long the check of a robot's present pose and of the pose ahead takes: forward kinematics,
/// collision and, where asked for, occlusion of the dual-arm robot's 26 primitives, its arms over a
/// table that fills about 2,000 cuboids at 20 mm.

#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "simulation/robot/dual_arm.h"
#include "tccm_monitor/check/pose_check.h"

namespace tccm {
namespace {

/// Fills the columns over a rectangle on the floor with cuboids of the same heights [m].
void addBlock(CuboidMap& map, const UprightBox& block) {
  for (CellIndex cell = 0; cell < map.grid.cells(); ++cell) {
    const Eigen::Vector2d centre = map.grid.centre(cell);
    if ((centre.array() < block.min().head<2>().array()).any()) continue;
    if ((centre.array() > block.max().head<2>().array()).any()) continue;
    Cuboid cuboid;
    cuboid.cell = cell;
    cuboid.bottom = map.grid.heightOf(block.min().z());
    cuboid.top = map.grid.heightOf(block.max().z());
    cuboid.points = 3;
    map.cuboids.push_back(cuboid);
  }
}

/// A table top 0.75 m high that reaches from 0.4 to 1.1 m ahead, with four objects on it, as the
/// sensor on the robot's head would map it.
CuboidMap tableMap() {
  CuboidMap map;
  const auto block = [&map](double x, double y, double bottom, double size_xy, double top) {
    addBlock(map, {Vector3(x, y, bottom), Vector3(x + size_xy, y + size_xy, top)});
  };
  addBlock(map, {Vector3(0.4, -0.5, 0.73), Vector3(1.1, 0.5, 0.75)});
  block(0.75, -0.1, 0.751, 0.16, 0.98);
  block(0.95, 0.25, 0.751, 0.16, 0.90);
  block(0.60, -0.06, 0.751, 0.10, 0.83);
  block(0.90, -0.40, 0.751, 0.20, 1.05);
  std::stable_sort(map.cuboids.begin(), map.cuboids.end(),
                   [](const Cuboid& a, const Cuboid& b) { return a.cell < b.cell; });
  indexCells(map);
  map.viewpoint = Vector3(0.09, 0.0, 1.535);
  map.complete = true;
  return map;
}

/// Both arms bent ahead by that much at the shoulders [rad], the hands level; at -0.7 they are
/// some 30 mm of free air above the table, their padding taken off.
std::vector<double> armsAhead(const RobotModel& model, double shoulder) {
  std::vector<double> positions(model.variables().size(), 0.0);
  for (const std::string side : {"left_", "right_"}) {
    positions[simulation::variableIndex(model, side + "shoulder_pitch_joint")] = shoulder;
    positions[simulation::variableIndex(model, side + "elbow_joint")] = -1.55 - shoulder;
  }
  return positions;
}

double percentile(std::vector<double>& sorted, double share) {
  const auto last = static_cast<double>(sorted.size() - 1);
  return sorted.empty() ? 0.0 : sorted[static_cast<std::size_t>(share * last)];
}

/// @param shoulder of the present pose; the pose ahead is 0.05 rad lower.
void checkTwoPoses(benchmark::State& state, bool occlusion, double shoulder) {
  const auto model = simulation::dualArm();
  const CuboidMap map = tableMap();
  PoseCheck::Config config;
  config.check_occlusion = occlusion;
  PoseCheck now(model, config);
  PoseCheck ahead(model, config);
  const auto positions = armsAhead(*model, shoulder);
  const auto positions_ahead = armsAhead(*model, shoulder + 0.05);
  PoseFindings findings, findings_ahead;
  std::vector<double> times_us;
  for (auto _ : state) {
    const auto start = std::chrono::steady_clock::now();
    now.check(map, positions, {Pose::Identity()}, findings);
    ahead.check(map, positions_ahead, {Pose::Identity()}, findings_ahead);
    const std::chrono::duration<double, std::micro> taken =
        std::chrono::steady_clock::now() - start;
    times_us.push_back(taken.count());
  }
  std::sort(times_us.begin(), times_us.end());
  state.counters["p50_us"] = percentile(times_us, 0.5);
  state.counters["p99_us"] = percentile(times_us, 0.99);
  state.counters["cuboids"] = static_cast<double>(map.cuboids.size());
  state.counters["primitives"] = static_cast<double>(model->shapes().size());
  state.counters["contacts"] =
      static_cast<double>(findings.contacts.size() + findings_ahead.contacts.size());
  state.counters["hiding"] = static_cast<double>(findings.occluding_cuboids.size() +
                                                 findings_ahead.occluding_cuboids.size());
}

constexpr double kOverTheTable = -0.75;
constexpr double kInTheTable = -0.55;
constexpr bool kWithOcclusion = true;
constexpr bool kCollisionAlone = false;

BENCHMARK_CAPTURE(checkTwoPoses, collision, kCollisionAlone, kOverTheTable);
BENCHMARK_CAPTURE(checkTwoPoses, collision_touching, kCollisionAlone, kInTheTable);
BENCHMARK_CAPTURE(checkTwoPoses, collision_and_occlusion, kWithOcclusion, kOverTheTable);
BENCHMARK_CAPTURE(checkTwoPoses, collision_and_occlusion_touching, kWithOcclusion, kInTheTable);

}  // namespace
}  // namespace tccm

BENCHMARK_MAIN();
