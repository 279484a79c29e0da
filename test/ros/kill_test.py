#!/usr/bin/python3
"""A part of the monitor, or the laser's driver, is killed while an arm moves: the gate holds the arm in
time, and nothing but a new goal moves it again, also when all is well again."""

import os
import signal
import time
import unittest

import rospkg
import rospy
import rostest
import yaml
from actionlib_msgs.msg import GoalStatus
from control_msgs.msg import FollowJointTrajectoryGoal
from std_srvs.srv import Trigger
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from gated_arm import AT_REST, GatedArm
from scripted_monitor import PERMISSION_PERIOD
from tccm_monitor.msg import MotionPermission
from waiting import process_of, wait_for

SLACK = 0.04  # [s] that a busy machine may add
SCAN_PERIOD, ROBOT_PERIOD = 0.028, 0.01
# A checker that is dead is noticed by its silence. One that lives notices a map that does not get
# newer after three scan periods, counted from a scan that may have waited for the next transform,
# and says so with its next permission at the latest.
SILENCE = 3.0 * PERMISSION_PERIOD
NO_MAP = 3.0 * SCAN_PERIOD + ROBOT_PERIOD + PERMISSION_PERIOD
LIMITS = {"collision_checker": SILENCE, "tccm_monitor_manager": SILENCE,
          "tilt_scan_assembler": NO_MAP, "tccm_mapper": NO_MAP, "scan_driver": NO_MAP}
APPROACH_SPEED = 0.5  # [rad/s] of the joints to the first point of the reach
UNDER_WAY = 1.5  # [s] from there on, after which the hand is fast
STAYS = 2.0  # [s] for which the arm is watched after all is well again
RECOVERY = 40.0  # [s] at most: nodelets notice slowly that their manager is gone


def reach(arm):
    """The way of examples/reach.yaml from where the arm is, and how long it takes to the way's
    first point."""
    path = os.path.join(rospkg.RosPack().get_path("tccm_monitor"), "examples", "reach.yaml")
    with open(path, encoding="utf-8") as file:
        way = yaml.safe_load(file)
    here = dict(zip(arm.joints, arm.positions()))
    apart = max(abs(here[name] - q) for name, q in
                zip(way["joint_names"], way["points"][0]["positions"]))
    approach = 0.5 + apart / APPROACH_SPEED
    return FollowJointTrajectoryGoal(trajectory=JointTrajectory(
        joint_names=way["joint_names"], points=[JointTrajectoryPoint(
            positions=point["positions"], velocities=point["velocities"],
            time_from_start=rospy.Duration(approach + point["time_from_start"]))
            for point in way["points"]])), approach


class KillTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        victim = rospy.get_param("~victim")
        cls.limit = LIMITS[victim] + SLACK
        cls.arm, cls.permissions, cls.commands = GatedArm("right"), [], []
        rospy.Subscriber("motion_permission", MotionPermission,
                         lambda message: cls.permissions.append((time.monotonic(), message)),
                         queue_size=1000, tcp_nodelay=True)
        rospy.Subscriber("right_arm_controller/command", JointTrajectory,
                         lambda message: cls.commands.append((time.monotonic(), message)),
                         queue_size=1000, tcp_nodelay=True)
        cls.wait_until_permitted()
        process = process_of(rospy.resolve_name(victim))
        cls.move()
        cls.killed = time.monotonic()
        os.kill(process, signal.SIGKILL)
        cls.arm.client.wait_for_result(rospy.Duration(RECOVERY))
        cls.status, cls.why = cls.arm.client.get_state(), cls.arm.client.get_result().error_string
        cls.recovered = cls.wait_until_permitted(after=cls.killed + 1.0)
        wait_for(lambda: time.monotonic() > cls.recovered + STAYS)
        cls.end = time.monotonic()
        cls.move()

    @classmethod
    def wait_until_permitted(cls, after=0.0):
        """@return when the first permission came after that time, and after a reset where the
        monitor wants one."""
        reset = rospy.ServiceProxy("reset", Trigger)

        def permitted():
            recent = [at for at, message in cls.permissions[-5:]
                      if message.permitted and at > max(after, time.monotonic() - 0.2)]
            if recent:
                return recent[0]
            try:
                time.sleep(0.2)
                reset()
            except rospy.ServiceException:
                pass
            return None
        return wait_for(permitted, RECOVERY)

    @classmethod
    def move(cls):
        """The arm is under way. On a machine that is busy, the monitor may hold it before: then it
        is sent again, as an operator would."""
        client = cls.arm.client

        def under_way():
            goal, approach = reach(cls.arm)
            client.send_goal(goal)
            end = time.monotonic() + approach + UNDER_WAY
            wait_for(lambda: client.get_state() > GoalStatus.ACTIVE or time.monotonic() > end)
            if client.get_state() == GoalStatus.ACTIVE:
                return True
            time.sleep(0.2)
            return False
        wait_for(under_way, RECOVERY)

    def first_hold(self):
        """When the controller was told to halt."""
        return next((at for at, message in list(self.commands)
                     if at >= self.killed and not message.points), None)

    def test_the_arm_moved_until_then(self):
        self.assertGreater(self.way(self.killed - 0.5, self.killed), 0.02)

    def way(self, since, until):
        """How far any of its joints went [rad]."""
        log = [positions for _, _, positions, _ in self.arm.log(since, until)]
        return max(max(column) - min(column) for column in zip(*log))

    def test_the_gate_holds_in_time_and_the_goal_is_aborted(self):
        held = self.first_hold()
        self.assertIsNotNone(held)
        print(f"held {1e3 * (held - self.killed):.0f} ms after the kill, {self.why}")
        self.assertLess(held - self.killed, self.limit)
        self.assertEqual(self.status, GoalStatus.ABORTED)

    def test_the_arm_stands_still_soon_after_and_stays(self):
        begin = self.first_hold() + self.arm.stop_duration + SLACK
        self.assertLess(self.way(begin, self.end), AT_REST)

    def test_nothing_is_commanded_after_that(self):
        after = [message for at, message in self.commands
                 if self.first_hold() <= at <= self.end]
        self.assertEqual(len(after), 1)

    def test_nothing_resumes_although_all_is_well_again(self):
        permitted = [message.permitted for at, message in self.permissions
                     if self.recovered <= at <= self.end]
        self.assertIn(True, permitted)

    def test_a_new_goal_moves_the_arm_again(self):
        self.assertGreater(self.way(self.end, float("inf")), 0.02)


if __name__ == "__main__":
    rospy.init_node("kill_test")
    rostest.rosrun("tccm_monitor", "kill", KillTest)
