#include "simulation/controlled_arm.h"

#include <gtest/gtest.h>

#include <cmath>

#include "simulation/robot/dual_arm.h"
#include "tccm_monitor/config_error.h"

namespace tccm::simulation {
namespace {

constexpr Duration kStep = std::chrono::milliseconds(1);
constexpr char kElbow[] = "right_elbow_joint";

ControlledArm::Config elbow(double lag_s = 0.0) {
  ControlledArm::Config config;
  config.controller.rules.joints = {kElbow};
  config.lag_s = lag_s;
  return config;
}

/// All joints at 0 but for the elbow, which is bent by a radian.
class ControlledArmTest : public ::testing::Test {
 protected:
  ControlledArmTest()
      : model_(dualArm()),
        elbow_(variableIndex(*model_, kElbow)),
        positions_(model_->variables().size(), 0.0),
        velocities_(positions_.size(), 0.0) {
    positions_[elbow_] = -1.0;
  }

  void run(ControlledArm& arm, double seconds) {
    const Time end = now_ + fromSeconds(seconds);
    while (now_ < end) arm.step(now_ += kStep, positions_, velocities_);
  }
  static void send(ControlledArm& arm, double position, double seconds) {
    TrajectoryGoal goal;
    goal.trajectory = {{kElbow}, {{seconds, {position}, {}, {}}}};
    ASSERT_EQ(arm.controller().command(goal), "");
  }

  std::shared_ptr<const RobotModel> model_;
  std::size_t elbow_;
  std::vector<double> positions_, velocities_;
  Time now_{std::chrono::seconds(1000)};
};

TEST_F(ControlledArmTest, ItsJointsAreWhereTheControllerHasThemAndTheOthersStay) {
  ControlledArm arm(elbow(), model_, positions_, now_);
  send(arm, -0.5, 1.0);
  run(arm, 0.5);
  EXPECT_NEAR(positions_[elbow_], -0.75, 1e-12);
  EXPECT_NEAR(velocities_[elbow_], 0.5, 1e-12);
  run(arm, 1.0);
  EXPECT_NEAR(positions_[elbow_], -0.5, 1e-12);
  EXPECT_EQ(velocities_[elbow_], 0.0);
  for (std::size_t i = 0; i < positions_.size(); ++i) {
    if (i == elbow_) continue;
    EXPECT_EQ(positions_[i], 0.0);
  }
}

TEST_F(ControlledArmTest, AJointIsNoFasterThanItsLimitAndComesLate) {
  ControlledArm arm(elbow(), model_, positions_, now_);
  ASSERT_EQ(model_->variables()[elbow_].speed_max, 3.0);
  send(arm, -0.1, 0.1);
  run(arm, 0.2);
  EXPECT_NEAR(positions_[elbow_], -0.4, 1e-9);
  EXPECT_NEAR(velocities_[elbow_], 3.0, 1e-9);
  run(arm, 0.2);
  EXPECT_NEAR(positions_[elbow_], -0.1, 1e-12);
  EXPECT_EQ(velocities_[elbow_], 0.0);
}

TEST_F(ControlledArmTest, ALagIsHowFarItIsBehindInTime) {
  ControlledArm arm(elbow(0.05), model_, positions_, now_);
  send(arm, 1.0, 2.0);
  run(arm, 0.8);
  EXPECT_NEAR(velocities_[elbow_], 1.0, 1e-6);
  EXPECT_NEAR(arm.controller().desired()[0].position - positions_[elbow_], 0.05, 6e-4);
}

TEST_F(ControlledArmTest, ALagDecaysExponentiallyWhateverTheStep) {
  ControlledArm arm(elbow(0.05), model_, positions_, now_);
  send(arm, -0.9, 0.001);
  run(arm, 0.001);
  const double behind = -0.9 - positions_[elbow_];
  arm.step(now_ + fromSeconds(0.1), positions_, velocities_);
  EXPECT_NEAR(-0.9 - positions_[elbow_], behind * std::exp(-2.0), 1e-9);
}

TEST_F(ControlledArmTest, TheControllerSeesWhereItsJointsAre) {
  ControlledArm arm(elbow(), model_, positions_, now_);
  send(arm, 0.0, 1.0);
  run(arm, 0.5);
  positions_[elbow_] = -1.2;  // held by someone
  run(arm, 0.001);
  EXPECT_EQ(arm.controller().positions()[0], -1.2);
  EXPECT_NEAR(arm.controller().positionError(0), 0.701, 1e-9);
}

TEST_F(ControlledArmTest, ItsConfigurationIsChecked) {
  ControlledArm::Config config = elbow(-0.1);
  EXPECT_THROW(ControlledArm(config, model_, positions_, now_), ConfigError);
  config = elbow();
  config.controller.rules.joints = {"no_joint"};
  EXPECT_THROW(ControlledArm(config, model_, positions_, now_), ConfigError);
}

}  // namespace
}  // namespace tccm::simulation
