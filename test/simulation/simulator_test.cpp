#include "simulation/simulator.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>

#include "robot/link_use.h"
#include "simulation/robot/dual_arm.h"

namespace tccm::simulation {
namespace {

std::vector<SimulatedScan> scansOf(Simulator& simulator, double seconds) {
  std::vector<SimulatedScan> scans;
  const Time end = simulator.now() + fromSeconds(seconds);
  while (simulator.now() < end) {
    StepOutput output = simulator.step();
    if (output.scan) scans.push_back(std::move(*output.scan));
  }
  return scans;
}

Simulator::Config poleAhead() {
  Simulator::Config config;
  config.obstacle = ObstacleKind::kPole;
  config.appear_s = 0.1;
  return config;
}

bool sameRanges(const SimulatedScan& a, const SimulatedScan& b) {
  return std::memcmp(a.scan.ranges.data(), b.scan.ranges.data(),
                     a.scan.ranges.size() * sizeof(float)) == 0;
}

TEST(SimulatorTest, TheSameSeedGivesTheSameScansByteForByteAndAnotherDoesNot) {
  Simulator::Config config = poleAhead();
  Simulator first(config);
  Simulator second(config);
  config.seed = 2;
  Simulator other(config);
  const auto a = scansOf(first, 1.0);
  const auto b = scansOf(second, 1.0);
  const auto c = scansOf(other, 1.0);
  ASSERT_EQ(a.size(), 36U);
  ASSERT_EQ(b.size(), a.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_TRUE(sameRanges(a[i], b[i]));
    EXPECT_FALSE(sameRanges(a[i], c[i]));
  }
}

TEST(SimulatorTest, ScansComeEvery28MsAndTheRobotEvery10Ms) {
  Simulator simulator(Simulator::Config{});
  const Time start = simulator.now();
  int robots = 0;
  int scans = 0;
  while (simulator.now() < start + std::chrono::seconds(1)) {
    const StepOutput output = simulator.step();
    if (output.robot) {
      ++robots;
      EXPECT_EQ(output.robot->stamp, start + robots * std::chrono::milliseconds(10));
    }
    if (!output.scan) continue;
    EXPECT_EQ(output.scan->scan.stamp, start + scans++ * std::chrono::milliseconds(28));
    EXPECT_GE(simulator.now(), output.scan->scan.lastBeamTime());
  }
  EXPECT_EQ(robots, 100);
}

class ObstaclesTest : public ::testing::TestWithParam<ObstacleKind> {};

TEST_P(ObstaclesTest, BroughtInAreInPlace150MmAheadOfTheMovingHandAndSeen) {
  Simulator::Config config;
  config.obstacle = GetParam();
  config.appear_s = 1.0;
  config.obstacle_speed_mps = 1.5;
  Simulator simulator(config);
  scansOf(simulator, 1.0);
  while (!simulator.truth().appeared) simulator.step();
  while (simulator.now() < *simulator.truth().in_place) simulator.step();
  const Time in_place = simulator.now();
  scansOf(simulator, 1.0);
  ASSERT_TRUE(simulator.truth().first_beam);
  EXPECT_GE(*simulator.truth().first_beam, *simulator.truth().appeared);
  for (const HandSample& sample : simulator.truth().hand) {
    if (sample.stamp < in_place) continue;
    const double travelled = sample.speed_mps * toSeconds(sample.stamp - in_place);
    EXPECT_NEAR(*sample.obstacle_m + travelled, 0.15, 2e-3);
    break;
  }
}

TEST(SimulatorTest, AnObstacleThatCouldNeverAppearIsRefused) {
  Simulator::Config config;
  config.obstacle = ObstacleKind::kPole;
  config.controller.speed_mps = 1.2;
  EXPECT_ANY_THROW(Simulator{config});
}

TEST_P(ObstaclesTest, AreMetByAHandThatDoesNotStopButNotByOneThatDoes) {
  for (const bool obeys : {false, true}) {
    Simulator::Config config;
    config.obstacle = GetParam();
    config.appear_s = 1.0;
    Simulator simulator(config);
    scansOf(simulator, 1.0);
    while (!simulator.truth().appeared) simulator.step();
    simulator.setStop(obeys);
    const double speed = simulator.controller().speed();
    scansOf(simulator, 1.0);
    const auto& hand = simulator.truth().hand;
    const auto seen = std::find_if(hand.begin(), hand.end(),
                                   [](const HandSample& s) { return s.obstacle_m.has_value(); });
    ASSERT_NE(seen, hand.end());
    const double travelled = speed * toSeconds(seen->stamp - *simulator.truth().appeared);
    EXPECT_NEAR(*seen->obstacle_m + travelled, 0.15, 2e-3);
    const double least = *simulator.truth().obstacle_min_m;
    const double way = 0.02 * speed + speed * speed / 4.0;
    if (obeys) {
      EXPECT_NEAR(least, 0.15 - way, 4e-3);
      EXPECT_TRUE(simulator.truth().halted);
    } else {
      EXPECT_LT(least, 0.006);
    }
  }
}

TEST_P(ObstaclesTest, ForOcclusionLieBetweenSensorAndHandAndTouchNeither) {
  Simulator::Config config;
  config.obstacle = GetParam();
  config.purpose = ObstaclePurpose::kOcclusion;
  config.appear_s = 1.0;
  Simulator simulator(config);
  scansOf(simulator, 4.0);
  ASSERT_TRUE(simulator.truth().first_beam);
  EXPECT_GT(*simulator.truth().obstacle_min_m, 0.1);
}

INSTANTIATE_TEST_SUITE_P(AllKinds, ObstaclesTest,
                         ::testing::Values(ObstacleKind::kPole, ObstacleKind::kArm,
                                           ObstacleKind::kBox));

TEST(SimulatorTest, BeamsSeeTableObjectsAndTheOwnArm) {
  Simulator simulator(Simulator::Config{});
  std::map<std::string, int> seen;
  for (const SimulatedScan& scan : scansOf(simulator, 1.6)) {
    for (const BeamTruth& beam : scan.truth) {
      if (!beam.label) continue;
      const bool own = *beam.label < Simulator::kFirstObject;
      ++seen[own ? simulator.model().linkOf(*beam.label)
                 : simulator.world()[*beam.label - Simulator::kFirstObject].name];
    }
  }
  for (const char* name : {"floor", "table", "mug", "bottle", "box", "can", "right_palm_link"}) {
    EXPECT_GT(seen[name], 20) << name;
  }
  EXPECT_EQ(seen["laser_link"], 0);
  EXPECT_EQ(seen["head_roll_link"], 0);
}

Simulator::Config commanded() {
  Simulator::Config config;
  config.motion = kCommanded;
  return config;
}

/// Both shoulders swing the arms forward.
ArmCommand forward(Time start) {
  return {start,
          {"right_shoulder_pitch_joint", "left_shoulder_pitch_joint"},
          {{std::chrono::seconds(2), {-0.4, -0.4}, {}}}};
}

TEST(SimulatorTest, CommandedArmsMoveOnCommandAloneAndIgnoreStop) {
  Simulator simulator(commanded());
  const std::size_t shoulder = variableIndex(simulator.model(), "right_shoulder_pitch_joint");
  const auto shoulderAt = [&](double seconds) {
    const Time end = simulator.now() + fromSeconds(seconds);
    std::optional<RobotSample> last;
    while (simulator.now() < end) {
      StepOutput output = simulator.step();
      if (output.robot) last = output.robot;
    }
    return last->positions[shoulder];
  };
  const double rest = shoulderAt(0.5);
  EXPECT_EQ(shoulderAt(0.5), rest);
  simulator.setStop(true);
  EXPECT_EQ(simulator.command(forward(simulator.now())), "");
  EXPECT_NEAR(shoulderAt(1.0), 0.5 * (rest - 0.4), 1e-9);
  const auto& hand = simulator.truth().hand;
  const double way = (hand.back().palm - hand[hand.size() - 2].palm).norm();
  EXPECT_NEAR(hand.back().speed_mps, way / 0.01, 1e-3);
  EXPECT_EQ(simulator.command({}), "");
  EXPECT_EQ(simulator.truth().stop_asserted, simulator.now());
  const double held = shoulderAt(0.2);
  EXPECT_EQ(shoulderAt(2.0), held);
  ASSERT_TRUE(simulator.truth().halted);
  EXPECT_LT(*simulator.truth().halted - *simulator.truth().stop_asserted, fromSeconds(0.2));
}

TEST(SimulatorTest, AnArmWithAControllerStopsWithinItsStopDuration) {
  Simulator::Config config = commanded();
  ControlledArm::Config arm;
  arm.controller.rules.joints = {"right_elbow_joint"};
  arm.controller.stop_duration_s = 0.3;
  config.commanded.controlled = {arm};
  Simulator simulator(config);
  TrajectoryGoal goal;
  goal.trajectory = {arm.controller.rules.joints, {{4.0, {-1.0}, {}, {}}}};
  ASSERT_EQ(simulator.armController(0).accept(goal).fault, JudgedGoal::Fault::kNone);
  scansOf(simulator, 0.5);
  EXPECT_FALSE(simulator.truth().stop_asserted);
  simulator.armController(0).cancel();
  const Time told = simulator.now();
  scansOf(simulator, 1.0);
  EXPECT_EQ(simulator.truth().stop_asserted, told);
  ASSERT_TRUE(simulator.truth().halted);
  EXPECT_NEAR(toSeconds(*simulator.truth().halted - told), 0.3, 2e-3);
}

TEST(SimulatorTest, TheSameCommandsGiveTheSameScans) {
  Simulator first(commanded());
  Simulator second(commanded());
  for (Simulator* simulator : {&first, &second}) {
    EXPECT_EQ(simulator->command(forward(simulator->now())), "");
  }
  const auto a = scansOf(first, 1.0);
  const auto b = scansOf(second, 1.0);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_TRUE(sameRanges(a[i], b[i]));
}

TEST(SimulatorTest, AnObstacleAppearsAheadOfACommandedHandOnceItMovesAhead) {
  Simulator::Config config = commanded();
  config.obstacle = ObstacleKind::kPole;
  config.appear_s = 0.2;
  Simulator simulator(config);
  scansOf(simulator, 1.0);
  EXPECT_FALSE(simulator.truth().appeared);
  EXPECT_EQ(simulator.command(forward(simulator.now())), "");
  scansOf(simulator, 0.05);
  ASSERT_TRUE(simulator.truth().appeared);
  EXPECT_NEAR(*simulator.truth().obstacle_min_m, 0.15, 0.02);
}

/// The last robot sample of that time.
RobotSample sampleAfter(Simulator& simulator, double seconds) {
  const Time end = simulator.now() + fromSeconds(seconds);
  std::optional<RobotSample> last;
  while (simulator.now() < end) {
    StepOutput output = simulator.step();
    if (output.robot) last = output.robot;
  }
  return *last;
}

TEST(SimulatorTest, AHandThatObeysASpeedScaleMovesAsMuchMoreSlowly) {
  Simulator simulator(Simulator::Config{});
  simulator.setSpeedScale(0.4);
  double fastest = 0.0;
  scansOf(simulator, 4.0);
  for (const HandSample& sample : simulator.truth().hand) {
    fastest = std::max(fastest, sample.speed_mps);
  }
  EXPECT_NEAR(fastest, 0.1, 1e-3);
}

TEST(SimulatorTest, ScansAndTrueTiltPositionsGoOnWhileTheTiltIsFrozen) {
  Simulator::Config config;
  config.head.faults = {{TiltFault::kFrozen, 1.0, 2.0}};
  Simulator simulator(config);
  const std::size_t tilt = variableIndex(simulator.model(), "laser_tilt_joint");
  const double before = sampleAfter(simulator, 0.5).positions[tilt];
  const double frozen = sampleAfter(simulator, 1.0).positions[tilt];
  EXPECT_NE(before, frozen);
  EXPECT_GE(scansOf(simulator, 1.0).size(), 35U);
  EXPECT_EQ(sampleAfter(simulator, 0.2).positions[tilt], frozen);
  EXPECT_EQ(sampleAfter(simulator, 0.2).velocities[tilt], 0.0);
  EXPECT_NE(sampleAfter(simulator, 0.5).positions[tilt], frozen);
}

TEST(SimulatorTest, AHeadThatIsTurnedAwaySeesTheTableNoLonger) {
  Simulator::Config config;
  Simulator simulator(config);
  const auto beamsOnTable = [&](double seconds) {
    int beams = 0;
    for (const SimulatedScan& scan : scansOf(simulator, seconds)) {
      for (const BeamTruth& beam : scan.truth) {
        const bool scene = beam.label && *beam.label >= Simulator::kFirstObject;
        if (scene && simulator.world()[*beam.label - Simulator::kFirstObject].name == "can") {
          ++beams;
        }
      }
    }
    return beams;
  };
  EXPECT_GT(beamsOnTable(1.6), 20);
  simulator.setTiltFault(TiltFault::kTurnedAway);
  scansOf(simulator, 1.0);
  EXPECT_EQ(beamsOnTable(1.6), 0);
  simulator.setTiltFault(TiltFault::kNone);
  scansOf(simulator, 1.0);
  EXPECT_GT(beamsOnTable(1.6), 20);
}

std::vector<std::size_t> armShapes(const RobotModel& model) {
  LinkUse arms;
  arms.links = {"left_*", "right_*"};
  return model.shapesFor(arms, kCollisionKeys).shapes;
}

/// Of any primitive of the arms from the scene, over a whole motion [m].
double leastClearance(const std::shared_ptr<const RobotModel>& model, const std::string& motion,
                      const World& world) {
  const ArmPath path = armPath(model, motion);
  const auto arms = armShapes(*model);
  Kinematics kinematics(model);
  double least = 1.0;
  for (double s = 0.0; s <= path.length(); s += 0.02) {
    kinematics.update(path.positions(s), {Pose::Identity()});
    for (const std::size_t i : arms) {
      const SampledBody arm({{model->shapes()[i].shape}, {kinematics.shapePoses()[i]}}, 0.02);
      for (const SceneObject& object : world) {
        const SampledBody other({{object.shape}, {object.T_fixed_shape}}, 0.2);
        least = std::min(least, clearance(arm, other));
      }
    }
  }
  return least;
}

TEST(SimulatorTest, ArmsInMotionKeep80MmClearOfTheScene) {
  for (const std::string& scene_name : sceneNames()) {
    for (const std::string& motion : motionNames()) {
      EXPECT_GT(leastClearance(dualArm(), motion, scene(scene_name)), 0.08)
          << scene_name << " " << motion;
    }
  }
}

}  // namespace
}  // namespace tccm::simulation
