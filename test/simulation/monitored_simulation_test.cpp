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

/// A monitor of a camera alone, at a small picture.
std::pair<Simulator::Config, Monitor::Config> withCamera() {
  Simulator::Config simulator;
  simulator.sensors = {SensorKind::kCamera};
  simulator.clouds.camera.pinhole = {160, 120, 100.0};
  Monitor::Config monitor = atATable();
  monitor.sensors.front().cloud.emplace();
  monitor.sensors.front().mapper.window_s = 0.3;
  monitor.sensors.front().mapper.looks.pass_gap_s = 0.001;
  return {simulator, monitor};
}

TEST(MonitoredSimulationTest, ACamerasFramesAreMappedAndTold) {
  const auto [simulator, monitor] = withCamera();
  MonitoredSimulation simulation(simulator, monitor, dualArm());
  int frames = 0;
  simulation.onCloud([&](const MappedCloud& mapped) {
    ++frames;
    EXPECT_EQ(mapped.sensor, 0U);
    const std::vector<Vector3>& taken = simulation.monitor().returns().points;
    std::size_t kept = 0;
    for (std::size_t i = 0; i < mapped.kinds.size(); ++i) {
      if (mapped.kinds[i] != BeamKind::kReturn) continue;
      ASSERT_LT(kept, taken.size());
      EXPECT_EQ(mapped.p_fixed[i], taken[kept]);
      EXPECT_NE(mapped.cloud.truth[i].label, PointTruth::kNothing);
      // Whatever is not of the robot stands where it is.
      if (mapped.cloud.truth[i].label == Simulator::kFirstObject &&
          !mapped.cloud.truth[i].mixed()) {
        EXPECT_NEAR(mapped.p_fixed[i].z(), 0.0, 0.1);
      }
      ++kept;
    }
    EXPECT_EQ(kept, taken.size());
    EXPECT_GT(kept, 5000U);
  });
  pass(simulation, 1.0);
  EXPECT_NEAR(frames, 29, 2);
  ASSERT_NE(simulation.monitor().map(), nullptr);
  EXPECT_GT(simulation.monitor().map()->cuboids.size(), 100U);
}

TEST(MonitoredSimulationTest, LaserAndCameraAreMappedEachInItsOwnMap) {
  auto [simulator, monitor] = withCamera();
  simulator.sensors = {SensorKind::kLaser, SensorKind::kCamera};
  monitor.sensors.insert(monitor.sensors.begin(), atATable().sensors.front());
  monitor.checker.inputs.sensors = {{"laser", true}, {"camera", true}};
  MonitoredSimulation simulation(simulator, monitor, dualArm());
  int scans = 0, frames = 0;
  simulation.onScan([&](const SimulatedScan&) { ++scans; });
  simulation.onCloud([&](const MappedCloud& mapped) {
    ++frames;
    EXPECT_EQ(mapped.sensor, 1U);
  });
  pass(simulation, 1.0);
  EXPECT_GT(scans, 30);
  EXPECT_GT(frames, 25);
  EXPECT_NE(simulation.monitor().map(0)->cuboids.size(),
            simulation.monitor().map(1)->cuboids.size());
}

}  // namespace
}  // namespace tccm::simulation
