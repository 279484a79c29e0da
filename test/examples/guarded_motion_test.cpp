#include "guarded_motion.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace tccm::example {
namespace {

using State = GuardedMotion::State;
using tccm_monitor::MotionPermission;

constexpr double kCycle = 0.005;            // [s]
constexpr double kPermissionPeriod = 0.02;  // [s]
const std::map<std::string, double> kHere = {{"a", 0.0}};

/// From 0 to 10 rad at 1 rad/s.
GoalPath tenRadians() {
  trajectory_msgs::JointTrajectory goal;
  goal.joint_names = {"a"};
  goal.points.resize(1);
  goal.points[0].positions = {10.0};
  goal.points[0].time_from_start = ros::Duration(10.0);
  return GoalPath(goal, kHere, 0.01);
}

/// A motion, the time, and a monitor that permits as it is told.
class GuardedMotionTest : public ::testing::Test {
 protected:
  [[nodiscard]] Instant now() const {
    return {ros::Time(1000.0 + elapsed_), ros::SteadyTime(5.0 + elapsed_)};
  }

  void permit(double scale = 1.0) {
    MotionPermission message;
    message.header.stamp = now().stamp;
    message.valid_until = message.header.stamp + ros::Duration(2.5 * kPermissionPeriod);
    message.sequence = ++sequence_;
    message.level = scale > 0.0 ? MotionPermission::OK : MotionPermission::STOP;
    message.permitted = scale > 0.0;
    message.speed_scale = scale;
    take(motion_.hear(message, now()));
  }

  void setOff() {
    permit();
    motion_.beginCheck();
    take(motion_.start(tenRadians(), now()));
    ASSERT_EQ(motion_.state(), State::kMoving);
  }

  /// @param scale of the permissions meanwhile; below 0: silence.
  void run(double seconds, double scale = 1.0) {
    const double end = elapsed_ + seconds - 0.5 * kCycle;
    for (int cycle = 0; elapsed_ < end; ++cycle) {
      elapsed_ += kCycle;
      if (cycle % 4 == 3 && scale >= 0.0) permit(scale);
      take(motion_.step(now()));
    }
  }

  void take(const GuardedMotion::Output& output) {
    if (output.command) commands_.push_back(*output.command);
    if (output.trajectory) trajectories_.push_back(*output.trajectory);
  }

  [[nodiscard]] double setpoint() const { return commands_.back().points.at(0).positions.at(0); }
  [[nodiscard]] bool cancelled() const {
    return !commands_.empty() && commands_.back().points.empty() &&
           trajectories_.back().points.empty();
  }

  GuardedMotion motion_{GuardedMotion::Config{}};
  double elapsed_ = 0.0;
  std::uint32_t sequence_ = 0;
  std::vector<trajectory_msgs::JointTrajectory> commands_;
  std::vector<trajectory_msgs::JointTrajectory> trajectories_;
};

TEST_F(GuardedMotionTest, AGoalWithoutPermissionIsRefusedAndPublishesNothing) {
  motion_.beginCheck();
  take(motion_.start(tenRadians(), now()));
  EXPECT_EQ(motion_.stateText(), "REFUSED: no permission was ever heard");
  run(1.0);
  EXPECT_TRUE(commands_.empty());
  EXPECT_TRUE(trajectories_.empty());
}

TEST_F(GuardedMotionTest, SetsOffGentlyAndReachesTheGoal) {
  setOff();
  EXPECT_EQ(trajectories_.size(), 1U);
  run(0.25);  // the scale rises by 4 in a second: half of the time is lost
  EXPECT_NEAR(setpoint(), 0.125 + 0.04, 1e-6);
  run(1.0);
  EXPECT_NEAR(setpoint(), 1.125 + 0.04, 1e-6);
  EXPECT_NEAR(commands_.back().points[0].velocities[0], 1.0, 1e-9);
  EXPECT_EQ(commands_.back().points[0].time_from_start, ros::Duration(0.04));
  run(10.0);
  EXPECT_EQ(motion_.stateText(), "IDLE: the goal is reached");
  EXPECT_EQ(setpoint(), 10.0);
  EXPECT_EQ(commands_.back().points[0].velocities[0], 0.0);
  EXPECT_TRUE(trajectories_.back().points.empty());
}

TEST_F(GuardedMotionTest, NothingComesAfterTheGoalIsReached) {
  setOff();
  run(11.0);
  const std::size_t commands = commands_.size();
  run(1.0);
  EXPECT_EQ(commands_.size(), commands);
}

TEST_F(GuardedMotionTest, SLOWHalvesTheSpeed) {
  setOff();
  run(1.0);
  run(0.5, 0.5);
  const double before = setpoint();
  run(2.0, 0.5);
  EXPECT_NEAR(setpoint() - before, 1.0, 1e-6);
  EXPECT_NEAR(commands_.back().points[0].velocities[0], 0.5, 1e-9);
}

TEST_F(GuardedMotionTest, TheScaleOfTheSpeedChangesNoFasterThanAllowed) {
  setOff();
  run(1.0);
  double last = commands_.back().points[0].velocities[0];
  for (const double scale : {0.2, 1.0, 0.5}) {
    for (int i = 0; i < 100; ++i) {
      run(kCycle, scale);
      permit(scale);
      const double velocity = commands_.back().points[0].velocities[0];
      EXPECT_LE(std::abs(velocity - last), 4.0 * kCycle + 1e-9);
      last = velocity;
    }
    EXPECT_NEAR(last, scale, 1e-9);
  }
}

TEST_F(GuardedMotionTest, TheAnnouncedTrajectoryIsNeverFurtherOffThanAllowed) {
  setOff();
  for (const double scale : {1.0, 0.3, 0.7, 1.0}) {
    for (int i = 0; i < 300; ++i) {
      run(kCycle, scale);
      permit(scale);
      const auto& announced = trajectories_.back();
      const double since = (now().stamp - announced.header.stamp).toSec();
      const auto& from = announced.points.front();
      const auto& to = announced.points.back();
      const double position = from.positions[0] + since / to.time_from_start.toSec() *
                                                      (to.positions[0] - from.positions[0]);
      const double velocity = commands_.back().points[0].velocities[0];
      EXPECT_NEAR(position, setpoint() - 0.04 * velocity, 0.05 + 1e-6);
    }
  }
  EXPECT_LT(trajectories_.size(), 20U);
}

TEST_F(GuardedMotionTest, ASpeedOfNextToNothingIsNoError) {
  setOff();
  run(1.0);
  EXPECT_NO_THROW(run(1.0, 1e-12));
  EXPECT_EQ(motion_.state(), State::kMoving);
}

TEST_F(GuardedMotionTest, STOPHoldsWhenItIsHeardAndNotACycleLater) {
  setOff();
  run(1.0);
  permit(0.0);
  EXPECT_EQ(motion_.state(), State::kHeld);
  EXPECT_TRUE(cancelled());
}

TEST_F(GuardedMotionTest, SilenceHoldsWithinThreePeriods) {
  setOff();
  run(1.0);
  permit();
  run(0.05 - kCycle, -1.0);
  EXPECT_EQ(motion_.state(), State::kMoving);
  run(2.0 * kCycle, -1.0);
  EXPECT_EQ(motion_.state(), State::kHeld);
  EXPECT_TRUE(cancelled());
}

TEST_F(GuardedMotionTest, OnceHeldNothingResumesItButANewGoal) {
  setOff();
  run(1.0);
  permit(0.0);
  const std::size_t commands = commands_.size();
  const std::size_t trajectories = trajectories_.size();
  for (const double scale : {1.0, 0.5, 0.0, -1.0, 1.0}) run(1.0, scale);
  EXPECT_EQ(motion_.state(), State::kHeld);
  EXPECT_EQ(commands_.size(), commands);
  EXPECT_EQ(trajectories_.size(), trajectories);
  setOff();
  run(0.5);
  EXPECT_GT(setpoint(), 0.3);
}

TEST_F(GuardedMotionTest, ANewGoalWhileNotPermittedIsRefused) {
  setOff();
  run(1.0);
  permit(0.0);
  motion_.beginCheck();
  take(motion_.start(tenRadians(), now()));
  EXPECT_EQ(motion_.state(), State::kRefused);
  EXPECT_TRUE(cancelled());
}

TEST_F(GuardedMotionTest, TimeThatJumpsBackHolds) {
  setOff();
  run(1.0);
  take(motion_.step({now().stamp - ros::Duration(0.01), now().steady}));
  EXPECT_EQ(motion_.state(), State::kHeld);
}

TEST_F(GuardedMotionTest, AClockThatStandsStillHolds) {
  setOff();
  run(1.0);
  permit();
  const Instant last = now();
  for (double wall = 0.0; wall < 0.06; wall += kCycle) {
    take(motion_.step({last.stamp, last.steady + ros::WallDuration(wall)}));
  }
  EXPECT_EQ(motion_.state(), State::kHeld);
}

TEST_F(GuardedMotionTest, ALateCycleDoesNotCatchUp) {
  setOff();
  run(1.0);
  const double before = setpoint();
  elapsed_ += 1.0;
  permit();
  take(motion_.step(now()));
  EXPECT_NEAR(setpoint() - before, 0.05, 1e-6);
}

TEST_F(GuardedMotionTest, TheOperatorCancelsWhatMovesOrIsAboutTo) {
  EXPECT_FALSE(motion_.cancel().command);
  EXPECT_EQ(motion_.state(), State::kIdle);
  motion_.beginCheck();
  EXPECT_FALSE(motion_.cancel().command);
  EXPECT_EQ(motion_.stateText(), "REFUSED: cancelled");
  setOff();
  run(0.5);
  take(motion_.cancel());
  EXPECT_EQ(motion_.stateText(), "HELD: cancelled");
  EXPECT_TRUE(cancelled());
}

TEST_F(GuardedMotionTest, WrongParametersAreRefused) {
  GuardedMotion::Config config;
  config.lookahead_s = 0.0;
  EXPECT_THROW(GuardedMotion{config}, std::invalid_argument);
}

}  // namespace
}  // namespace tccm::example
