#!/usr/bin/python3
"""A robot that was in a region to keep out of stands until somebody clicks on the panel's Reset."""

import pathlib
import tempfile
import time
import unittest

import rospkg
import rospy
import rostest
from geometry_msgs.msg import Point, Pose, Quaternion, Vector3

import rviz_window
from monitor_recorder import wait_for_nodelets
from rviz_window import AWAITS_RESET, PATIENCE, STOP
from tccm_monitor.msg import MonitorStatus
from tccm_monitor.srv import SetKeepOut
from waiting import wait_for

PACKAGE = pathlib.Path(rospkg.RosPack().get_path("tccm_monitor"))
STATIC = (64, 191, 77)  # of faces that look upwards
ALL_AROUND = dict(name="window", pose=Pose(Point(0.5, 0.0, 1.0), Quaternion(0, 0, 0, 1)),
                  size=Vector3(1.0, 2.0, 0.6))


class RvizResetTest(unittest.TestCase):
    def setUp(self):
        if rviz_window.missing():
            self.skipTest("not installed: " + ", ".join(rviz_window.missing()))
        self.last, self.lifts = None, 0
        rospy.Subscriber("monitor_status", MonitorStatus, self.take)
        wait_for_nodelets()
        rospy.wait_for_service("set_keep_out")
        self.set_keep_out = rospy.ServiceProxy("set_keep_out", SetKeepOut)
        self.window = rviz_window.Window(self.config(), "-f", "base_link")
        self.addCleanup(self.window.close)

    def config(self):
        """The shipped one, with fewer frames: the monitor needs the processor too."""
        shipped = (PACKAGE / "rviz" / "tccm_monitor.rviz").read_text(encoding="utf-8")
        self.assertIn("Frame Rate: 30", shipped)
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        path = pathlib.Path(folder.name) / "slow.rviz"
        path.write_text(shipped.replace("Frame Rate: 30", "Frame Rate: 5"), encoding="utf-8")
        return str(path)

    def take(self, status):
        self.lifts += bool(self.last and self.last.latched and not status.latched)
        self.last = status

    def wait_for_latch(self):
        def latched():
            """A stop holds until it is reset, and its cause is over."""
            return self.last and self.last.latched and self.last.reason == "AWAITING_RESET"
        wait_for(latched, PATIENCE)

    def click_until_lifted(self):
        """A machine that is too busy adds faults of its own, and the reset is refused."""
        deadline = time.monotonic() + PATIENCE
        while not self.lifts:
            self.assertLess(time.monotonic(), deadline, self.last)
            self.window.wait_for_color(AWAITS_RESET, 1000)
            self.window.click_reset()
            try:
                wait_for(lambda: self.lifts, 5.0)
            except AssertionError:
                pass

    def test_a_click_on_reset_lifts_what_holds(self):
        self.window.wait_for_color(STATIC, 5000)
        wait_for(lambda: self.last and self.last.cuboids)
        self.assertTrue(self.set_keep_out(**ALL_AROUND).success)
        wait_for(lambda: "KEEP_OUT" in self.last.reasons, PATIENCE)
        self.assertTrue(self.set_keep_out(name="window", remove=True).success)
        self.wait_for_latch()
        self.window.wait_for_color(STOP, 5000)
        self.window.wait_for_color(AWAITS_RESET, 1000)
        self.assertEqual(self.lifts, 0, "nobody has clicked")
        self.click_until_lifted()


if __name__ == "__main__":
    rospy.init_node("rviz_reset_test")
    rostest.rosrun("tccm_monitor", "rviz_reset", RvizResetTest)
