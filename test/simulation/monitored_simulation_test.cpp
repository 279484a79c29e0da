#include "simulation/monitored_simulation.h"

#include <gtest/gtest.h>

#include <optional>

#include "simulation/robot/dual_arm.h"

namespace tccm::simulation {
namespace {

Monitor::Config atATable() {
  Monitor::Config config;
  config.mapper.map.grid.height_min_m = 0.1;
  config.checker.evidence.unseen_fraction_max = 1.0;  // arms that slow down meet no pole
  return config;
}

Simulator::Config poleAhead() {
  Simulator::Config config;
  config.controller.speed_mps = 0.1;
  config.obstacle = ObstacleKind::kPole;
  config.appear_s = 7.0;
  return config;
}

void pass(MonitoredSimulation& simulation, double seconds) {
  const Time end = simulation.simulator().now() + fromSeconds(seconds);
  while (simulation.simulator().now() < end) simulation.step();
}

TEST(MonitoredSimulationTest, ItChecksAtEachJointStateAndEachMap) {
  MonitoredSimulation simulation({}, atATable(), dualArm());
  int scans = 0;
  int verdicts = 0;
  simulation.onScan([&](const SimulatedScan&) { ++scans; });
  simulation.onVerdict([&](const Verdict&) { ++verdicts; });
  pass(simulation, 0.5);
  const int before = verdicts - scans;
  pass(simulation, 1.0);
  EXPECT_NEAR(scans, 1.5 / 0.028, 3.0);
  EXPECT_EQ(verdicts - scans - before, 100);
}

TEST(MonitoredSimulationTest, ARobotThatObeysMovesOnceTheMapIsWholeAndHaltsBeforeAPole) {
  MonitoredSimulation simulation(poleAhead(), atATable(), dualArm());
  simulation.obey();
  pass(simulation, 1.0);
  EXPECT_LT(simulation.simulator().controller().distance(), 1e-3);
  pass(simulation, 19.0);
  const Truth& truth = simulation.simulator().truth();
  ASSERT_TRUE(truth.appeared);
  ASSERT_TRUE(truth.stop_asserted);
  EXPECT_GT(*truth.obstacle_min_m, 0.0);
}

TEST(MonitoredSimulationTest, ARobotThatDoesNotObeyRunsIntoIt) {
  MonitoredSimulation simulation(poleAhead(), atATable(), dualArm());
  std::optional<Time> stopped;
  simulation.onVerdict([&](const Verdict& verdict) {
    if (verdict.reason == Reason::kCollisionAhead && !stopped) stopped = verdict.stamp;
  });
  pass(simulation, 20.0);
  EXPECT_TRUE(stopped);
  EXPECT_LT(*simulation.simulator().truth().obstacle_min_m, 0.006);
}

}  // namespace
}  // namespace tccm::simulation
