#include <actionlib/action_definition.h>
#include <control_msgs/FollowJointTrajectoryAction.h>
#include <gtest/gtest.h>

#include <string>

namespace tccm {
namespace {

// The message types by the names that actionlib gives them.
struct Follow {
  using Action = control_msgs::FollowJointTrajectoryAction;
  ACTION_DEFINITION(Action)
  using Tolerance = Goal::_goal_tolerance_type::value_type;
};

template <typename Message>
void expectType(const std::string& type, const std::string& md5_sum) {
  EXPECT_EQ(ros::message_traits::datatype<Message>(), type);
  EXPECT_EQ(ros::message_traits::md5sum<Message>(), md5_sum) << type;
}

TEST(ControlMsgsTest, TypesAndMd5SumsAreThoseOfRosPackage) {
  const std::string follow = "control_msgs/FollowJointTrajectory";
  expectType<Follow::Action>(follow + "Action", "bc4f9b743838566551c0390c65f1a248");
  expectType<Follow::ActionGoal>(follow + "ActionGoal", "cff5c1d533bf2f82dd0138d57f4304bb");
  expectType<Follow::ActionResult>(follow + "ActionResult", "c4fb3b000dc9da4fd99699380efcc5d9");
  expectType<Follow::ActionFeedback>(follow + "ActionFeedback", "d8920dc4eae9fc107e00999cce4be641");
  expectType<Follow::Goal>(follow + "Goal", "69636787b6ecbde4d61d711979bc7ecb");
  expectType<Follow::Result>(follow + "Result", "493383b18409bfb604b4e26c676401d2");
  expectType<Follow::Feedback>(follow + "Feedback", "10817c60c2486ef6b33e97dcd87f4474");
  expectType<Follow::Tolerance>("control_msgs/JointTolerance", "f544fe9c16cf04547e135dd6063ff5be");
}

TEST(ControlMsgsTest, ErrorCodesAreThoseOfRosPackage) {
  EXPECT_EQ(Follow::Result::SUCCESSFUL, 0);
  EXPECT_EQ(Follow::Result::INVALID_GOAL, -1);
  EXPECT_EQ(Follow::Result::INVALID_JOINTS, -2);
  EXPECT_EQ(Follow::Result::OLD_HEADER_TIMESTAMP, -3);
  EXPECT_EQ(Follow::Result::PATH_TOLERANCE_VIOLATED, -4);
  EXPECT_EQ(Follow::Result::GOAL_TOLERANCE_VIOLATED, -5);
}

}  // namespace
}  // namespace tccm
