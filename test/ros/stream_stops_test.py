#!/usr/bin/python3
"""Scans, joint states or transforms stop coming: the robot stops in time, and nothing is clear."""

import unittest

import rospy
import rostest
from sensor_msgs.msg import JointState

from monitor_recorder import (FLAGS, PUBLISH_PERIOD, SCAN_PERIOD, SLACK, START, Recorder,
                              Recording, wait_for_nodelets, wait_until)
from tccm_monitor.msg import MonitorStatus
from tccm_monitor.srv import CheckState, CheckStateResponse

SETTLED = START + 2.6
ASKED = START + 5.0
ROBOT_PERIOD = 0.01  # of joint states and transforms

# Of each stream: its topic, the reason for the stop, and after how long a silence it is due. A scan
# reaches the map with the next transform, and three scan periods without another are too long.
STREAMS = {"scans": ("/scan", "NO_MAP", 3.0 * SCAN_PERIOD + ROBOT_PERIOD),
           "joints": ("/joint_states", "NO_JOINTS", 0.1),
           "tf": ("/tf", "NO_TRANSFORM", 0.5)}


class StreamStopsTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        topic, cls.reason, limit = STREAMS[rospy.get_param("~stream")]
        recording = Recording(rospy.get_param("~stream") + "_stop")
        cls.last = recording.last(topic)
        cls.due = cls.last + limit + 2.0 * PUBLISH_PERIOD + SLACK
        cls.recorder = Recorder()
        wait_for_nodelets()
        player = recording.play()
        wait_until(ASKED)
        check_state = rospy.ServiceProxy("check_state", CheckState)
        cls.answer = check_state(JointState(name=["torso_yaw_joint"], position=[0.0]))
        player.wait()

    def test_the_robot_may_move_until_then(self):
        before = self.recorder.between(SETTLED, self.last)
        self.assertGreater(len(before), 40)
        self.assertEqual({status.reason for status in before}, {"CLEAR"})

    def test_the_stop_comes_in_time_and_says_why(self):
        stop = self.recorder.first(lambda status: status.stop, SETTLED)
        self.assertIsNotNone(stop)
        self.assertLess(stop, self.due)
        due = self.recorder.first(lambda status: status.reason == self.reason, SETTLED)
        self.assertIsNotNone(due, self.recorder.changes())
        self.assertLess(due, self.due, self.recorder.changes())

    def test_it_stays_and_is_a_fault(self):
        after = self.recorder.between(self.due, START + 1e6)
        while after and after[-1].reason == "NO_CLOCK":  # once the recording is over its clock stands still
            after.pop()
        self.assertGreater(len(after), 40)
        self.assertEqual({status.reason for status in after}, {self.reason})
        self.assertEqual({status.level for status in after}, {MonitorStatus.FAULT})
        self.assertFalse(any(status.known for status in after))

    def test_what_is_unknown_is_not_clear(self):
        for flag in FLAGS:
            values = self.recorder.flag_between(flag, self.due + SLACK, START + 1e6)
            self.assertEqual(set(values), {True}, flag)

    def test_a_question_meets_the_same_fault(self):
        self.assertEqual(self.answer.result, CheckStateResponse.FAULT)
        self.assertEqual(self.answer.reason, self.reason)


if __name__ == "__main__":
    rospy.init_node("stream_stops_test")
    rostest.rosrun("tccm_monitor", "stream_stops", StreamStopsTest)
