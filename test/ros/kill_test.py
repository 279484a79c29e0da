#!/usr/bin/python3
"""A part of the monitor, or the laser's driver, is killed while the arm moves: the client holds the
arm in time, and nothing but a new goal moves it again, also when all is well again."""

import os
import signal
import time
import unittest
import xmlrpc.client

import rosgraph
import rospkg
import rospy
import rostest
import yaml
from std_srvs.srv import Trigger
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from client_recorder import AT_REST, PERMISSION_PERIOD, SLACK, ClientRecorder
from tccm_monitor.msg import MotionPermission
from waiting import wait_for

SCAN_PERIOD, ROBOT_PERIOD = 0.028, 0.01
# A checker that is dead is noticed by its silence. One that lives notices a map that does not get
# newer after three scan periods, counted from a scan that may have waited for the next transform,
# and says so with its next permission at the latest.
SILENCE = 3.0 * PERMISSION_PERIOD
NO_MAP = 3.0 * SCAN_PERIOD + ROBOT_PERIOD + PERMISSION_PERIOD
LIMITS = {"collision_checker": SILENCE, "tccm_monitor_manager": SILENCE,
          "tilt_scan_assembler": NO_MAP, "tccm_mapper": NO_MAP, "scan_driver": NO_MAP}
BRAKING = 0.3  # [s] at most, of the simulated arm
APPROACH_SPEED = 0.5  # [rad/s] of the joints to the first point of the reach
UNDER_WAY = 1.5  # [s] from there on, after which the hand is fast
STAYS = 2.0  # [s] for which the arm is watched after all is well again
RECOVERY = 40.0  # [s] at most: nodelets notice slowly that their manager is gone


def reach(recorder):
    """The way of examples/reach.yaml from where the arm is, and how long it takes to the way's
    first point."""
    path = os.path.join(rospkg.RosPack().get_path("tccm_monitor"), "examples", "reach.yaml")
    with open(path, encoding="utf-8") as file:
        way = yaml.safe_load(file)
    _, here = recorder.positions(way["joint_names"])
    apart = max(abs(a - b) for a, b in zip(here, way["points"][0]["positions"]))
    approach = 0.5 + apart / APPROACH_SPEED
    return JointTrajectory(joint_names=way["joint_names"], points=[
        JointTrajectoryPoint(positions=point["positions"], velocities=point["velocities"],
                             time_from_start=rospy.Duration(approach + point["time_from_start"]))
        for point in way["points"]]), approach


def process_of(node):
    master = rosgraph.Master(rospy.get_name())
    _, _, process = xmlrpc.client.ServerProxy(master.lookupNode(node)).getPid(rospy.get_name())
    return process


class KillTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        victim = rospy.get_param("~victim")
        cls.limit = LIMITS[victim] + SLACK
        cls.recorder, cls.permissions = ClientRecorder(), []
        rospy.Subscriber("motion_permission", MotionPermission,
                         lambda message: cls.permissions.append((time.monotonic(), message)),
                         queue_size=1000, tcp_nodelay=True)
        cls.recorder.wait_until_connected()
        cls.wait_until_permitted()
        process = process_of(rospy.resolve_name(victim))
        cls.move()
        cls.killed = time.monotonic()
        os.kill(process, signal.SIGKILL)
        cls.recorder.wait_for_state("HELD")
        cls.reason = cls.recorder.state
        cls.recovered = cls.wait_until_permitted(after=cls.killed + 1.0)
        wait_for(lambda: time.monotonic() > cls.recovered + STAYS)
        cls.end = time.monotonic()
        cls.state_at_the_end = cls.recorder.state
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
        def under_way():
            goal, approach = reach(cls.recorder)
            if cls.recorder.send(goal) != "MOVING":
                time.sleep(0.2)
                return False
            end = time.monotonic() + approach + UNDER_WAY
            wait_for(lambda: cls.recorder.state != "MOVING" or time.monotonic() > end)
            return cls.recorder.state == "MOVING"
        wait_for(under_way, RECOVERY)

    def test_the_arm_moved_until_then(self):
        self.assertGreater(self.recorder.moving(self.killed - 0.5, self.killed), 0.02)

    def test_the_client_holds_in_time(self):
        held = self.recorder.first_hold(self.killed)
        self.assertIsNotNone(held)
        print(f"held {1e3 * (held - self.killed):.0f} ms after the kill, {self.reason}")
        self.assertLess(held - self.killed, self.limit)

    def test_the_arm_stands_still_soon_after_and_stays(self):
        begin = self.recorder.first_hold(self.killed) + BRAKING
        self.assertLess(self.recorder.moving(begin, self.end), AT_REST)

    def test_one_empty_command_and_one_empty_trajectory_are_the_last_that_is_published(self):
        held = self.recorder.first_hold(self.killed)
        for log in (self.recorder.commands, self.recorder.trajectories):
            after = [message for at, message in log if held - SLACK <= at <= self.end]
            self.assertEqual([index for index, message in enumerate(after) if not message.points],
                             [len(after) - 1])

    def test_nothing_resumes_although_all_is_well_again(self):
        permitted = [message.permitted for at, message in self.permissions
                     if self.recovered <= at <= self.end]
        self.assertIn(True, permitted)
        self.assertEqual(self.state_at_the_end, self.reason)

    def test_a_new_goal_moves_the_arm_again(self):
        self.assertGreater(self.recorder.moving(self.end), 0.02)


if __name__ == "__main__":
    rospy.init_node("kill_test")
    rostest.rosrun("tccm_monitor", "kill", KillTest)
