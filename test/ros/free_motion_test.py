#!/usr/bin/python3
"""A free motion is not stopped once a whole tilt period was seen, and services answer all the while."""

import unittest

import rospy
import rostest
from sensor_msgs.msg import JointState
from std_srvs.srv import Trigger

from monitor_recorder import (FLAGS, START, TILT_PERIOD, Recorder, Recording, wait_for_nodelets,
                              wait_until)
from tccm_monitor.msg import MonitorStatus
from tccm_monitor.srv import CheckState, CheckStateResponse, GetCuboidMap

SETTLED = START + 2.6  # the window of 1.1 tilt periods is full well before
CLEARED = START + 9.0

# The left arm, stretched down beside the robot, or through the top of the table.
ARM_DOWN = {"left_shoulder_pitch_joint": 0.0, "left_elbow_joint": 0.0}
ARM_IN_TABLE = {"left_shoulder_pitch_joint": -0.9, "left_elbow_joint": 0.0,
                "left_shoulder_roll_joint": 0.0}


def ask(positions):
    state = JointState(name=list(positions), position=list(positions.values()))
    return rospy.ServiceProxy("check_state", CheckState)(state)


PAUSE = 0.03  # [s] that a scan's permission comes late: for a while margins are larger by that


def is_for_a_pause(status):
    """Where the machine paused, what is near counts as too near, and rightly."""
    return "comes too near to the map for its speed" in status.detail


class FreeMotionTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.recorder = Recorder()
        wait_for_nodelets()
        cls.before_time = ask({"torso_yaw_joint": 0.0})
        cls.map_before = rospy.ServiceProxy("get_cuboid_map", GetCuboidMap)()
        player = Recording("free_motion").play()
        wait_until(START + 1.0)
        cls.during_init = ask({"torso_yaw_joint": 0.0})
        wait_until(START + 5.0)
        cls.now = ask({"torso_yaw_joint": 0.0})
        cls.arm_down = ask(ARM_DOWN)
        cls.in_table = ask(ARM_IN_TABLE)
        cls.unknown_joint = ask({"third_arm_joint": 0.0})
        cls.not_finite = ask({"torso_yaw_joint": float("nan")})
        cls.map = rospy.ServiceProxy("get_cuboid_map", GetCuboidMap)()
        wait_until(CLEARED)
        cls.cleared = rospy.ServiceProxy("clear_map", Trigger)()
        cls.map_cleared = rospy.ServiceProxy("get_cuboid_map", GetCuboidMap)()
        player.wait()
        statuses = cls.recorder.between(0.0, float("inf"))
        cls.paused = any(status.ready_to_verdict_s > PAUSE for status in statuses)

    def test_nothing_is_OK_before_the_first_full_tilt_period(self):
        first = self.recorder.first(lambda status: status.level == MonitorStatus.OK)
        self.assertIsNotNone(first)
        self.assertGreater(first, START + TILT_PERIOD)
        self.assertLess(first, SETTLED)
        self.assertNotIn(False, self.recorder.flag_between("stop", 0.0, START + TILT_PERIOD))

    def test_until_then_the_reason_is_INIT_and_no_flag_says_clear(self):
        before = self.recorder.between(0.0, START + TILT_PERIOD)
        self.assertEqual({status.reason for status in before}, {"INIT"})
        self.assertFalse(any(status.known for status in before))
        for flag in FLAGS:
            self.assertNotIn(False, self.recorder.flag_between(flag, 0.0, START + TILT_PERIOD))

    def test_nothing_else_is_said_from_beginning_to_end(self):
        reasons = [reason for _, reason in self.recorder.changes()]
        if reasons[-1] == "NO_CLOCK":  # once the recording is over its clock stands still
            reasons.pop()
        if self.paused and "COLLISION_AHEAD" in reasons:
            self.skipTest("the machine paused for longer than the margins allow for")
        self.assertEqual(reasons, ["INIT", "CLEAR", "INIT", "CLEAR"])

    def test_a_free_motion_is_never_stopped(self):
        settled = self.recorder.between(SETTLED, CLEARED)
        if self.paused:
            settled = [status for status in settled if not is_for_a_pause(status)]
        self.assertGreater(len(settled), 200)
        self.assertEqual({(status.reason, status.detail) for status in settled}, {("CLEAR", "")})
        for flag in FLAGS if not self.paused else []:
            self.assertEqual(set(self.recorder.flag_between(flag, SETTLED, CLEARED)), {False})

    def test_a_state_is_unknown_before_there_is_a_whole_map(self):
        for answer in (self.before_time, self.during_init):
            self.assertEqual(answer.result, CheckStateResponse.UNKNOWN)
            self.assertEqual(answer.reason, "INIT")

    def test_a_state_is_free_or_in_collision_with_the_map(self):
        self.assertEqual((self.now.result, self.now.reason), (CheckStateResponse.FREE, "FREE"))
        self.assertEqual(self.arm_down.result, CheckStateResponse.FREE, self.arm_down.detail)
        self.assertEqual(self.in_table.result, CheckStateResponse.COLLISION, self.in_table.detail)
        self.assertTrue(self.in_table.link.startswith("left_"), self.in_table.link)
        self.assertLess(self.in_table.map_age.to_sec(), 0.3)

    def test_a_question_that_cannot_be_answered_is_not_free(self):
        for answer in (self.unknown_joint, self.not_finite):
            self.assertEqual(answer.result, CheckStateResponse.UNKNOWN)
            self.assertEqual(answer.reason, "BAD_QUESTION")

    def test_the_map_can_be_had(self):
        self.assertFalse(self.map_before.success)
        self.assertTrue(self.map.success)
        self.assertEqual(self.map.map.header.frame_id, "base_link")
        self.assertTrue(self.map.map.complete)
        self.assertGreater(len(self.map.map.cuboids), 500)

    def test_clearing_the_map_begins_anew(self):
        self.assertTrue(self.cleared.success)
        self.assertFalse(self.map_cleared.map.complete)
        after = self.recorder.between(CLEARED + 0.2, CLEARED + TILT_PERIOD)
        self.assertEqual({status.reason for status in after}, {"INIT"})
        again = self.recorder.first(lambda status: status.level == MonitorStatus.OK, CLEARED + 0.2)
        self.assertIsNotNone(again)


if __name__ == "__main__":
    rospy.init_node("free_motion_test")
    rostest.rosrun("tccm_monitor", "free_motion", FreeMotionTest)
