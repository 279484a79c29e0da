/// How long the check of a robot's present pose and of the pose ahead takes: forward kinematics,
/// collision and, where asked for, occlusion of the dual-arm robot's 26 primitives, its arms over a
/// table that fills about 2,000 cuboids at 20 mm.

#include <benchmark/benchmark.h>

#include <cmath>
#include <memory>
#include <random>

#include "check/checker_config.h"
#include "latencies.h"
#include "support/table_scene.h"
#include "support/wild_checker.h"

namespace tccm {
namespace {

/// Joint states shiver by up to a milliradian. @param shoulder of the present pose; the pose ahead
/// is 0.05 rad lower.
void checkTwoPoses(benchmark::State& state, bool occlusion, double shoulder) {
  const auto model = simulation::dualArm();
  const CuboidMap map = test::tableMap();
  CheckedRobot::Config config;
  config.check_occlusion = occlusion;
  const auto robot = std::make_shared<const CheckedRobot>(model, config);
  PoseCheck now(robot, 1.5);
  PoseCheck ahead(robot, 1.5);
  const auto middle = test::armsAhead(*model, shoulder);
  const auto middle_ahead = test::armsAhead(*model, shoulder + 0.05);
  auto positions = middle, positions_ahead = middle_ahead;
  std::mt19937 engine{1};
  std::uniform_real_distribution<double> noise(-1e-3, 1e-3);
  PoseFindings findings, findings_ahead;
  Latencies latencies;
  for (auto _ : state) {
    for (std::size_t v = 0; v < positions.size(); ++v) {
      const double off = noise(engine);
      positions[v] = middle[v] + off;
      positions_ahead[v] = middle_ahead[v] + off;
    }
    latencies.time([&] {
      now.place(positions, {Pose::Identity()});
      ahead.place(positions_ahead, {Pose::Identity()});
      now.findContacts(map, findings);
      ahead.findContacts(map, findings_ahead);
      now.findOcclusion(map, findings, ahead, findings_ahead);
    });
  }
  latencies.report(state);
  state.counters["cuboids"] = static_cast<double>(map.cuboids.size());
  state.counters["primitives"] = static_cast<double>(model->shapes().size());
  state.counters["contacts"] =
      static_cast<double>(findings.contacts.size() + findings_ahead.contacts.size());
  state.counters["hiding"] = static_cast<double>(findings.occluding_cuboids.size() +
                                                 findings_ahead.occluding_cuboids.size());
}

/// Whole checks of joint states of every magnitude, the arms' way ahead included: `max_us` is of
/// the longest.
void checkWildJoints(benchmark::State& state) {
  test::WildChecker wild(simulation::dualArm());
  test::Random random(1);
  Latencies latencies;
  for (auto _ : state) {
    state.PauseTiming();
    wild.feedSomeWild(random);
    state.ResumeTiming();
    latencies.time([&] { wild.checker.check(wild.now); });
  }
  latencies.report(state);
}
BENCHMARK(checkWildJoints)->Iterations(10000);

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
