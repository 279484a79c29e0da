#!/usr/bin/python3
"""rviz with the shipped configuration shows a map and a status as they are, and a click on the
panel's Reset calls the service."""

import copy
import math
import pathlib
import tempfile
import threading
import unittest

import rospkg
import rospy
import rostest
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from sensor_msgs.msg import JointState
from std_srvs.srv import Trigger, TriggerResponse

import rviz_window
from rviz_scene import DYNAMIC, STATIC, empty_map, fill, status
from rviz_window import AWAITS_RESET, OK, PATIENCE, SILENT, STOP, box_of, where
from scripted_monitor import Rate
from tccm_monitor.msg import CuboidMap, LinkStatus, MonitorStatus
from tccm_monitor.srv import AttachObject, AttachObjectResponse
from waiting import wait_for

PACKAGE = pathlib.Path(rospkg.RosPack().get_path("tccm_monitor"))

# Of the faces that look upwards, as cuboid_geometry.cpp has them.
GREEN, RED, MAGENTA = (64, 191, 77), (230, 64, 38), (255, 0, 204)

ARMS = {"left": (0.15, 0.15, 0.0, -0.4, 0.0, 0.0, 0.0),
        "right": (0.11, -0.16, -0.08, -2.26, -0.21, 0.72, -0.05)}  # reaches over the table
JOINTS = ("shoulder_pitch", "shoulder_roll", "shoulder_yaw", "elbow", "wrist_yaw", "wrist_pitch",
          "wrist_roll")


def robot():
    positions = {"laser_tilt_joint": 0.8, "torso_yaw_joint": 0.0, "head_yaw_joint": 0.0,
                 "head_pitch_joint": 0.0, "head_roll_joint": 0.0}
    positions.update({f"{side}_{joint}_joint": position for side, arm in ARMS.items()
                      for joint, position in zip(JOINTS, arm)})
    return JointState(name=list(positions), position=list(positions.values()))


def scene():
    """A table with something that moves, something that is held, and what the hand touches."""
    message = empty_map(75, 100)
    fill(message, (18, 52), (15, 85), 0.70, 0.72, dyn=STATIC)
    fill(message, (40, 46), (58, 64), 0.74, 0.92, dyn=STATIC)
    fill(message, (34, 40), (72, 80), 0.74, 0.84, dyn=DYNAMIC)
    fill(message, (44, 50), (20, 30), 0.74, 0.88, dyn=STATIC, held=True)
    return fill(message, (27, 32), (35, 43), 0.74, 1.02, dyn=STATIC)


def health(name, text):
    return DiagnosticStatus(name=name, level=DiagnosticStatus.OK, message=text)


class RvizTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        if rviz_window.missing():
            raise unittest.SkipTest("not installed: " + ", ".join(rviz_window.missing()))
        cls.resets, cls.sent = [], 0
        cls.map = scene()
        cls.touched = [one for one in cls.map.cuboids if one.top > 1.0]
        cls.stopped = status(
            MonitorStatus.STOP, "COLLISION", "right_palm_link touches a cuboid at x 0.55, y -0.22, z 0.95 m",
            flagged=cls.touched, link="right_palm_link", latched="COLLISION",
            contact_link="right_palm_link", cuboids=len(cls.map.cuboids), window_scans=40,
            ready_to_verdict_s=0.0011, scan_to_verdict_s=0.034,
            links=[LinkStatus(link="right_palm_link", collision=True, clearance=0.004)])
        cls.holding = status(
            MonitorStatus.STOP, "AWAITING_RESET", "COLLISION holds until reset: " + cls.stopped.detail,
            latched="COLLISION", stopped_by="COLLISION", stopped_by_detail=cls.stopped.detail,
            cuboids=len(cls.map.cuboids), window_scans=40, ready_to_verdict_s=0.0011,
            scan_to_verdict_s=0.034, time_to_contact_s=math.inf,
            links=[LinkStatus(link="right_palm_link", clearance=0.051)])
        cls.clear = status(MonitorStatus.OK, "CLEAR", "", speed_scale=1.0,
                           cuboids=len(cls.map.cuboids), window_scans=40)
        cls.status = cls.stopped
        cls.answers = threading.Event()  # whether reset answers
        cls.maps = rospy.Publisher("cuboid_map", CuboidMap, queue_size=1)
        cls.statuses = rospy.Publisher("monitor_status", MonitorStatus, queue_size=1)
        cls.joints = rospy.Publisher("joint_states", JointState, queue_size=1)
        cls.diagnostics = rospy.Publisher("/diagnostics", DiagnosticArray, queue_size=1)
        cls.service = rospy.Service("reset", Trigger, cls.reset)
        cls.cleared, cls.attached = [], []
        cls.others = [
            rospy.Service(f"{sensor}/clear_map", Trigger, cls.clearing(sensor))
            for sensor in ("laser", "camera")]
        cls.others.append(rospy.Service("attach_object", AttachObject, cls.attach))
        cls.rate = Rate(0.1, cls.publish)
        cls.window = rviz_window.Window(str(PACKAGE / "rviz" / "tccm_monitor.rviz"), "-f",
                                        "base_link")

    @classmethod
    def tearDownClass(cls):
        if hasattr(cls, "window"):
            cls.rate.stop()
            cls.window.close()

    @classmethod
    def reset(cls, request):
        cls.resets.append(request)
        cls.answers.wait()
        cls.status = cls.clear
        return TriggerResponse(True, "lifted COLLISION")

    @classmethod
    def clearing(cls, sensor):
        return lambda _: cls.cleared.append(sensor) or TriggerResponse(True, "")

    @classmethod
    def attach(cls, request):
        cls.attached.append(request)
        return AttachObjectResponse(True, "")

    @classmethod
    def publish(cls):
        cls.sent += 1
        now = rospy.Time.now()
        for publisher, message in ((cls.maps, cls.map), (cls.statuses, cls.status)):
            if message is not None:
                message = copy.copy(message)
                message.header.stamp = now
                publisher.publish(message)
        joints = robot()
        joints.header.stamp = now
        cls.joints.publish(joints)
        cls.diagnostics.publish(DiagnosticArray(status=[
            health("tilt_scan_assembler: scans", "scans are assembled"),
            health("tccm_mapper: map", "the map holds the whole window")]))

    def setUp(self):
        cls = type(self)
        cls.status, cls.map.header.frame_id = cls.stopped, "base_link"
        self.resets.clear()
        self.answers.set()

    def hold(self):
        """What brought the stop about is over."""
        type(self).status = self.holding
        self.window.wait_for_color(AWAITS_RESET, 1000)

    def test_the_map_is_shown_in_the_colours_of_the_verdict(self):
        self.window.wait_for_color(MAGENTA, 300)
        self.window.wait_for_color(GREEN, 10000)
        self.window.wait_for_color(RED, 300)
        table = box_of(where(self.window.picture(), GREEN))
        touched = box_of(where(self.window.picture(), MAGENTA))
        self.assertGreater(touched[0], table[0])
        self.assertLess(touched[0] + touched[2], table[0] + table[2])
        self.compare("rviz_display.png", self.window.view())

    def test_a_click_on_reset_calls_the_service(self):
        self.window.wait_for_color(STOP, 5000)
        self.assertEqual(self.window.pixels(AWAITS_RESET), 0, "it would be refused")
        self.hold()
        self.compare("rviz_panel.png", self.window.panel())
        self.assertEqual(self.resets, [])
        self.window.click_reset()
        wait_for(lambda: self.resets, PATIENCE)
        self.window.wait_for_color(OK, 5000)
        self.window.wait_without(AWAITS_RESET)

    def test_a_service_that_does_not_answer_stops_no_window(self):
        self.hold()
        self.answers.clear()
        self.addCleanup(self.answers.set)
        self.window.click_reset()
        wait_for(lambda: self.resets, PATIENCE)
        type(self).status = None
        self.window.wait_for_color(SILENT, 5000)
        self.answers.set()
        wait_for(lambda: self.status is self.clear)

    def test_clear_map_clears_that_of_every_sensor(self):
        self.hold()
        self.window.click_button(1, 0)
        wait_for(lambda: sorted(self.cleared) == ["camera", "laser"], PATIENCE)

    def test_what_is_asked_for_is_attached(self):
        self.hold()
        self.window.click_button(0, 1)
        self.window.press_return("Attach an object", lambda: self.attached)
        request = self.attached[0]
        self.assertEqual((request.name, request.link), ("object", "right_palm_link"))
        self.assertEqual((request.primitive.shape, request.primitive.size.x), ("box", 0.1))
        self.assertEqual(request.primitive.pose.orientation.w, 1.0)

    def test_of_a_silent_monitor_nothing_is_shown(self):
        self.window.wait_for_color(STOP, 5000)
        type(self).status = None
        self.window.wait_for_color(SILENT, 5000)
        self.window.wait_without(STOP)
        self.window.wait_without(MAGENTA)

    def test_a_map_that_is_none_or_is_nowhere_is_not_drawn(self):
        self.window.wait_for_color(GREEN, 10000)
        self.map.cuboids.reverse()
        self.window.wait_without(GREEN)
        self.map.header.frame_id = "nowhere"
        self.map.cuboids.reverse()
        sent = self.sent
        wait_for(lambda: self.sent > sent + 20)
        self.assertEqual(self.window.pixels(GREEN), 0)
        self.map.header.frame_id = "base_link"
        self.window.wait_for_color(GREEN, 10000)

    def compare(self, name, box):
        """With the documentation's picture; where a folder is given, that is made instead."""
        folder = rospy.get_param("~pictures", "")
        if folder:
            self.window.save(str(pathlib.Path(folder) / name), box)
            return
        with tempfile.TemporaryDirectory() as scratch:
            path = str(pathlib.Path(scratch) / name)

            def alike():
                """The picture becomes that of docs/."""
                self.window.save(path, box)
                return rviz_window.share_apart(path, str(PACKAGE / "docs" / name)) < 0.01
            wait_for(alike, PATIENCE)


if __name__ == "__main__":
    rospy.init_node("rviz_test")
    rostest.rosrun("tccm_monitor", "rviz", RvizTest)
