#!/usr/bin/python3
"""However a goal ends, the arm stands as soon as the margins reckon with, and its client has a result."""

import os
import signal
import subprocess
import sys
import time

import rospy
import rostest
from actionlib_msgs.msg import GoalStatus
from control_msgs.msg import FollowJointTrajectoryGoal, FollowJointTrajectoryResult
from trajectory_msgs.msg import JointTrajectory

from gate_case import REACHED, GateCase
from gated_arm import ELBOW, end_of
from scripted_monitor import PERMISSION_PERIOD
from tccm_monitor.msg import MotionPermission
from waiting import wait_for

VALIDITY = 2.5 * PERMISSION_PERIOD
HELD = (GoalStatus.ABORTED, FollowJointTrajectoryResult.INVALID_GOAL)


class EndsTest(GateCase):
    def assert_held(self, arm, speed, since, reason, delay=PERMISSION_PERIOD):
        self.assertEqual(end_of(arm.client), HELD)
        self.assertIn(reason, arm.client.get_result().error_string)
        self.assert_stood(arm, speed, since, delay)
        wait_for(lambda: not self.last_trajectory().points)

    def test_STOP_and_FAULT_hold_and_nothing_resumes_when_they_are_over(self):
        for level in (MotionPermission.STOP, MotionPermission.FAULT):
            self.setUp()  # again, in each of these
            speed = self.set_off(self.right)
            self.events.clear()
            stopped = self.monitor.permit(level, 0.0, ["COLLISION_AHEAD"])
            self.assert_held(self.right, speed, stopped, "not permitted: COLLISION_AHEAD")
            wait_for(lambda: self.events == ["stop"])
            self.monitor.permit()
            self.assertTrue(self.right.stands(1.0))
            self.setUp()  # a new goal moves it
            self.set_off(self.right)

    def test_both_arms_are_held(self):
        speeds = [self.set_off(arm) for arm in (self.left, self.right)]
        stopped = self.monitor.permit(MotionPermission.STOP, 0.0, ["OCCLUSION"])
        for arm, speed in zip((self.left, self.right), speeds):
            self.assert_held(arm, speed, stopped, "OCCLUSION")

    def test_silence_holds_within_three_periods(self):
        self.monitor.permit(validity=VALIDITY)
        # On a machine that is busy the monitor may be late before.
        def sets_off():
            self.right.client.send_goal(self.right.goal(self.right.aside(0.9), 1.8))
            wait_for(lambda: abs(self.right.elbow() - self.right.start[ELBOW]) > 0.2 or
                     self.right.client.get_state() > GoalStatus.ACTIVE)
            return self.right.client.get_state() == GoalStatus.ACTIVE
        while not sets_off():
            self.setUp()
            self.monitor.permit(validity=VALIDITY)
        self.monitor.fall_silent()
        self.assert_held(self.right, 0.5, self.monitor.sent[-1], "permission",
                         3.0 * PERMISSION_PERIOD)

    def test_permissions_that_are_wrong_hold(self):
        cases = [({"age": 0.8}, "permission"), ({"age": -1.0}, "future"),
                 ({"rising": False}, "sequence"), ({"scale": 0.0}, "speed_scale"),
                 ({"scale": float("nan")}, "speed_scale")]
        # What is wrong is told by the same code in all modes.
        for wrong, reason in cases if self.mode == "stream" else cases[:1]:
            self.setUp()
            speed = self.set_off(self.right)
            stopped = self.monitor.permit(**wrong)
            self.assert_held(self.right, speed, stopped, reason)

    def test_a_client_that_dies_leaves_an_arm_that_stands(self):
        code = f"""
import sys; sys.path.insert(0, {os.path.dirname(os.path.abspath(__file__))!r})
import rospy; rospy.init_node("client_to_die")
from gated_arm import GatedArm
arm = GatedArm("right")
arm.client.send_goal(arm.goal(arm.aside(0.9), 1.8))
rospy.spin()
"""
        with subprocess.Popen([sys.executable, "-c", code]) as client:
            wait_for(lambda: abs(self.right.elbow() - self.right.start[ELBOW]) > 0.2)
            killed = time.monotonic()
            client.send_signal(signal.SIGKILL)
        self.assert_stood(self.right, 0.5, killed, 0.02)
        wait_for(lambda: not self.last_trajectory().points)

    def test_a_joint_that_cannot_keep_up_ends_the_goal_and_the_arm_stands(self):
        arm = self.right
        arm.client.send_goal(arm.goal(arm.aside(0.9), 0.1))
        status, code = end_of(arm.client)
        self.assertEqual((status, code), (GoalStatus.ABORTED,
                                          FollowJointTrajectoryResult.PATH_TOLERANCE_VIOLATED))
        self.assertIn(arm.joints[ELBOW], arm.client.get_result().error_string)
        arm.come_to_rest()
        self.assertTrue(arm.stands())

    def test_an_empty_goal_holds(self):
        speed = self.set_off(self.right)
        second, sent = self.right.new_client(), time.monotonic()
        second.send_goal(FollowJointTrajectoryGoal(
            trajectory=JointTrajectory(joint_names=self.right.joints)))
        self.assertEqual(end_of(second), REACHED)
        self.assertEqual(end_of(self.right.client)[0], GoalStatus.PREEMPTED)
        self.assert_stood(self.right, speed, sent)


if __name__ == "__main__":
    rospy.init_node("gate_ends_test")
    rostest.rosrun("tccm_monitor", "gate_ends", EndsTest)
