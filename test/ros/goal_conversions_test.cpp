#include "ros/goal_conversions.h"

#include <control_msgs/FollowJointTrajectoryResult.h>
#include <gtest/gtest.h>

namespace tccm {
namespace {

using Result = control_msgs::FollowJointTrajectoryResult;

TEST(GoalConversionsTest, AGoalKeepsAllThatItSays) {
  control_msgs::FollowJointTrajectoryGoal message;
  message.trajectory.header.stamp = ros::Time(12, 500000000);
  message.trajectory.joint_names = {"a", "b"};
  message.trajectory.points.resize(1);
  message.trajectory.points[0].positions = {1.0, 2.0};
  message.trajectory.points[0].velocities = {3.0, 4.0};
  message.trajectory.points[0].accelerations = {5.0, 6.0};
  message.trajectory.points[0].time_from_start = ros::Duration(1.5);
  message.path_tolerance.resize(1);
  message.path_tolerance[0].name = "b";
  message.path_tolerance[0].position = 0.1;
  message.path_tolerance[0].velocity = -1.0;
  message.path_tolerance[0].acceleration = 0.3;
  message.goal_tolerance.resize(1);
  message.goal_tolerance[0].name = "a";
  message.goal_tolerance[0].position = 0.4;
  message.goal_time_tolerance = ros::Duration(0.25);

  const TrajectoryGoal goal = toGoal(message);
  EXPECT_EQ(goal.start, Time(std::chrono::milliseconds(12500)));
  EXPECT_EQ(goal.trajectory.names, message.trajectory.joint_names);
  ASSERT_EQ(goal.trajectory.points.size(), 1U);
  EXPECT_EQ(goal.trajectory.points[0].time_s, 1.5);
  EXPECT_EQ(goal.trajectory.points[0].positions, (std::vector<double>{1.0, 2.0}));
  EXPECT_EQ(goal.trajectory.points[0].velocities, (std::vector<double>{3.0, 4.0}));
  EXPECT_EQ(goal.trajectory.points[0].accelerations, (std::vector<double>{5.0, 6.0}));
  ASSERT_EQ(goal.path.size(), 1U);
  EXPECT_EQ(goal.path[0].joint, "b");
  EXPECT_EQ(goal.path[0].tolerance.position, 0.1);
  EXPECT_EQ(goal.path[0].tolerance.velocity, -1.0);
  EXPECT_EQ(goal.path[0].tolerance.acceleration, 0.3);
  ASSERT_EQ(goal.end.size(), 1U);
  EXPECT_EQ(goal.end[0].joint, "a");
  EXPECT_EQ(goal.end[0].tolerance.position, 0.4);
  EXPECT_EQ(goal.end_time_s, 0.25);
}

TEST(GoalConversionsTest, WithoutAStampAGoalStartsNow) {
  EXPECT_FALSE(toGoal(control_msgs::FollowJointTrajectoryGoal()).start);
  EXPECT_FALSE(toGoal(trajectory_msgs::JointTrajectory()).start);
}

TEST(GoalConversionsTest, AFaultHasTheErrorCodeThatControllersAnswerWith) {
  EXPECT_EQ(errorCode(JudgedGoal::Fault::kInvalidGoal), Result::INVALID_GOAL);
  EXPECT_EQ(errorCode(JudgedGoal::Fault::kInvalidJoints), Result::INVALID_JOINTS);
  EXPECT_EQ(errorCode(JudgedGoal::Fault::kNone), Result::SUCCESSFUL);
}

}  // namespace
}  // namespace tccm
