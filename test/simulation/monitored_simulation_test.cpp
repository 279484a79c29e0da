#include "simulation/monitored_simulation.h"

#include <gtest/gtest.h>

#include <optional>

#include "simulation/robot/dual_arm.h"

namespace tccm::simulation {
namespace {

Monitor::Config atATable() {
  Monitor::Config config;
  config.sensors.front().mapper.map.grid.height_min_m = 0.1;
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

/// Lets the arms go from an instant on.
class Gate : public Guardian {
 public:
  explicit Gate(Time opens) : opens_(opens) {}
  Word watch(const Simulator& simulator, const StepOutput& output) override {
    scans += output.scan ? 1 : 0;
    return simulator.now() < opens_ ? Word{true, 0.0, "SHUT"} : Word{false, 1.0, ""};
  }
  int scans = 0;

 private:
  Time opens_;
};

TEST(MonitoredSimulationTest, ARobotObeysItsGuardianAndNotTheMonitorBesideIt) {
  MonitoredSimulation simulation(poleAhead(), atATable(), dualArm());
  Gate gate(simulation.simulator().now() + fromSeconds(5.0));
  simulation.obey(gate, MonitoredSimulation::Obedience::kStopAlone);
  int permitted = 0;
  std::string reason;
  simulation.onPermission([&](bool is_permitted, const std::string& why) {
    permitted += is_permitted ? 1 : 0;
    reason = why;
  });
  pass(simulation, 4.9);  // the map is whole, nothing is near
  EXPECT_LT(simulation.simulator().controller().distance(), 1e-3);
  EXPECT_EQ(permitted, 0);
  EXPECT_EQ(reason, "SHUT");
  pass(simulation, 15.1);
  EXPECT_NEAR(permitted, 1500, 1);
  EXPECT_NEAR(gate.scans, 20.0 / 0.028, 3.0);
  EXPECT_LT(*simulation.simulator().truth().obstacle_min_m, 0.006);  // the gate stops for no pole
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
