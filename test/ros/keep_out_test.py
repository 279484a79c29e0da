#!/usr/bin/python3
"""A region that is set in the hand's way stops the hand before it, is named and shown, and lets it go
on once it is removed."""

import json
import unittest

import rospy
import rostest
from geometry_msgs.msg import Point, Pose, Quaternion, Vector3
from sensor_msgs.msg import JointState
from std_msgs.msg import String
from visualization_msgs.msg import Marker, MarkerArray

from monitor_recorder import Recorder, wait_for_nodelets
from tccm_monitor.msg import MonitorStatus
from tccm_monitor.srv import CheckState, CheckStateResponse, SetKeepOut
from waiting import wait_for

# The palm goes to and fro between x = 0.24 and 0.70 m, at y = -0.27 to -0.22 m and z = 0.92 to 0.95 m.
FRONT = 0.60  # [m] of the region, where only the hand gets
PADDING = 0.03  # [m], the default of collision_padding_m
CENTER, SIZE = (FRONT + 0.2, -0.25, 0.95), (0.4, 0.6, 0.6)
AT_REST = 1e-3  # [rad/s]


def region(name="window", frame="", center=CENTER, size=SIZE):
    return dict(name=name, frame=frame, pose=Pose(Point(*center), Quaternion(0, 0, 0, 1)),
                size=Vector3(*size))


class KeepOutTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.recorder, cls.palms, cls.markers, cls.joints = Recorder(), [], [], []
        rospy.Subscriber("simulation/truth", String, cls.take_truth, queue_size=1000)
        rospy.Subscriber("joint_states", JointState, cls.joints.append, queue_size=1000)
        wait_for_nodelets()
        rospy.wait_for_service("set_keep_out")
        cls.set_keep_out = rospy.ServiceProxy("set_keep_out", SetKeepOut)
        wait_for(cls.moves_freely)
        wait_for(lambda: cls.palms and cls.palms[-1][1] < 0.35)
        cls.set_at = len(cls.recorder.statuses)
        cls.answer = cls.set_keep_out(**region())
        rospy.Subscriber("robot_markers", MarkerArray, cls.markers.append, queue_size=10)
        wait_for(cls.stands_stopped)
        wait_for(lambda: cls.markers)
        cls.shown = cls.markers[-1].markers
        cls.stopped_at = cls.palms[-1][1]
        cls.question = rospy.ServiceProxy("check_state", CheckState)(cls.joints[-1])
        cls.removed_at = len(cls.recorder.statuses)
        cls.removal = cls.set_keep_out(name="window", remove=True)
        # It goes on as far as it went before.
        wait_for(lambda: cls.palms[-1][1] > 0.69)
        cls.end = len(cls.recorder.statuses)

    @classmethod
    def take_truth(cls, message):
        truth = json.loads(message.data)
        if truth["event"] == "hand":
            cls.palms.append((truth["stamp_s"], truth["palm_m"][0]))

    @classmethod
    def moves_freely(cls):
        """The robot moves, and nothing speaks against it."""
        return (cls.recorder.statuses and cls.recorder.statuses[-1].level == MonitorStatus.OK and
                cls.joints and cls.speed() > 0.1)

    @classmethod
    def stands_stopped(cls):
        """The robot stands, for the region's sake."""
        last = cls.recorder.statuses[-1]
        return last.stop and last.reason in ("KEEP_OUT_AHEAD", "RELEASING") and cls.speed() < AT_REST

    @classmethod
    def speed(cls):
        """Of the arm that moves; the head nods all the while."""
        return max(abs(velocity) for name, velocity in zip(cls.joints[-1].name,
                                                           cls.joints[-1].velocity)
                   if name.startswith("right_"))

    def while_set(self):
        return self.recorder.statuses[self.set_at:self.removed_at]

    def test_it_is_set_and_removed(self):
        self.assertEqual((self.answer.success, self.answer.message), (True, ""))
        self.assertEqual((self.removal.success, self.removal.message), (True, ""))

    def test_the_hand_is_stopped_ahead_of_it_and_never_in_it(self):
        reasons = {status.reason for status in self.while_set()}
        self.assertIn("KEEP_OUT_AHEAD", reasons)
        self.assertFalse({reason for status in self.while_set() for reason in status.reasons} &
                         {"KEEP_OUT", "COLLISION"}, reasons)
        self.assertGreater(self.stopped_at, 0.3)
        self.assertLess(self.stopped_at, FRONT - PADDING)

    def test_the_stop_names_link_region_and_time(self):
        stop = next(status for status in self.while_set()
                    if status.stop and status.reason == "KEEP_OUT_AHEAD")
        self.assertTrue(stop.link.startswith("right_"), stop.link)
        self.assertRegex(stop.detail,
                         f"^{stop.link} (enters|comes too near to) keep-out region 'window' .*in "
                         r"\d+ ms$")

    def test_before_the_stop_it_is_slowed_down(self):
        first = next(status for status in self.while_set() if status.reason == "KEEP_OUT_AHEAD")
        self.assertEqual(first.level, MonitorStatus.SLOW)

    def test_where_it_stands_is_free(self):
        self.assertEqual(self.question.result, CheckStateResponse.FREE, self.question.detail)

    def test_removed_it_stops_nothing_any_more(self):
        after = [status for status in self.recorder.statuses[self.removed_at:self.end]
                 if status.header.stamp > self.recorder.statuses[self.removed_at].header.stamp]
        self.assertNotIn("KEEP_OUT_AHEAD", {status.reason for status in after[5:]})
        self.assertEqual(after[-1].level, MonitorStatus.OK)

    def test_it_is_shown_with_its_name_and_so_is_that_of_the_configuration(self):
        boxes = [marker for marker in self.shown if marker.ns == "keep out"]
        names = [marker.text for marker in self.shown if marker.ns == "keep out names"]
        self.assertEqual(names, ["back wall", "window"])
        self.assertEqual({marker.type for marker in boxes}, {Marker.CUBE})
        self.assertEqual((boxes[1].scale.x, boxes[1].scale.y, boxes[1].scale.z), SIZE)
        self.assertAlmostEqual(boxes[1].pose.position.x, CENTER[0])
        self.assertLess(boxes[1].color.a, 0.5)

    def test_what_is_wrong_is_refused_with_its_reason(self):
        for request, word in ((region("back wall"), "configuration"),
                              (region(name=""), "name"),
                              (region("a", frame="right_palm_link"), "right_palm_link"),
                              (region("a", frame="nowhere"), "nowhere"),
                              (region("a", size=(0.1, -0.1, 0.1)), "size_y_m"),
                              (region("a", size=(0.1, 0.0, 0.1)), "size_y_m"),
                              (region("a", center=(0.0, float("nan"), 0.0)), "pose"),
                              (dict(region("a"), pose=Pose()), "pose"),
                              (region("a", size=(0.0, 0.0, 0.0)), "size_x_m"),
                              (dict(name="back wall", remove=True), "configuration"),
                              (dict(name="none such", remove=True), "none such")):
            answer = self.set_keep_out(**request)
            self.assertFalse(answer.success, request)
            self.assertIn(word, answer.message)


if __name__ == "__main__":
    rospy.init_node("keep_out_test")
    rostest.rosrun("tccm_monitor", "keep_out", KeepOutTest)
