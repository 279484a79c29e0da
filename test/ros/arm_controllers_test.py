#!/usr/bin/python3
"""The simulated arms' controllers do what JointTrajectoryController does, by its topic and action."""

import time
import unittest

import rospy
import rostest
from actionlib_msgs.msg import GoalStatus
from control_msgs.msg import (FollowJointTrajectoryGoal, FollowJointTrajectoryResult,
                              JointTolerance)
from trajectory_msgs.msg import JointTrajectory

from gated_arm import ELBOW, ArmClient, assert_feedback_tells_joints, end_of
from waiting import wait_for

STOP_DURATION = 0.3  # [s], of arm_controllers.yaml
CLOSE = 0.02  # [rad], the goals' tolerance there
SPEED_MAX = 3.0  # [rad/s], of the joints


class Arm(ArmClient):
    """With its controller's topic."""

    def __init__(self, side):
        name = f"{side}_arm_controller"
        super().__init__(side, name)
        self.commands = rospy.Publisher(f"{name}/command", JointTrajectory, queue_size=1,
                                        tcp_nodelay=True)
        wait_for(self.commands.get_num_connections)


class ArmControllersTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.left, cls.right = Arm("left"), Arm("right")

    def tearDown(self):
        for arm in (self.left, self.right):
            arm.client.send_goal_and_wait(arm.goal(arm.start, 0.6, smooth=True))
            arm.come_to_rest()

    def assert_at(self, arm, positions, delta=1e-6):
        for is_at, wanted in zip(arm.positions(), positions):
            self.assertAlmostEqual(is_at, wanted, delta=delta)

    def set_off(self, arm, way=0.8, seconds=1.6):
        """Straight; @return once it is under way."""
        arm.client.send_goal(arm.goal(arm.aside(way), seconds))
        wait_for(lambda: abs(arm.positions()[ELBOW] - arm.start[ELBOW]) > 0.1)
        return way / seconds

    def test_a_goal_is_reached_in_its_time_whatever_the_order_of_its_names(self):
        arm = self.right
        there = arm.aside(0.4)
        begun = time.monotonic()
        arm.client.send_goal(arm.goal(there[::-1], 0.8, arm.joints[::-1], smooth=True))
        self.assertEqual(end_of(arm.client),
                         (GoalStatus.SUCCEEDED, FollowJointTrajectoryResult.SUCCESSFUL))
        self.assertGreater(time.monotonic() - begun, 0.75)
        arm.come_to_rest()
        self.assert_at(arm, there)

    def test_both_arms_move_at_once(self):
        for arm in (self.left, self.right):
            arm.client.send_goal(arm.goal(arm.aside(0.3), 0.8, smooth=True))
        wait_for(lambda: self.left.speed() > 0.1 and self.right.speed() > 0.1)
        for arm in (self.left, self.right):
            self.assertEqual(end_of(arm.client)[0], GoalStatus.SUCCEEDED)
            arm.come_to_rest()
            self.assert_at(arm, arm.aside(0.3))

    def test_feedback_tells_where_the_joints_are(self):
        assert_feedback_tells_joints(self, self.right)

    def assert_stopped_from(self, arm, speed):
        """It took 5/8 of speed times stop duration: along the quintic that brakes there."""
        arm.come_to_rest()
        samples = [(stamp, q[ELBOW], abs(v[ELBOW])) for _, stamp, q, v in arm.log()]
        last = max(i for i, (_, _, v) in enumerate(samples) if abs(v - speed) < 1e-6)
        braking = next(i for i in range(last, len(samples)) if samples[i][2] < 0.7 * speed)
        stamp, _, velocity = samples[braking]
        low, high = 0.0, 0.5  # shares of twice the stop duration
        for _ in range(50):
            u = 0.5 * (low + high)
            low, high = (u, high) if 1 - 6 * u**2 + 4 * u**3 > velocity / speed else (low, u)
        begun = stamp - low * 2.0 * STOP_DURATION
        way = abs(samples[-1][1] - samples[last][1]) - speed * (begun - samples[last][0])
        self.assertAlmostEqual(way, 0.625 * speed * STOP_DURATION, delta=1e-3)

    def test_a_cancelled_goal_stops_in_five_eighths_of_speed_times_stop_duration(self):
        speed = self.set_off(self.right)
        self.right.client.cancel_goal()
        self.assertEqual(end_of(self.right.client)[0], GoalStatus.PREEMPTED)
        self.assert_stopped_from(self.right, speed)

    def test_an_empty_command_preempts_a_goal_and_stops(self):
        speed = self.set_off(self.right)
        self.right.commands.publish(JointTrajectory())
        self.assertEqual(end_of(self.right.client)[0], GoalStatus.PREEMPTED)
        self.assert_stopped_from(self.right, speed)

    def test_a_second_goal_preempts_the_first(self):
        arm = self.right
        self.set_off(arm)
        second = arm.new_client()
        second.send_goal(arm.goal(arm.start, 1.0, smooth=True))
        self.assertEqual(end_of(arm.client)[0], GoalStatus.PREEMPTED)
        self.assertEqual(end_of(second)[0], GoalStatus.SUCCEEDED)
        arm.come_to_rest()
        self.assert_at(arm, arm.start)

    def test_a_command_preempts_a_goal_and_is_followed(self):
        arm = self.right
        self.set_off(arm)
        arm.commands.publish(arm.goal(arm.start, 1.0, smooth=True).trajectory)
        self.assertEqual(end_of(arm.client)[0], GoalStatus.PREEMPTED)
        arm.come_to_rest()
        self.assert_at(arm, arm.start)

    def test_what_is_refused_leaves_the_goal_before_it_under_way(self):
        arm = self.right
        self.set_off(arm)
        stale = arm.goal(arm.start, 1.0)
        stale.trajectory.header.stamp = rospy.Time.now() - rospy.Duration(10.0)
        falling = arm.goal(arm.start, 1.0)
        falling.trajectory.points.append(falling.trajectory.points[0])
        other = arm.goal(arm.start, 1.0, self.left.joints)
        part = arm.goal([arm.start[ELBOW]], 1.0, [arm.joints[ELBOW]])
        second = arm.new_client()
        for goal, code in ((stale, FollowJointTrajectoryResult.INVALID_GOAL),
                           (falling, FollowJointTrajectoryResult.INVALID_GOAL),
                           (other, FollowJointTrajectoryResult.INVALID_JOINTS),
                           (part, FollowJointTrajectoryResult.INVALID_JOINTS),
                           (FollowJointTrajectoryGoal(),
                            FollowJointTrajectoryResult.INVALID_JOINTS)):
            second.send_goal(goal)
            self.assertEqual(end_of(second), (GoalStatus.REJECTED, code))
            self.assertTrue(second.get_result().error_string)
        self.assertEqual(end_of(arm.client)[0], GoalStatus.SUCCEEDED)
        self.assert_at(arm, arm.aside(0.8), CLOSE)

    def test_where_parts_are_allowed_the_other_joints_stay(self):
        arm = self.left
        goal = arm.goal([arm.aside(0.3)[ELBOW]], 0.6, [arm.joints[ELBOW]], smooth=True)
        arm.client.send_goal(goal)
        self.assertEqual(end_of(arm.client)[0], GoalStatus.SUCCEEDED)
        arm.come_to_rest()
        self.assert_at(arm, arm.aside(0.3))

    def test_a_goal_with_a_stamp_waits_for_it(self):
        arm = self.right
        goal = arm.goal(arm.aside(0.2), 0.4, smooth=True)
        start = rospy.Time.now() + rospy.Duration(0.5)
        goal.trajectory.header.stamp = start
        arm.client.send_goal(goal)
        self.assertEqual(end_of(arm.client)[0], GoalStatus.SUCCEEDED)
        arm.come_to_rest()
        moving = [stamp for _, stamp, _, v in arm.log() if v[ELBOW] != 0.0 and
                  stamp > start.to_sec() - 0.5]
        self.assertGreater(min(moving), start.to_sec())
        self.assertLess(max(moving), start.to_sec() + 0.41)

    def test_a_joint_that_cannot_keep_up_is_off_its_path_and_goes_on(self):
        arm, there = self.right, self.right.aside(0.9)
        arm.client.send_goal(arm.goal(there, 0.1))
        self.assertEqual(end_of(arm.client), (GoalStatus.ABORTED,
                                              FollowJointTrajectoryResult.PATH_TOLERANCE_VIOLATED))
        self.assertIn(arm.joints[ELBOW], arm.client.get_result().error_string)
        wait_for(lambda: abs(arm.positions()[ELBOW] - there[ELBOW]) < 1e-6)

    def test_a_joint_that_comes_too_late_is_off_its_goal(self):
        arm, there = self.right, self.right.aside(0.9)
        goal = arm.goal(there, 0.05)
        goal.path_tolerance = [JointTolerance(name=arm.joints[ELBOW], position=-1.0)]
        late = 0.9 / SPEED_MAX - 0.05
        goal.goal_time_tolerance = rospy.Duration(late - 0.1)
        arm.client.send_goal(goal)
        self.assertEqual(end_of(arm.client), (GoalStatus.ABORTED,
                                              FollowJointTrajectoryResult.GOAL_TOLERANCE_VIOLATED))
        wait_for(lambda: abs(arm.positions()[ELBOW] - there[ELBOW]) < 1e-6)
        goal.trajectory.points[0].positions = arm.start
        goal.goal_time_tolerance = rospy.Duration(late + 0.1)
        arm.client.send_goal(goal)
        self.assertEqual(end_of(arm.client)[0], GoalStatus.SUCCEEDED)


if __name__ == "__main__":
    rospy.init_node("arm_controllers_test")
    rostest.rosrun("tccm_monitor", "arm_controllers", ArmControllersTest)
