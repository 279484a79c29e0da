/// How long the check of a robot's present pose and of the pose ahead takes: forward kinematics,
/// collision and, where asked for, occlusion of the dual-arm robot's 26 primitives, its arms over a
/// table that fills about 2,000 cuboids at 20 mm.

#include <benchmark/benchmark.h>

#include <cmath>

#include "check/checker_config.h"
#include "latencies.h"
#include "support/table_scene.h"
#include "support/tiny_robot.h"

namespace tccm {
namespace {

/// @param shoulder of the present pose; the pose ahead is 0.05 rad lower.
void checkTwoPoses(benchmark::State& state, bool occlusion, double shoulder) {
  const auto model = simulation::dualArm();
  const CuboidMap map = test::tableMap();
  CheckedRobot::Config config;
  config.check_occlusion = occlusion;
  const auto robot = std::make_shared<const CheckedRobot>(model, config);
  PoseCheck now(robot, 1.5);
  PoseCheck ahead(robot, 1.5);
  const auto positions = test::armsAhead(*model, shoulder);
  const auto positions_ahead = test::armsAhead(*model, shoulder + 0.05);
  PoseFindings findings, findings_ahead;
  Latencies latencies;
  for (auto _ : state) {
    latencies.time([&] {
      now.place(positions, {Pose::Identity()});
      now.check(map, findings);
      ahead.place(positions_ahead, {Pose::Identity()});
      ahead.check(map, findings_ahead);
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

/// The longest check there is: a joint that turns without limits, just below the speed that is
/// believed, its link beside the table.
void checkAFastJoint(benchmark::State& state) {
  const std::string arm = test::collisionOf("<box size=\"0.5 0.05 0.05\"/>", "0.25 0 0");
  Checker checker(test::modelOf(test::robotOf(
                      test::linkOf("base") + test::linkOf("arm", arm) +
                      test::jointOf("roll", "continuous", "base", "arm",
                                    "<origin xyz=\"0.2 0 0.9\"/>" + test::axisOf("0 0 1")))),
                  Checker::Config());
  auto map = std::make_shared<CuboidMap>(test::tableMap());
  checker.setRootPose(0, Time(), Pose::Identity(), true);
  Latencies latencies;
  double time_s = 1.0;
  for (auto _ : state) {
    time_s += 0.01;
    const Time now(fromSeconds(time_s));
    map->stamp = now;
    ++map->serial;
    checker.setMap(now, map);
    checker.addJoints(now, now, {"roll"}, {std::remainder(99.0 * time_s, 2.0 * M_PI)}, {99.0});
    latencies.time([&] { checker.check(now); });
  }
  latencies.report(state);
}
BENCHMARK(checkAFastJoint);

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
