#!/usr/bin/python3
"""A checker that hears nothing says from the beginning that nothing is permitted, and why; one that
cannot see a link that it has to watch never says anything."""

import subprocess
import unittest

import rospy
import rostest
from rosgraph_msgs.msg import Log
from std_msgs.msg import Float64
from std_srvs.srv import Trigger

from gated_robot import MANAGER, wait_for
from monitor_recorder import FLAGS, GAP_MAX, PUBLISH_PERIOD, SLACK, Recorder, share_in_time
from tccm_monitor.msg import MotionPermission

JOINT_LIMIT = 0.1
# Of maps and transforms, of which none ever came.
OTHERS_LIMIT = 0.5
FIRST_LIMIT = 0.1
START_SLACK = 0.3  # while other programs start
LISTENING = 2.0  # seconds


class StartTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.log, cls.permissions, cls.unheard, cls.scales = [], [], [], []
        rospy.Subscriber("/rosout", Log, cls.log.append, queue_size=1000)
        rospy.Subscriber("motion_permission", MotionPermission, cls.permissions.append,
                         queue_size=1000, tcp_nodelay=True)
        rospy.Subscriber("shapeless/motion_permission", MotionPermission, cls.unheard.append,
                         queue_size=1000)
        rospy.Subscriber("speed_scale", Float64, lambda scale: cls.scales.append(scale.data),
                         queue_size=1000)
        cls.recorder = Recorder()
        cls.loader = cls.load("load", [MANAGER])
        cls.shapeless = cls.load("standalone", [], "/shapeless")
        first = wait_for(lambda: cls.permissions and cls.permissions[0])
        end = first.header.stamp + rospy.Duration(LISTENING)
        wait_for(lambda: cls.permissions[-1].header.stamp > end)
        cls.reset = rospy.ServiceProxy("reset", Trigger)()
        cls.console, _ = cls.shapeless.communicate(timeout=20.0)

    @classmethod
    def load(cls, how, manager, namespace="/"):
        return subprocess.Popen(["rosrun", "nodelet", "nodelet", how,
                                 "tccm_monitor/CollisionChecker", *manager,
                                 "__name:=collision_checker", "__ns:=" + namespace],
                                stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)

    @classmethod
    def tearDownClass(cls):
        for process in (cls.loader, cls.shapeless):
            process.terminate()
            process.wait()

    @classmethod
    def said(cls, text):
        return [message for message in cls.log if text in message.msg]

    def begin(self):
        """When the first permission was given; some may have come before this test was heard."""
        first = self.permissions[0]
        return first.header.stamp.to_sec() - PUBLISH_PERIOD * (first.sequence - 1)

    def after(self, seconds):
        return [permission for permission in self.permissions
                if permission.header.stamp.to_sec() > self.begin() + seconds]

    def test_the_first_permission_comes_at_once(self):
        passed = self.said("Self-test passed")
        self.assertEqual(len(passed), 1)
        self.assertLess(self.begin() - passed[0].header.stamp.to_sec(), FIRST_LIMIT + START_SLACK)
        self.assertLess(self.permissions[0].sequence, 1.0 / PUBLISH_PERIOD)

    def test_nothing_is_ever_permitted_or_clear(self):
        self.assertFalse(any(permission.permitted for permission in self.permissions))
        self.assertEqual({permission.speed_scale for permission in self.permissions}, {0.0})
        self.assertEqual(set(self.scales), {0.0})
        for flag in FLAGS:
            self.assertEqual({value for _, value in self.recorder.flags[flag]}, {True}, flag)

    def test_it_waits_for_a_moment_and_then_it_is_a_fault(self):
        allowed = {(MotionPermission.STOP, "INIT"), (MotionPermission.FAULT, "NO_JOINTS"),
                   (MotionPermission.FAULT, "NO_TRANSFORM")}
        self.assertLessEqual({(permission.level, permission.reasons[0])
                              for permission in self.permissions}, allowed)
        for permission in self.after(JOINT_LIMIT + PUBLISH_PERIOD + SLACK):
            self.assertEqual(permission.level, MotionPermission.FAULT)
            self.assertIn("NO_JOINTS", permission.reasons)
        for permission in self.after(OTHERS_LIMIT + PUBLISH_PERIOD + SLACK):
            self.assertEqual(permission.reasons, ["NO_TRANSFORM", "NO_JOINTS", "NO_MAP"])

    def test_permissions_come_at_their_rate(self):
        stamps = [permission.header.stamp.to_sec() for permission in self.permissions]
        self.assertGreater(share_in_time(stamps), 0.6)
        self.assertLess(max(b - a for a, b in zip(stamps, stamps[1:])), GAP_MAX)
        numbers = [permission.sequence for permission in self.permissions]
        self.assertEqual(numbers, list(range(numbers[0], numbers[0] + len(numbers))))
        for permission in self.permissions:
            valid = permission.valid_until - permission.header.stamp
            self.assertLess(valid.to_sec(), 3.0 * PUBLISH_PERIOD)

    def test_a_reset_changes_nothing(self):
        self.assertFalse(self.reset.success)
        self.assertRegex(self.reset.message, "^[A-Z_]+ lasts$")

    def test_a_link_without_a_shape_is_refused(self):
        refusals = [line for line in self.console.splitlines() if "refuses to start" in line]
        self.assertEqual(len(refusals), 1, self.console)
        for text in ("[FATAL]", "laser_tilt_link", "no collision element"):
            self.assertIn(text, refusals[0])
        self.assertNotEqual(self.shapeless.returncode, 0)
        self.assertEqual(self.unheard, [])


if __name__ == "__main__":
    rospy.init_node("start_test")
    rostest.rosrun("tccm_monitor", "start", StartTest)
